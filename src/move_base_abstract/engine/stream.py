"""A stream of events, which delivers each to its subscribers in a stated order."""
from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, Type

#: a function that takes one event
Hear = Callable[[Any], object]


class Stream:
    """Delivers events, which are values of any type, to the functions that have subscribed to that type.

    ``order``: the names of all possible subscribers. They get an event in this order, whenever they subscribed. If a
    subscriber raises an error, the others get the event nevertheless; then the first error is raised. If a subscriber
    sends another event, that one is delivered at once, before later subscribers get the first event.
    """

    def __init__(self, order: Sequence[str]) -> None:
        self._places = {name: place for place, name in enumerate(order)}
        self._subscribed: Dict[Type[Any], List[Tuple[int, Hear]]] = {}
        #: {type of events: what delivers one to all that have subscribed}; an event whose type is not in it need not
        #: be made
        self.hearers: Dict[Type[Any], Hear] = {}

    def subscribe(self, name: str, hears: Mapping[Type[Any], Hear]) -> None:
        """Call the functions in ``hears`` with each event of their type, in the place of ``name`` in the order."""
        for kind, hear in hears.items():
            subscribed = [*self._subscribed.get(kind, ()), (self._places[name], hear)]
            subscribed.sort(key=lambda one: one[0])
            self._subscribed[kind] = subscribed
            self.hearers[kind] = hear if len(subscribed) == 1 else _to_all([one[1] for one in subscribed])

    def copy(self) -> Stream:
        """Return a stream with the subscribers that this one has now: many streams share what stands for them."""
        copied = Stream(())
        copied._places, copied._subscribed, copied.hearers = self._places, self._subscribed.copy(), self.hearers.copy()
        return copied

    def tell(self, event: Any) -> None:
        """Deliver ``event`` to all functions that have subscribed to its type.

        :raises Exception: the first error of a subscriber, after all have got the event.
        """
        hear = self.hearers.get(type(event))
        if hear is not None:
            hear(event)


def _to_all(hears: Sequence[Hear]) -> Hear:
    def deliver(event: Any) -> None:
        fault = None
        for hear in hears:
            try:
                hear(event)
            except Exception as error:
                fault = fault or error
        if fault is not None:
            raise fault
    return deliver
