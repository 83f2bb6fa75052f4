"""A thread that waits gives the turn away: in sleeps, locks, pools, event loops, and loops that only look."""
