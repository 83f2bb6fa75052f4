"""The program that a command line runs, its kind, and how a binary or a shell script is started."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'command_line': 'find'})
