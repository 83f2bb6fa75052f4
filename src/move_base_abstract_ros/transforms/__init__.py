"""Frames in tf: publishing, looking up, and a watch for other nodes that publish the same frames."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'tf_hub': 'send', 'tf_lookup': 'TfLookup', 'tf_watch': 'claim'})
