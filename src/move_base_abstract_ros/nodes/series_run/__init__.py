"""What `lockstep_launch --script` is made of: the script, and the node that takes part in each run for the script."""
