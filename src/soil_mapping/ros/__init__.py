"""The study on ROS: the coordinator as any user would write it, for whatever robots speak move_base."""
