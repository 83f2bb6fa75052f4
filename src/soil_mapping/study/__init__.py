"""Trials and whole studies, run from a shell: which trials there are, where they run, and the report on them."""
