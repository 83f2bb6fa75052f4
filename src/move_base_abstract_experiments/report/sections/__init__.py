"""Sections of the page that are about the trials, not about a metric: how they ended, what of them can be trusted."""
