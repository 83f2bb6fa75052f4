"""Replacements for functions and classes of rospy, actionlib and Python's library, and the one table of them."""
