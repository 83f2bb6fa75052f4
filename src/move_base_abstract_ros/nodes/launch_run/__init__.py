"""What the programs `lockstep_launch` and `verify` are made of: a run of a launch file in this process."""
