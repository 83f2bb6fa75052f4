"""Questions to the ROS master and parameters, in the order of the rounds."""
