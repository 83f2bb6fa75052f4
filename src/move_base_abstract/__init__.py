"""The simulator's core: robots whose travel is computed instead of simulated. Needs no ROS."""
