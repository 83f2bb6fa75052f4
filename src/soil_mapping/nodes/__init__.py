"""One module for each executable."""
