"""Read maps from files. Programs of users import this name; the code is in ``move_base_abstract.maps.map_files``."""
from move_base_abstract.maps.map_files import load_map, read_description, read_pixels

__all__ = ['load_map', 'read_description', 'read_pixels']
