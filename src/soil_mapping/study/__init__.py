"""The program examples/study.py: runs trials and whole studies, and makes the report on them."""
