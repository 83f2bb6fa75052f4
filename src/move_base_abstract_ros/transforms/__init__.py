"""Frames in tf: what this process tells, what it looks up, and who else says something of its frames."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'tf_hub': 'send', 'tf_lookup': 'TfLookup', 'tf_watch': 'claim'})
