"""One robot in traffic: the places that it holds or waits for, and what it does at each border on its way."""
from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Sequence, Tuple, Union

from ..common.ros_names import natural_order
from ..goals.events import Abandoned, BrokenOff, Stands
from ..goals.traffic_events import Entered, GaveWay, Left, Prioritized
from .area import Area, Request
from .circles import Circles
from .drives import next_change
from .holder import Holder
from .outline import BORDER
from .rules import DeadlockPolicy
from .safe_states import needs_and_keeps, needs_of
from .spots import standing_on
from .way import crossings, stays_of, with_groups

if TYPE_CHECKING:
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..maps.lane_map import Edge, LaneMap
    from .control import Traffic
    from .giving_way import WayBack
    from .lane_places import WayOver
    from .way import Crossing, Stay

#: a robot that only leaves an area comes before everything else that robots do at that instant
_LEAVING_INDEX = -1
#: the policies with which robots may be careful, see :mod:`.safe_states`
_SAFE = (DeadlockPolicy.AVOID, DeadlockPolicy.RETREAT)


class Traveller(Holder):
    """One robot in traffic.

    ``needs``: the areas (Area, ...) into which it must still come on its way, up to where it holds no place at all;
    ``keeps``: those in which it then stays, None: it has no way. Both are noted only if the policy may look for safe
    states.
    """

    def __init__(self, traffic: Traffic, navigator: Navigator, lanes: Optional[LaneMap], stream: Stream,
                 priority: int = 0) -> None:
        self.priority = priority  # a robot with a higher one comes first where robots wait
        super().__init__(traffic, navigator, lanes, stream)
        self.index = navigator.robot.index
        self.rank: Tuple[Any, ...] = natural_order(self.name)  # the order of robots that ask at the same instant
        self.place = 0  # its number among all robots in the order of ``rank``
        #: what it asks for while it drives; it is decided at the end of the instant
        self.asked: Optional[Request] = None
        self.needs: Tuple[Area, ...] = ()
        self.keeps: Optional[Tuple[Area, ...]] = None
        #: whether it enters an area only if that is safe, see :mod:`.safe_states`: with AVOID, or after it gave way
        self.is_careful: bool = traffic.rules.policy is DeadlockPolicy.AVOID
        #: the edges (Edge, ...) of the net on which it drives
        self.edges: Sequence[Edge] = lanes.edges if lanes is not None else ()
        if lanes is not None and traffic.rules.lane_price:
            source = lanes.source
            navigator.planner.prices = lambda edge, time_ns: traffic.price(self, source, edge, time_ns)
        self._standing = standing_on(lanes, self, traffic, navigator.travel)
        self._leg: Any = None
        self._pose: Any = None  # its pose while it stands
        self._crossings: List[Crossing] = []
        self._event: Any = None
        self._granted: Tuple[Area, ...] = ()  # the areas in which it got a place but for which it has not departed yet
        #: handles the circles of waiting that it closes (Circles)
        self.circles: Circles = Circles(self, traffic, navigator, stream)
        stream.subscribe('traffic', {Stands: self._stands, Abandoned: lambda event: self.abandons(event.time_ns),
                                     BrokenOff: self._put_in_order})
        if navigator.takes_none is not None:
            navigator.robot.follow(self._drives)
        navigator.travel.set_gate(self)
        navigator.travel.limited = traffic.limited

    def serve(self, step: Callable[[Traveller, int], object], now_ns: int) -> None:
        """Do ``step`` (a method of this class) while another robot acts; an error breaks off this robot's goal only."""
        try:
            step(self, now_ns)
        except Exception as error:
            self.navigator.break_off(error)

    def _put_in_order(self, event: BrokenOff) -> None:
        """Repair the places after an error: hold one wherever the robot stands and nowhere else, and wait for none."""
        now_ns = event.time_ns
        self._forget_crossings()
        granted, pose = self._granted, self.navigator.robot.pose_at(now_ns)
        self._leg, self._granted, self.request, self._pose, self.needs, self.keeps = None, (), None, pose, (), None
        self.circles.driven.clear()
        self.is_careful = self._traffic.rules.policy is DeadlockPolicy.AVOID
        self.held.clear()
        told: List[Union[Entered, Left]] = []
        for area in self._traffic.areas():
            for requests in (area.queue, area.watchers):
                requests[:] = [request for request in requests if request.traveller is not self]
            had = self in area.holders
            has = area.contains(pose.x, pose.y) or (area.outline is None and had and area not in granted)
            if has:
                self.held[area] = area.holders[self] = True
            else:
                area.holders.pop(self, None)
            if has != had:
                told.append(Entered(now_ns, self.name, 'entered', area.name) if has else
                            Left(now_ns, self.name, 'left', area.name))
            self._traffic.changed(area)
            self._traffic.freed(area)
        with ExitStack() as rest:  # these callbacks run even if telling fails; the last one runs first
            rest.callback(self._traffic.serve, now_ns)
            rest.callback(self._end_hold, now_ns)
            for one in told:
                self.tell(one)

    def departs(self, leg: Any, now_ns: int) -> None:
        """Note that the robot starts on ``leg``; see Travel.set_gate."""
        self._leg = leg
        self._granted = ()
        self._crossings = crossings(with_groups(self.stays(leg)), self.held) if leg.distance > BORDER else []
        first = next((one for one in self._crossings[:1] if one.distance == 0.0), None)
        if not self.held or (first is not None and set(self.held) <= set(first.leaves)):
            self.circles.driven.clear()
        self._note_needs()
        self._traffic.ways_out.departs(self, now_ns)
        if first is not None:
            self._cross(now_ns)
        else:
            self._await_crossing()

    def stays(self, way: Any) -> Sequence[Stay]:
        """Return the Stays of a leg, or of a WayBack, in zones, on lanes and at nodes."""
        if self.lanes is None:
            return self._traffic.zones.stays(way.way)
        source = self.lanes.source
        return stays_of(way, self._traffic.zones, lambda edge: self._traffic.lane(source, edge),
                        self._traffic.nodes(source))

    def _stands(self, event: Stands) -> None:
        """Note that the robot stands: it has arrived, was stopped, or was placed somewhere else."""
        now_ns = event.time_ns
        pose = self.navigator.robot.pose_at(now_ns)
        before = self._pose if self._leg is None else self._leg.pose_at(now_ns)
        if self._leg is not None and self._traffic.rules.policy is DeadlockPolicy.RETREAT:
            self.circles.driven.append((self._leg, self._leg.distance_at(now_ns)))
        self._leg = None
        self._forget_crossings()
        if before is None or (before.x, before.y) != (pose.x, pose.y):
            self.placed(now_ns)
        else:
            self._pose = pose
            self._take_what_holds_it(now_ns, pose)
            self._traffic.serve(now_ns)

    def _drives(self, now_ns: int) -> None:
        """Note that the robot, which is driven by velocities, has begun another motion, or stands."""
        self._forget_crossings()
        leg = self.navigator.robot.leg
        found = None if leg is None else next_change(leg, self._traffic.zones, self.held, now_ns)
        if found is not None:
            due_ns, area = found
            self._event = self._traffic.simulation.queue.schedule(
                due_ns, _LEAVING_INDEX if area in self.held else self.place, self._passes_border,
                keeps_going=lambda: bool(area.queue))  # without a watchdog it may drive in circles for ever

    def _passes_border(self, due_ns: int, _now_ns: int) -> None:
        """Hold places where the robot is now: driven by velocities, it waits for none."""
        self._event = None
        self.placed(due_ns)
        self._drives(due_ns)

    def set_priority(self, priority: int, now_ns: int) -> None:
        """Give the robot another priority from ``now_ns`` [ns] on, also where it waits already."""
        if priority == self.priority:
            return
        self.priority = priority
        self.tell(Prioritized(now_ns, self.name, priority))
        if self.request is not None:
            self.request.line_up()
            self._traffic.changed(*self.request.areas)
            for area in self.request.areas:
                self._traffic.freed(area)
            self._traffic.look_at(self, now_ns)

    def placed(self, now_ns: int) -> None:
        """Note that the robot is somewhere without having driven there: give back places elsewhere, take those here."""
        self._forget_crossings()
        self.circles.driven.clear()
        self._traffic.ways_out.placed(self)
        pose = self._pose = self.navigator.robot.pose_at(now_ns)
        self._give_back([area for area in self.held if not area.contains(pose.x, pose.y)], now_ns)
        self._take_what_holds_it(now_ns, pose)  # before abandons() lets it go on, now from inside
        if self.request is not None:
            self.abandons(now_ns)
        self._traffic.serve(now_ns)

    def abandons(self, now_ns: int) -> None:
        """Note that the robot has given up its target: it leaves the queues and stays where it is."""
        self.needs, self.keeps = (), None
        self.is_careful = self._traffic.rules.policy is DeadlockPolicy.AVOID
        self._traffic.ways_out.given_up(self, now_ns)
        if self.request is not None:
            request, self.request = self.request, None
            self._traffic.withdraw(request)
            self._end_hold(now_ns)
            self._traffic.serve(now_ns)
        elif self._granted:  # it has got a place, but another reason still holds it outside
            self._give_back_what_was_granted(now_ns)
            self._traffic.serve(now_ns)

    def leave(self, now_ns: int) -> None:
        """Note that the robot is removed from the world: give back all its places."""
        self._forget_crossings()
        self.abandons(now_ns)
        self._give_back(list(self.held), now_ns)
        self._traffic.left_by(self)
        self._traffic.serve(now_ns)

    def go_on(self, now_ns: int) -> None:
        """Take the places that it asks for, and drive on. If it waits, it gives back others at its departure."""
        if self.asked is not None:
            asked, self.asked = self.asked, None
            asked.withdraw()
            self._passes(asked.areas, now_ns)
            for area in asked.areas:
                self._traffic.freed(area)
            return
        request: Any = self.request
        self.request = None
        request.withdraw()
        self._take(request.areas, now_ns)
        self._granted = request.areas
        for area in request.areas:
            self._traffic.freed(area)  # there may be place for more
        self._end_hold(now_ns)
        # If there is no way any more:
        if self._leg is None and self.request is None and not self.navigator.travel.held_for:
            self._give_back_what_was_granted(now_ns)

    def _give_back_what_was_granted(self, now_ns: int) -> None:
        granted, self._granted = self._granted, ()
        self._give_back([area for area in granted if not area.contains(self._pose.x, self._pose.y)], now_ns)

    def _await_crossing(self) -> None:
        if not self._crossings:
            return
        crossing = self._crossings[0]
        due_ns = self._leg.covers_ns(crossing.distance)
        index = self.place if crossing.enters else _LEAVING_INDEX
        self._event = self._traffic.simulation.queue.schedule(due_ns, index, self._happen)

    def _happen(self, due_ns: int, _now_ns: int) -> None:
        self._event = None
        try:
            if self._traffic.ways_out.turns(self):
                self.navigator.travel.change_way(due_ns)
            else:
                self._cross(due_ns)
            self._traffic.serve(due_ns)
        except Exception as error:
            self.navigator.break_off(error)

    def _goes_another_way(self, now_ns: int) -> bool:
        """If another way is cheaper now than to wait on this one, take that way; return whether the robot did."""
        if not self._traffic.rules.lane_price or self._crossings[0].distance == 0.0:
            return False
        travel = self.navigator.travel
        target: Any = travel.target  # there is one, since the robot drives
        corners = self.navigator.planner.corners(self.navigator.robot.pose_at(now_ns), target)
        ahead = self._leg.corners_ahead(now_ns)
        if corners is None or tuple(corners) == ahead[len(ahead) - len(corners):]:
            return False
        travel.change_way(now_ns, corners)
        return True

    def _note_needs(self) -> None:
        if self._traffic.rules.policy in _SAFE:  # nobody asks otherwise, and this comes at each crossing
            needed, kept = self.needs, self.keeps
            self.needs, self.keeps = needs_and_keeps(self._crossings, self.held)
            if any(area not in needed for area in self.needs) or self.keeps and self.keeps != kept:
                self._traffic.ways_out.needs_more()

    def _enters(self) -> Tuple[Area, ...]:
        return tuple([area for area in self._crossings[0].enters if area not in self.held])

    def _cross(self, now_ns: int) -> None:
        """Have the robot enter and leave areas at its next crossing; if it must ask for places, go on with that."""
        enters = self._enters()
        if self._traffic.rules.blocks == 1 and all(area.capacity is None and not area.is_closed for area in enters):
            self._passes(enters, now_ns)
        elif enters:
            self.asked = Request(now_ns, self, enters, self._looks_at(enters))
            self._traffic.ask(self.asked, now_ns)
        else:
            self._passes((), now_ns)

    def _passes(self, enters: Tuple[Area, ...], now_ns: int) -> None:
        """Enter the areas ``enters`` at the next crossing, and leave those that end there."""
        crossing = self._crossings.pop(0)
        self._take(enters, now_ns)
        self._give_back(crossing.leaves, now_ns)
        if self._standing and self._standing.goes_elsewhere(now_ns):
            return
        self._note_needs()
        self._await_crossing()

    def waits(self, now_ns: int) -> None:
        """Stop where the robot asked for places that it does not get now, or take another way."""
        request: Any = self.asked
        self.asked = None
        request.withdraw()
        if self._goes_another_way(now_ns) or self._standing and self._standing.goes_aside(
                self._crossings[0].leaves, now_ns):
            return
        request.line_up()
        crossing = self._crossings.pop(0)
        self._forget_crossings()
        self._give_back(crossing.leaves_anyway() or self._traffic.ways_out.leaves(self, crossing.leaves), now_ns)
        self.request = request
        self._traffic.changed(*request.areas)
        self._reason = request.reason
        self.navigator.travel.hold(request.reason, now_ns)
        self.circles.look(now_ns)

    def _looks_at(self, enters: Tuple[Area, ...]) -> Tuple[Area, ...]:
        """Return the areas behind those that it ``enters`` now that must have room, too."""
        blocks = self._traffic.rules.blocks
        if blocks == 1 or not enters:
            return ()
        ways = needs_of(self._crossings, self.held)
        return tuple(area for area in ways if area not in self.held and area not in enters)[:max(
            0, blocks - len(enters))]

    @property
    def wants(self) -> Optional[Request]:
        """The request for which it waits, or which it has made at this instant on its way; None: there is none."""
        return self.request if self.asked is None else self.asked

    def gives_way(self, way: WayBack, now_ns: int) -> None:
        """Stop waiting, drive back by ``way``, and go on to the goal from there."""
        request: Any = self.request
        reason: Any = self._reason
        self._reason = self.request = None
        self.is_careful = True
        self._traffic.withdraw(request)
        self.tell(GaveWay(now_ns, self.name, tuple(area.name for area in self.held if area.capacity is not None)))
        self.navigator.travel.go_aside(reason, way, now_ns)

    def goes_out(self, now_ns: int) -> None:
        """Begin with the moves of a way out of a jam, or, when they are over, go on as always."""
        pose = self.navigator.robot.pose_at(now_ns)
        if self._traffic.ways_out.is_at_node(self, now_ns):
            self._give_back([area for area in self.held if not area.contains(pose.x, pose.y)], now_ns)
        if self.request is not None:
            request, self.request = self.request, None
            self._traffic.withdraw(request)
            self._end_hold(now_ns)
        elif self.navigator.robot.leg is not None:
            self.navigator.travel.change_way(now_ns)

    def way_on(self, now_ns: int) -> Optional[Tuple[WayOver, bool]]:
        """Return the way by which the robot has to go on; see Travel.set_gate."""
        return self._traffic.ways_out.way_on(self, now_ns)

    def _forget_crossings(self) -> None:
        self._crossings = []
        if self._event is not None:
            self._event.cancel()
            self._event = None
        asked, self.asked = self.asked, None
        if asked is not None:
            asked.withdraw()
            for area in asked.areas:
                self._traffic.freed(area)
