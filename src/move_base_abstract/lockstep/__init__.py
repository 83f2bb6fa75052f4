"""The parts of a lockstep participant that need no ROS: the protocol, and the turns of its threads."""
