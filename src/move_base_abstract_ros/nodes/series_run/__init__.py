"""What the program lockstep_series is made of: the node that takes part in each run for the script."""
