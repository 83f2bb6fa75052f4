"""A fleet: many robots in one process, and their zones."""
