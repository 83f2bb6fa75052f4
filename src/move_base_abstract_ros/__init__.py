"""The ROS shell around the core: topics, services, parameters and time of ROS 1. It decides nothing."""
