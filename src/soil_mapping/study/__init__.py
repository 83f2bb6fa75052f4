"""The program ``study``: runs trials and whole studies, and makes the report on them."""
