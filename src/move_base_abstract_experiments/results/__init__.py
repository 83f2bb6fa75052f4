"""An experiment's folder: its content, its progress, its table."""
