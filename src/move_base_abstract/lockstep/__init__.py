"""The parts of a lockstep participant that need no ROS: the protocol, and whose turn it is."""
