"""Exceptions that the program does not catch, and failed jobs whose outcome it never asks for, as events of the run."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'uncaught': 'tell'})
