"""What a participant of lockstep needs and ROS has no part in: the protocol, and whose turn it is."""
