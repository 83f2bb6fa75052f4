"""What becomes of circles of waiting that one robot closes: named, an aborted goal, or one that gives way."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple

from ..goals.events import Held, Warned
from ..goals.outcome import NO_CONTROL
from ..goals.traffic_events import Deadlock
from .giving_way import way_back, who_gives_way
from .rules import DeadlockPolicy
from .waiting_circle import waiting_circle

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from .area import Area
    from .giving_way import WayBack
    from .traveller import Traveller


class Circles:
    """Those of one ``traveller`` (Traveller), by ``policy`` (DeadlockPolicy)."""

    def __init__(self, traveller: Traveller, policy: DeadlockPolicy, navigator: Navigator, stream: Stream) -> None:
        #: the legs that it has driven since it held no place, (leg, how far [m])
        self.driven: List[Tuple[Any, float]] = []
        self._traveller = traveller
        self._policy = policy
        self._navigator = navigator
        self._tell = stream.tell
        if policy is DeadlockPolicy.RETREAT:
            stream.subscribe('traffic', {Held: self._look_again})

    def look(self, now_ns: int) -> None:
        """The robot waits, and may close circles of waiting: name each once, and have one give way if that is chosen.

        Who gives way is not in any circle any more, so that each of them has an end.
        """
        while self._traveller.request is not None:  # None: it was broken off, or gave way
            circle = waiting_circle(self._traveller.request)
            requests: List[Any] = [traveller.request for traveller, _ in circle or ()]
            if circle is None or all(one.is_in_circle for one in requests):
                return
            for one in requests:
                one.is_in_circle = True
            yields = _who_gives_way(circle) if self._policy is DeadlockPolicy.RETREAT else None
            self._name(circle, yields and yields[0], now_ns)
            if self._policy is DeadlockPolicy.ABORT:
                self._navigator.shut_down(NO_CONTROL, now_ns)
            if yields is None:
                return
            for one in requests:
                one.is_in_circle = False
            traveller, way = yields
            traveller.serve(lambda one, at_ns, way=way: one.gives_way(way, at_ns), now_ns)  # type: ignore[misc]

    def way_back(self) -> Optional[WayBack]:
        """Return the way back to where it holds no place, or None: there is none, or something else holds it, too."""
        one = self._traveller
        return way_back(self.driven, one.held, one.stays, one.edges) if one.waits_only else None

    def _look_again(self, event: Held) -> None:
        """Nothing else holds it any more: in a circle that there is still, it may give way now."""
        request = self._traveller.request
        if request is not None and request.is_in_circle and self._traveller.waits_only:
            request.is_in_circle = False
            self.look(event.time_ns)

    def _name(self, circle: Sequence[Tuple[Traveller, Area]], yields: Optional[Traveller], now_ns: int) -> None:
        pairs = [(traveller.name, area.name) for traveller, area in circle]
        name = self._traveller.name
        self._tell(Deadlock(now_ns, name, tuple(part for pair in pairs for part in pair)))
        what = ''
        if self._policy is DeadlockPolicy.ABORT:
            what = ' The goal of {}, who closed it, is aborted.'.format(name)
        elif self._policy is DeadlockPolicy.RETREAT:
            what = ' {} gives way.'.format(yields.name) if yields else ' None of them has anywhere to go.'
        self._tell(Warned(now_ns, name, 'Robots wait for one another in a circle: {}.{}'.format(
            '; '.join('{} for {}'.format(*pair) for pair in pairs), what)))


def _who_gives_way(circle: Sequence[Tuple[Traveller, Area]]) -> Optional[Tuple[Traveller, WayBack]]:
    """Return the first one of those who are to give way that has a way back, and that way, or None."""
    for traveller in who_gives_way(circle):
        way = traveller.circles.way_back()
        if way is not None:
            return traveller, way
    return None
