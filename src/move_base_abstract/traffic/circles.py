"""Circles of waiting that one robot closes: each is reported, then a goal is aborted or a robot gives way."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple

from ..goals.events import Abandoned, Held, Warned
from ..goals.outcome import NO_CONTROL
from ..goals.traffic_events import Deadlock
from .giving_way import way_back, who_gives_way
from .rules import DeadlockPolicy
from .waiting import WaitingGraph

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from .control import Traffic
    from .giving_way import WayBack
    from .traveller import Traveller
    from .waiting import Reason

_MOST_TIMES = 3  # that a robot gives way in the same circle for the same goals


class Circles:
    """Handle the circles of waiting that one ``traveller`` (Traveller) closes, as the rules of ``traffic`` say."""

    def __init__(self, traveller: Traveller, traffic: Traffic, navigator: Navigator, stream: Stream) -> None:
        #: the legs that the robot has driven since it last held no place: (leg, distance driven on it [m])
        self.driven: List[Tuple[Any, float]] = []
        self._traveller = traveller
        self._traffic = traffic
        self._policy = traffic.rules.policy
        self._navigator = navigator
        self._tell = stream.tell
        self.goals = 0  # the number of its goals that have ended
        self._forgotten: Optional[int] = None  # the number of the last goal for which it was forgotten
        self._resolved: Dict[Any, int] = {}  # how often it has given way in which circle, for its present goal
        if self._policy is DeadlockPolicy.RETREAT:
            stream.subscribe('traffic', {Held: self._look_again, Abandoned: self._goal_ended})

    def look(self, now_ns: int) -> None:
        """Report each circle of waiting that the robot closes, once, and resolve it as the policy says.

        If no robot of a circle could give way when it was reported, and one can now, it is reported again. A robot that
        gives way is in no circle any more, so the loop ends.
        """
        while self._may_be_in_circle() and not self._traffic.ways_out.solves(self._traveller):
            request: Any = self._traveller.request
            circle = WaitingGraph((request,), self._traffic.against).circle(self._traveller)
            if circle is None or not self.resolves(circle, now_ns):
                return

    def resolves(self, circle: Sequence[Tuple[Traveller, Reason]], now_ns: int) -> bool:
        """Report ``circle``, and resolve it as the policy says; return whether a robot gives way.

        Nothing is done if it has been reported, and no robot can give way.
        """
        requests: List[Any] = [traveller.request for traveller, _ in circle]
        yields = None
        if self._policy is DeadlockPolicy.RETREAT:
            yields = _who_gives_way(circle)
            if yields is None:
                self._traffic.look_at(self._traveller)
        if yields is None and all(one.is_in_circle for one in requests):
            return False
        for one in requests:
            one.is_in_circle = yields is None
        self._name(circle, yields and yields[0], now_ns)
        if self._policy is DeadlockPolicy.ABORT:
            self._navigator.shut_down(NO_CONTROL, now_ns)
        if yields is None:
            return False
        traveller, way = yields
        traveller.circles.gives_way_in(circle)
        traveller.serve(lambda one, at_ns, way=way: one.gives_way(way, at_ns), now_ns)  # type: ignore[misc]
        return True

    def is_forgotten(self, now_ns: int) -> None:
        """Report, once, that nothing is left that could happen and the robot has a goal, but no reason to stand."""
        request, navigator = self._traveller.request, self._navigator
        is_held = bool(navigator.travel.held_for) and not self._traveller.waits_only
        if navigator.goal_number == self._forgotten or is_held or not navigator.is_active:
            return
        self._forgotten = navigator.goal_number
        name, area = self._traveller.name, 'nothing' if request is None else request.areas[0].name
        self._tell(Deadlock(now_ns, name, (name, area)))
        self._tell(Warned(now_ns, name, '{} waits for {} for ever, although nothing keeps it out. This is an error of '
                          'move_base_abstract; please report it.'.format(name, area)))

    def _may_be_in_circle(self) -> bool:
        """Return whether a robot for which this one may wait may wait for this one.

        The search is for the robots behind this one, which are few, while those ahead may be a whole jam.
        """
        request = self._traveller.request
        if request is None:
            return False
        if self._policy in (DeadlockPolicy.AVOID, DeadlockPolicy.RETREAT):  # careful robots may wait for any other
            return bool(self._traveller.held) or any(area.queue[-1] is not request for area in request.areas)
        behind = {self._traveller: True}
        open_ = [request]
        for one in open_:
            following = [other for area in one.traveller.held for other in (*area.queue, *area.watchers)]
            for area in one.areas:
                following += area.queue[area.queue.index(one) + 1:]
            for other in following:
                if other.traveller not in behind:
                    behind[other.traveller] = True
                    open_.append(other)
        return any(one in behind for area in (*request.areas, *request.ahead) for one in area.holders) or any(
            one.traveller in behind for area in request.areas for one in area.queue[:area.queue.index(request)])

    def way_back(self) -> Optional[WayBack]:
        """Return the way back to where the robot holds no place.

        The result is None if there is no such way, or if the robot is also held for another reason.
        """
        one = self._traveller
        return way_back(self.driven, one.held, one.stays, one.edges) if one.waits_only else None

    def gives_way_in(self, circle: Sequence[Tuple[Traveller, Reason]]) -> None:
        """Note that the robot gives way in ``circle``."""
        key = _key(circle)
        self._resolved[key] = self._resolved.get(key, 0) + 1

    def is_tired_of(self, circle: Sequence[Tuple[Traveller, Reason]]) -> bool:
        """Return whether the robot has given way so often in ``circle`` that it does no good: nobody got to a goal."""
        return self._resolved.get(_key(circle), 0) >= _MOST_TIMES

    def _goal_ended(self, _event: Abandoned) -> None:
        self.goals += 1
        self._resolved.clear()

    def _look_again(self, event: Held) -> None:
        """If the robot is in a circle and no other reason holds it any more, it may give way now: look again."""
        request = self._traveller.request
        if request is not None and request.is_in_circle and self._traveller.waits_only:
            self._traffic.look_at(self._traveller, event.time_ns)

    def _name(self, circle: Sequence[Tuple[Traveller, Reason]], yields: Optional[Traveller], now_ns: int) -> None:
        pairs = [(traveller.name, reason.area.name) for traveller, reason in circle]
        name = self._traveller.name
        self._tell(Deadlock(now_ns, name, tuple(part for pair in pairs for part in pair)))
        what = ''
        if self._policy is DeadlockPolicy.ABORT:
            what = ' The goal of {}, which closed it, is aborted.'.format(name)
        elif self._policy is DeadlockPolicy.RETREAT:
            what = ' {} gives way.'.format(yields.name) if yields else ' None of them can give way.'
        self._tell(Warned(now_ns, name, 'Robots wait for one another in a circle: {}.{}'.format(
            '; '.join(_words(*pair) for pair in zip(circle, [*circle[1:], circle[0]])), what)))


def name_standstill(traffic: Traffic, now_ns: int) -> None:
    """Have it reported, and resolved, what keeps robots waiting when nothing is left that could happen.

    These are the circles that nobody has seen to close, and robots that have a goal, and nothing keeps them.
    """
    waiting = {one: one.request for one in traffic.travellers() if one.request is not None}
    graph = WaitingGraph(waiting.values(), traffic.against)
    circles = [circle for circle in map(graph.circle, waiting) if circle is not None]
    named = {one: True for circle in circles if all(waiting[one].is_in_circle for one, _ in circle)
             for one, _ in circle}
    for circle in circles:
        robots = [one for one, _ in circle]
        if not any(one in named for one in robots):
            last = max(robots, key=lambda one: waiting[one])
            if last.circles.resolves(circle, now_ns) or last.request is None:
                traffic.serve(now_ns)
                return  # the fleet goes on
            named.update(dict.fromkeys(robots, True))
    for one in traffic.travellers():
        if not graph.reasons.get(one):
            one.circles.is_forgotten(now_ns)


def _key(circle: Sequence[Tuple[Traveller, Reason]]) -> Tuple[Tuple[str, str, int], ...]:
    """Return by what a circle is known again as long as none of its robots has got to its goal."""
    return tuple((one.name, reason.area.name, one.circles.goals) for one, reason in circle)


def _words(waits: Tuple[Traveller, Reason], following: Tuple[Traveller, Reason]) -> str:
    traveller, reason = waits
    return '{} for {}{}'.format(traveller.name, reason.area.name, ', which would cut {} off'.format(
        following[0].name) if reason.is_unsafe else '')


def _who_gives_way(circle: Sequence[Tuple[Traveller, Reason]]) -> Optional[Tuple[Traveller, WayBack]]:
    """Return (the first robot that should give way and has a way back, that way), or None if there is none."""
    for traveller in who_gives_way(circle):
        way = traveller.circles.way_back()
        if way is not None and not traveller.circles.is_tired_of(circle):
            return traveller, way
    return None
