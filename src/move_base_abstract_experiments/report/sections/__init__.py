"""Sections of the page about the trials, not about a metric: how they ended, and how far they can be trusted."""
