"""Places where robots work, tasks that arrive, and which robot works where."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .arrivals import Listed as Listed, Poisson as Poisson, Task as Task, read_arrivals as read_arrivals
    from .place_tasks import PlaceTaskRunner as PlaceTaskRunner
    from .places import Place as Place, Work as Work, read_places as read_places
    from .room import Guest as Guest, Room as Room, Rooms as Rooms
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
