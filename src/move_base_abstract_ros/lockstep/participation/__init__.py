"""A participant's process: how it joins the run, answers grants, and leaves."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'joining': 'join node_is_there participant take_part', 'taking_part': 'Participant'})
