"""Replacements for functions and classes of rospy, actionlib and Python's library, and the one table of them."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'replaced': 'replace'})
