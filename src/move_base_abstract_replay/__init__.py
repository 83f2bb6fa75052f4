"""Replays of event logs: a page that shows the robots move, and files for the tools that read ROS messages.

This is a program, not a node: it reads logs and maps, and writes files. It shows what the run has computed.
"""
