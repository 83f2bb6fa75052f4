"""The mission: the coordinator, its samplings and allocations, and the log of what happened."""
