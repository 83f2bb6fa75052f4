"""A team of robots maps the soil compaction of a field: the study that the simulator is proved on.

The mission (`mission` and what it uses) is written once. An engine moves the robots and tells it what happened:
the Mesa model of this package, or ROS nodes. No module here knows ROS, looks a clock up or uses a global generator.
"""
