"""An experiment's folder: what it holds, how far it is, its table."""
