"""Experiments: run any user's system many times, on all cores and on other machines, and write tidy tables of results.

The border of this package: it describes runs, starts them and reads their event logs. None of its programs is a node.
Parts that must be nodes (the one that ends a trial at a message, the recorder of messages) are modules of
`move_base_abstract_ros.nodes`.
"""
