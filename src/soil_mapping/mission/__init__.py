"""Who samples where and when: the coordinator, its samplings and allocations, and the book of what happened."""
