"""The study as Mesa models: our own with the coordinator, and the published one with its own rules."""
