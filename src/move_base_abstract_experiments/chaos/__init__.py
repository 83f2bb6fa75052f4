"""Chaos: try seeds, which choose other legal orders of equal events, until a run fails; then find the fewest decisions.

The decisions of a seed are those that make its run differ from one in the stated order.
"""
