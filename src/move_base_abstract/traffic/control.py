"""Traffic: zones, lanes and nodes with place for a limited number of robots, on top of Travel.hold.

A robot asks for a place when it comes to the border of an area. If there is none, it waits there, outside, and its goal
stays active. Robots are served by priority, then in the order in which they ask, at one instant by name; the docstring
of :meth:`.Area.first` says which robots may be overtaken. Who gets a place is decided at the end of an instant. A robot
gives its place back when it comes to the border on its way out. If it goes from one area directly into another, it
gives the place back when it has got a place in the other one. At a node where it has a place, it gives back all others
that end there.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Optional, Tuple

from ..common.errors import ConfigurationError
from ..common.parameter_table import checked
from ..common.shown import shown_text
from ..common.units import NS_PER_S
from ..goals.traffic_events import Paced, ZoneLimit
from ..maps.lane_map import LaneMap
from .area import Area
from .circles import name_standstill
from .nodes import NodeAreas
from .outline import BORDER
from .rules import DeadlockPolicy, TrafficRules
from .safe_states import SafeStates, first_to_go_on, is_plainly_safe
from .traveller import Traveller
from .waiting import in_words, reasons_of
from .way import ZoneIndex
from .ways_out import WaysOut
from .zones import MAX_SPEED, limited

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..motion.geometry import Pose2D
    from .area import AreaState, Request
    from .zones import Zone

_CLOSED_NS = 3600 * NS_PER_S  # the price of a way through a closed zone


class Traffic:
    """The zones (Zone, ...), lanes and nodes of one process, and the robots that hold a place in them.

    Not thread-safe, just as the simulation.
    """

    def __init__(self, simulation: Simulation, zones: Tuple[Zone, ...] = (),
                 rules: TrafficRules = TrafficRules()) -> None:
        self.simulation = simulation
        self.rules = rules
        self._followers: List[Callable[[], object]] = []
        self._groups: Dict[str, Area] = {}
        self._zones = {zone.name: Area('zone', zone.name, zone.capacity, zone.outline, self._group(zone.group))
                       for zone in zones}
        #: the areas of all zones (ZoneIndex), in the order of the scenario
        self.zones = ZoneIndex(self._zones.values())
        self._limits = {zone.name: zone.max_speed for zone in zones if zone.max_speed is not None}
        self._lanes: Dict[Tuple[str, int], Area] = {}  # (file, index of the edge)
        self._nodes: Dict[str, NodeAreas] = {}  # by the file
        self._on_edges: Dict[Tuple[str, int], List[Area]] = {}  # all areas in which a robot on that edge holds a place
        self._dirty: List[Area] = []  # areas in which a place may have become free, in that order
        self._is_due = False  # whether it will be decided at the end of this instant who goes on
        self._is_told = True
        self._states: Dict[Area, AreaState] = {}  # as last asked for; {}: not of these areas
        self._stale: Dict[Area, bool] = {}  # areas whose states have changed since then
        self._travellers: Dict[Traveller, bool] = {}  # in the order of their names
        self._asking: List[Request] = []  # what robots have asked for at this instant
        self._new: List[Request] = []  # those of them for which there was no place so far
        self._to_look_at: Dict[Traveller, bool] = {}  # robots that may close a circle, or may give way in theirs now
        self._asks_safe_states = rules.policy in (DeadlockPolicy.AVOID, DeadlockPolicy.RETREAT)
        self._has_moved = False  # whether anything has changed on which SafeStates depend, if these are asked
        #: has robots of a jam drive out of it (WaysOut)
        self.ways_out: WaysOut = WaysOut(self)

    def _group(self, name: Optional[str]) -> Optional[Area]:
        if name is None:
            return None
        if name not in self._groups:
            self._groups[name] = Area('group', name, self.rules.groups.get(name, 1))
        return self._groups[name]

    def join(self, navigator: Navigator, network: object, stream: Stream,
             priority: int = 0) -> Optional[Traveller]:
        """Add a robot; return its :class:`Traveller`, or None if no zone or lane here concerns it.

        ``network``: the LaneMap on which the robot drives, or any other map; ``stream``: the robot's stream of events,
        for telling and hearing; ``priority``: where robots wait, a higher priority comes first.

        :raises ConfigurationError: if a zone has a speed limit and the robot's law of motion allows none.
        """
        lanes = network if isinstance(network, LaneMap) and network.has_capacities else None
        if lanes is not None:
            for index, edge in enumerate(lanes.edges):
                if edge.is_counted and (lanes.source, index) not in self._lanes:
                    self._lanes[lanes.source, index] = Area(
                        'lane', '{} - {}'.format(edge.begin, edge.end), edge.capacity, None, self._group(edge.group))
            if lanes.source not in self._nodes:
                self._nodes[lanes.source] = NodeAreas(lanes)
        if lanes is None and not self._zones:
            return None
        self._states.clear()
        if self._limits:
            _check_law(navigator)
        if self.rules.lane_price and isinstance(network, LaneMap):
            self._put_zones_on(network)
        traveller = Traveller(self, navigator, network if isinstance(network, LaneMap) else None, stream, priority)
        self._travellers = dict.fromkeys(sorted([*self._travellers, traveller], key=lambda one: one.rank), True)
        for place, one in enumerate(self._travellers):
            one.place = place
        traveller.placed(self.simulation.now_ns)
        return traveller

    def _put_zones_on(self, lanes: LaneMap) -> None:
        """Note for each edge the zones, groups and limited lanes in which a robot on that edge holds a place."""
        for index, edge in enumerate(lanes.edges):
            if (lanes.source, index) not in self._on_edges:
                own = self._lanes.get((lanes.source, index))
                areas = [*([own] if own else []), *(stay.area for stay in self.zones.stays(edge.points))]
                groups = [area.group for area in areas if area.group is not None]
                self._on_edges[lanes.source, index] = list(dict.fromkeys([*areas, *groups]))

    def price(self, traveller: Traveller, source: str, edge: int, time_ns: int) -> int:
        """Return what an edge costs ``traveller`` in addition to the ``time_ns`` [ns] of driving on it [ns].

        That is ``lane_price`` x ``time_ns`` for each other robot that holds a place there, or waits for one before it,
        divided by the number of places. Each closed zone adds an hour. ``source``: the file of the net.
        """
        areas = self._on_edges[source, edge]
        load = sum(area.load(traveller) for area in areas)
        closed = sum(area.is_closed and traveller not in area.holders for area in areas)
        return int(self.rules.lane_price * load * time_ns) + closed * _CLOSED_NS

    def states(self) -> List[AreaState]:
        """Return the AreaState of each zone, in the order of the scenario, then of each lane, node and group."""
        if not self._states:
            self._states = {area: area.state() for area in self.areas()}
        self._states.update((area, area.state()) for area in self._stale)  # few: this comes at most instants
        self._stale.clear()
        return list(self._states.values())

    def close_zone(self, name: str, is_closed: bool) -> None:
        """Close a zone, so that no robot may come in, or open it again. Robots inside stay, and may leave.

        :raises ConfigurationError: if there is no zone of that name.
        """
        area = self._zone(name)
        area.is_closed = is_closed
        self.changed(area)
        self.freed(area)
        self.serve(self.simulation.now_ns)

    def set_zone_limit(self, name: str, max_speed: Optional[float]) -> None:
        """Limit the speed in a zone to ``max_speed`` [m/s] at once, None: no limit.

        A robot whose present way is in the zone, or still leads through it, goes on from rest, by a way planned anew.

        :raises ConfigurationError: if there is no zone of that name, if the speed is not allowed, or if the law of
            motion of a robot allows no limits.
        """
        area = self._zone(name)
        travellers = self.travellers()
        if max_speed is None:
            self._limits.pop(name, None)
        else:
            speed = checked(max_speed, 'max_speed', MAX_SPEED, "zone '{}'".format(name))
            for one in travellers:
                _check_law(one.navigator)
            self._limits[name] = speed
        if travellers:
            now_ns = self.simulation.now_ns
            travellers[0].tell(ZoneLimit(now_ns, travellers[0].name, name, max_speed or 0.0))
        for one in travellers:
            one.serve(lambda one, at_ns: _keep_limit(one, area, Paced(at_ns, one.name, name, max_speed or 0.0)), now_ns)

    def limited(self, start: Pose2D, corners: Any, goal: Pose2D) -> Any:
        """Return the way along ``corners`` with the speed limits of the zones."""
        zones = [(self._zones[name].outline, speed) for name, speed in self._limits.items()]
        return limited(start, corners, goal, zones) if zones else corners  # type: ignore[arg-type]

    def _zone(self, name: str) -> Area:
        area = self._zones.get(name)
        if area is None:
            raise ConfigurationError("zone '{}' is unknown; there are: {}".format(
                shown_text(name), ', '.join(list(self._zones)[:10]) or 'none'))
        return area

    def lane(self, source: str, edge: int) -> Optional[Area]:
        """Return the area of an edge of the net in the file ``source``, or None if its capacity is not limited."""
        return self._lanes.get((source, edge))

    def nodes(self, source: str) -> NodeAreas:
        """Return the nodes with a capacity of the net in the file ``source``, on which a robot drives."""
        return self._nodes[source]

    def freed(self, area: Area) -> None:
        """Note that a place in ``area`` may have become free; :meth:`serve` then looks there."""
        self._ask_in((area,))
        self._ask_watchers(area)

    def taken(self, area: Area) -> None:
        """Note that a robot holds a place in ``area`` now."""
        self.changed(area)
        self._ask_watchers(area)

    def _ask_watchers(self, area: Area) -> None:
        """Have :meth:`serve` look where requests wait that may go on now, or that others may overtake now."""
        for request in area.watchers:
            self._ask_in(request.areas)

    def _ask_in(self, areas: Iterable[Area]) -> None:
        for area in areas:
            if area.queue and area not in self._dirty:
                self._dirty.append(area)

    def against(self, request: Request) -> Tuple[Traveller, ...]:
        """Return the robots of which one must go on before a careful robot may have its places; (): it may.

        A robot for which alone there is no way out of a jam is against itself.
        """
        allowed = self.ways_out.allows(request.traveller, request.areas)
        if allowed is None:
            return self.safe_states().against(request)
        return () if allowed else self.ways_out.others(request.traveller) or (request.traveller,)

    def what_holds(self, name: str) -> str:
        """Return for which areas a robot waits, and which robots are why, in words; '': it waits for none."""
        requests = (one.request for one in self._travellers if one.name == name and one.request is not None)
        return in_words(reason for request in requests for reason in reasons_of(request, self.against))

    def safe_states(self) -> SafeStates:
        """Return the SafeStates of the present, valid until anything changes."""
        return SafeStates(self._travellers, self.ways_out.is_safe)

    def left_by(self, traveller: Traveller) -> None:
        """Note that ``traveller`` has been removed."""
        self._travellers.pop(traveller, None)
        self.ways_out.left(traveller)

    def travellers(self) -> List[Traveller]:
        """Return the robots, in the order of their names."""
        return list(self._travellers)

    def areas(self) -> List[Area]:
        """Return all areas: the zones in the order of the scenario, then the lanes, the nodes, and the groups."""
        nodes = [area for net in self._nodes.values() for area in net.areas.values()]
        return [*self._zones.values(), *self._lanes.values(), *nodes, *self._groups.values()]

    def changed(self, *areas: Area) -> None:
        """Note that other robots hold places in ``areas``, or wait for one; :meth:`serve` will report it."""
        self._is_told, self._has_moved = False, self._asks_safe_states
        self._stale.update(dict.fromkeys(areas, True))

    def follow(self, changed: Callable[[], object]) -> None:
        """Call ``changed()`` whenever anything in :meth:`states` has changed."""
        self._followers.append(changed)

    def ask(self, request: Request, now_ns: int) -> None:
        """Have it decided at the end of this instant whether a robot gets the places that it asks for on its way."""
        self._asking.append(request)
        self.serve(now_ns)

    def withdraw(self, request: Request) -> None:
        """Have a robot no longer wait for the places of ``request``."""
        request.withdraw()
        self.changed(*request.areas)
        for area in request.areas:
            self.freed(area)

    def look_at(self, traveller: Traveller, now_ns: Optional[int] = None) -> None:
        """Have :meth:`serve`, at ``now_ns`` [ns] or whenever it is called next, look for circles of a robot again."""
        self._to_look_at[traveller] = True
        if now_ns is not None:
            self.serve(now_ns)

    def serve(self, now_ns: int) -> None:
        """At the end of this instant, let in the robots for which there is a place, and report what has changed."""
        if not self._is_due and (self._is_undecided() or self._to_look_at or (self._followers and not self._is_told)):
            self._is_due = True
            self.simulation.queue.decide(now_ns, self._decide)

    def _decide(self, now_ns: int, _now_ns: int) -> None:
        """Do all that follows from the events of an instant, one thing after the other, in an order of their own.

        The first of the robots that may go on does so, until none may; then the first that asked at this instant and
        may not go on is held, and so on. An unexpected error breaks off the goal of one of those concerned, and the
        rest is decided anew.
        """
        try:
            while self._is_undecided() and (self.ways_out.acts(now_ns) or self._let_in(now_ns) or self._let_in_safely(
                    now_ns) or self._turn_away(now_ns)):
                pass
            if self._to_look_at:
                self._look_again(now_ns)
            self._is_due = False
        except Exception as error:
            self._is_due = False
            concerned = self._concerned()
            has_goal = concerned.navigator.is_active
            concerned.navigator.break_off(error)
            if has_goal:  # so this comes to an end if the error comes again and again
                self.serve(now_ns)
        if not self._is_told:
            self._is_told = True
            for changed in self._followers:
                changed()

    def _is_undecided(self) -> bool:
        return bool(self._asking or self._dirty or self._new or self._has_moved or self.ways_out.may_act)

    def _stands_still(self, now_ns: int, _now_ns: int) -> None:
        try:
            name_standstill(self, now_ns)
        except Exception as error:
            self._concerned().navigator.break_off(error)

    def _concerned(self) -> Traveller:
        """Return the first robot with a goal of those about which something is to be decided, or of all, or any."""
        requests = [*self._asking, *self._new, *(one for area in self._dirty for one in area.queue)]
        travellers = [*(one.traveller for one in requests), *self._to_look_at, *self._travellers]
        return next((one for one in travellers if one.navigator.is_active), travellers[-1])

    def _let_in(self, now_ns: int) -> bool:
        """Let in the first robot that may go on where anything has changed; return whether anything has followed."""
        if len(self._asking) == 1 and not self._dirty and not self._new and self._goes_on_alone(self._asking[0]):
            alone = self._asking.pop().traveller
            is_careful = alone.is_careful
            alone.serve(Traveller.go_on, now_ns)
            self._has_moved = self._has_moved and not is_careful  # after a careful one: nobody waits
            return True
        if not self._asking and not self._dirty:
            return False
        self.simulation.queue.when_quiet(self._stands_still)
        while self._asking:
            request = self._asking[0]
            if request.traveller.asked is request:
                request.line_up()
                self._new.append(request)
                self._has_moved = self._asks_safe_states
                self._ask_in(request.areas)
            del self._asking[0]
        self._dirty = [area for area in self._dirty if area.queue]
        requests = sorted(dict.fromkeys(one for area in self._dirty for one in area.may_be_next()))
        first = next((one for one in requests if one.is_first()), None)
        if first is not None:
            first.traveller.serve(Traveller.go_on, now_ns)
            return True
        self._dirty.clear()
        for one in requests:  # the area may have been opened, or they do not overtake one another any more
            one.traveller.serve(lambda one, at_ns: one.circles.look(at_ns), now_ns)
        return bool(self._dirty or self._asking)

    def _goes_on_alone(self, request: Request) -> bool:
        """Return whether ``request``, the only one of this instant, can be granted at once: the usual case."""
        one = request.traveller
        return request.goes_on_alone() and (not one.is_careful or (
            all(other.request is None for other in self._travellers)
            and self.ways_out.allows(one, request.areas) is None and is_plainly_safe(self._travellers, one)))

    def _turn_away(self, now_ns: int) -> bool:
        """Hold the first of the robots that have asked at this instant; return whether there was one."""
        self._new = sorted(one for one in self._new if one.traveller.asked is one) if self._new else []
        if not self._new:
            return False
        self._new[0].traveller.serve(Traveller.waits, now_ns)
        return True

    def _look_again(self, now_ns: int) -> None:
        travellers, self._to_look_at = self._to_look_at, {}
        for one in travellers:
            one.serve(lambda one, at_ns: one.circles.look(at_ns), now_ns)

    def _let_in_safely(self, now_ns: int) -> bool:
        """Let in the first robot, in the order of requests, for which that is safe; return whether there was one."""
        if not self._has_moved:
            return False
        self._has_moved = False
        request = first_to_go_on(self._travellers, self.ways_out)
        if request is None:
            return False
        request.traveller.serve(Traveller.go_on, now_ns)
        return True


def _keep_limit(one: Traveller, area: Area, paced: Paced) -> None:
    """Have ``one`` go on by the new limit of a zone that its present way has not left yet, and tell ``paced``."""
    leg = one.navigator.robot.leg
    if leg is None or one.navigator.takes_none is not None:
        return
    driven = leg.distance_at(paced.time_ns) + BORDER
    if any(stay.area is area and (stay.end is None or stay.end > driven) for stay in one.stays(leg)):
        one.tell(paced)
        one.navigator.travel.change_way(paced.time_ns)


def _check_law(navigator: Navigator) -> None:
    if not navigator.robot.keeps_piece_limits:
        raise ConfigurationError("robot '{}': its law of motion, a calibration's or the original's, allows no speed "
                                 'limits of zones; leave max_speed out'.format(navigator.robot.name))
