"""Run an unchanged launch file in lockstep, and verify that it runs the same whatever the machine does.

The border: this room reads launch files by roslaunch's own classes and starts processes. It is no node, and takes no
part in a run.
"""
