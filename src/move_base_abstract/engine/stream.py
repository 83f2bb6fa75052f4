"""Events, delivered to their subscribers in a stated order."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, Type

#: takes one event
Hear = Callable[[Any], object]


class Stream:
    """Events are values of any type; who hears one of them is told by its type.

    ``order``: the names of all who may subscribe, the first of them is told first, whoever subscribed when. All are
    told, whatever goes wrong with one of them; then the first error is raised. What a subscriber tells in its turn
    comes at once, before those behind it hear what it heard.
    """

    def __init__(self, order: Sequence[str]) -> None:
        self._places = {name: place for place, name in enumerate(order)}
        self._subscribed: Dict[Type[Any], List[Tuple[int, Hear]]] = {}
        #: {type of events: who hears them}; types that nobody hears are not there, and need not be made
        self.hearers: Dict[Type[Any], Tuple[Hear, ...]] = {}

    def subscribe(self, name: str, hears: Mapping[Type[Any], Hear]) -> None:
        """Have each event of a type in ``hears`` handed to its function, in the place of ``name`` in the order."""
        for kind, hear in hears.items():
            subscribed = self._subscribed.setdefault(kind, [])
            subscribed.append((self._places[name], hear))
            subscribed.sort(key=lambda one: one[0])
            self.hearers[kind] = tuple(one[1] for one in subscribed)

    def tell(self, event: Any) -> None:
        """Tell all who hear events of its type of ``event``."""
        fault = None
        for hear in self.hearers.get(type(event), ()):
            try:
                hear(event)
            except Exception as error:
                fault = fault or error
        if fault is not None:
            raise fault
