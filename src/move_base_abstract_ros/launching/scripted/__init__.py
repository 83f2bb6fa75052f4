"""What starts launch files by itself: scripts, each file of which becomes a run in lockstep, and rostest."""
