"""Maps from files and topics, the map as one robot uses it, and the topics of costmaps and plans."""
from move_base_abstract.common.handed_on import handed_on

__getattr__ = handed_on(__name__, {'map_files': 'load_map read_description'})
