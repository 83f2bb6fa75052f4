"""Experiments: any user's system, many times, on all cores and on other machines; what came out as tidy tables.

The border: this room describes runs, starts them and reads their event logs. None of its programs is a node; what must
be one (the end at a message, the recorder of messages) is a module of `move_base_abstract_ros.nodes`.
"""
