"""The study on ROS: the coordinator as any user would write it, for any robots with the interface of move_base."""
