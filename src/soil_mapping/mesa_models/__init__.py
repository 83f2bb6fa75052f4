"""The study as Mesa models: ours on the coordinator, and the published one by its own rules."""
