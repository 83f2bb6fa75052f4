"""What an experiment is: its file, its plan, and what its trials are made of."""
