"""Reading maps from files, under the name by which users' programs import it; it lies in the core's room of maps."""
from move_base_abstract.maps.map_files import load_map, read_description, read_pixels

__all__ = ['load_map', 'read_description', 'read_pixels']
