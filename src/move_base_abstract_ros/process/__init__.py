"""A node as a process: its command line, its start, its end, and watches of the ROS master and of /clock."""
