"""Plans for many robots on a grid (MAPF): the program ``mapf`` reads those of solvers and has a fleet drive them.

A program, no node: it reads maps, problems and plans, and writes files.
"""
