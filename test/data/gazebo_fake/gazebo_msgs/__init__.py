"""The two types of gazebo_msgs 2.9 that the backend uses, for machines without Gazebo; for tests only."""
