"""Who waits gives the turn away: sleeps, locks, pools, event loops, loops that only look."""
