"""Fit how long the legs of a real robot take, from recordings of it: read, check and fit them, and write the result."""
