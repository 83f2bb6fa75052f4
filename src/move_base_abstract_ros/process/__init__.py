"""A node as a process: its command line, its start, its end, and watches of the ROS master and of /clock."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'node_process': 'run_node'})
