"""Chaos: try seeds, which choose orders, delays and late starts, until a run fails; then find the fewest decisions.

The decisions of a seed are those that make its run differ from one in the stated order.
"""
