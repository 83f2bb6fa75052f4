"""Run an unchanged launch file in lockstep, and verify that it runs the same whatever the machine does.

This package reads launch files with roslaunch's own classes, and starts processes. It is not a node, and takes no part
in a run.
"""
