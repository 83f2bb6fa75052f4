"""A part of the program lockstep_series: the node that takes part in each run for the script."""
