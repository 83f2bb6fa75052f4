"""What is put in the place of names of rospy, actionlib and Python's library, and the one table of it."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'replaced': 'replace'})
