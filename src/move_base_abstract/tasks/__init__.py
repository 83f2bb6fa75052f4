"""Places where robots work, tasks that arrive, and which robot works where."""
from ..common.handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'arrivals': 'Listed Poisson Task read_arrivals', 'place_tasks': 'PlaceTaskRunner', 'room': 'Guest Room Rooms',
    'places': 'Place Work read_places', 'timed_task': 'TimedTaskRunner'})
