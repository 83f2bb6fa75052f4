"""A team of robots maps the soil compaction of a field. The simulator is tested on this study.

The mission (`mission` and what it uses) is written once. An engine moves the robots and tells the mission what
happened. The engines are the Mesa model of this package, and ROS nodes. The mission uses neither ROS, nor a clock, nor
a global random generator.
"""
