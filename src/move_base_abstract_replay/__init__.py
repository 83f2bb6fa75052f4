"""Replays of event logs: a page that shows the robots move, and files for the tools that read ROS messages.

A program, no node: it reads logs and maps, and writes files. What it shows was computed by the run.
"""
