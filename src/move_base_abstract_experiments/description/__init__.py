"""The description of an experiment: its file, its plan, and the files and parameters on which its trials depend."""
