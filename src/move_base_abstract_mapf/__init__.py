"""Plans for many robots on a grid (MAPF): the program ``mapf`` reads the plans of solvers and lets a fleet drive them.

This is a program, not a node: it reads maps, problems and plans, and writes files.
"""
