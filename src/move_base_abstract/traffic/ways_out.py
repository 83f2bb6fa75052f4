"""Ways out of jams (deadlock: avoid): who drives where, in which order, so that all robots come to their goals.

While all robots can come to the ends of their ways one after the other, each staying where its way ends, places are
given so that this stays true (:mod:`.safe_states`). Where it is not true, because robots started so or got such goals,
an exact search over their joint places (:mod:`.joint_search`) looks for moves that bring all of them to their goals. If
there are any, the robots drive by these moves (:mod:`.moves`). Other robots keep out of the areas of the moves
until all are made. If there are none, a warning says so once. Then moves are looked for that bring some of them there,
one robot added after the other; the others make way. Those for which there would be no way even if the robots that do
not take part were away are held where they are.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from ..goals.events import Warned
from .joint_search import MOST_STATES, Net, TooManyStates, find_most, find_moves
from .lane_places import LanePlaces
from .moves import Moves
from .rules import DeadlockPolicy
from .safe_states import cannot_stay

if TYPE_CHECKING:
    from .area import Area
    from .control import Traffic
    from .joint_search import Joint, Move
    from .lane_places import WayOver
    from .traveller import Traveller


#: the largest number of robots whose joint places are searched; if no others are under way, it is MOST_ALONE
MOST_ROBOTS = 5
MOST_ALONE = 8


#: what holds if a bound is hit
_WITHOUT = ('get places as if each robot left its goal when it has reached it, so they may block one another for good. '
            'This is said once.')


class _Start(NamedTuple):
    """Where a robot is as the search begins: at the node ``place``, or on an edge; ``goal``: the node of its target."""

    traveller: Traveller
    place: Any
    edge: Optional[int]
    goal: str


class WaysOut:
    """Looks for ways out of the jams of one ``traffic`` (Traffic), and has robots drive by them."""

    def __init__(self, traffic: Traffic) -> None:
        self._traffic = traffic
        self._is_active = traffic.rules.policy is DeadlockPolicy.AVOID
        #: whether all robots can come to their ends and stay there
        self.is_safe: bool = False
        self._moves: Optional[Moves] = None
        self._to_start: List[Traveller] = []  # robots that have yet to begin with their moves, or to go on without
        self._turning: Dict[Traveller, bool] = {}  # robots that begin with their moves at the next border
        self._is_due = False  # whether anything has changed on which the safety depends
        self._goals: Dict[Traveller, Tuple[int, int]] = {}  # (the number of its goal, since when it has it [ns])
        self._places: Dict[str, LanePlaces] = {}  # by the file
        self._searched: Any = None  # the state in which the last search began
        self._in_vain: List[Any] = []  # states of searches whose moves nobody could go on with, since others were made
        self._held_back: Dict[Traveller, bool] = {}  # robots for which there is no way
        self._told: Dict[Any, bool] = {}

    @property
    def may_act(self) -> bool:
        """Whether :meth:`acts` may have anything to do at this instant."""
        return self._is_active and (self._is_due or self._moves is not None or not self.is_safe)

    def acts(self, now_ns: int) -> bool:
        """Look for moves if that is due; have robots begin with them, or go on without; return whether any did.

        Call it at the end of an instant, when the goals of all robots are known.
        """
        if not self.may_act:
            return False
        if self._moves is not None:
            under_way = [one for one in self._moves.nodes if self._left(one, now_ns)]
            if not under_way:
                self._end_moves()
            elif self._are_blocked(self._moves, under_way):
                self._end_moves(in_vain=True)
        if self._moves is None and (self._is_due or (not self.is_safe and all(
                one.navigator.robot.leg is None for one in self._traffic.travellers()))):
            self._look(now_ns)
        to_start, self._to_start = self._to_start, []
        for one in to_start:
            if one.navigator.robot.leg is not None and not self._may_halt(one, now_ns):
                self._turning[one] = True
            else:
                one.serve(lambda one, at_ns: one.goes_out(at_ns), now_ns)
        return bool(to_start)

    def _are_blocked(self, moves: Moves, under_way: Sequence[Traveller]) -> bool:
        """Return whether nobody drives, and none of the robots ``under_way`` can begin with another one of the moves.

        This comes about where a robot waits at the border of a zone on its lane: the moves know no such place.
        """
        return all(one.navigator.robot.leg is None and one.asked is None for one in self._traffic.travellers()) and all(
            one.request is not None and not (one.request.is_first() and moves.allows(one, one.request.areas))
            for one in under_way)

    def _may_halt(self, traveller: Traveller, now_ns: int) -> bool:
        """Return whether a driving robot may stop here: not at a node to whose place it has no right any more."""
        pose, places = traveller.navigator.robot.pose_at(now_ns), self._places_of(traveller)
        return places.node_at(pose.x, pose.y) is None or self.is_at_node(traveller, now_ns)

    def turns(self, traveller: Traveller) -> bool:
        """Return whether a robot that comes to a border has to stop there and go on by its moves; ask once."""
        return bool(self._turning) and self._turning.pop(traveller, False)

    def departs(self, traveller: Traveller, now_ns: int) -> None:
        """Note that a robot starts on its way."""
        number = traveller.navigator.goal_number
        if not self._is_active:
            return
        if self._goals.get(traveller, (None, 0))[0] != number:
            self._goals[traveller] = number, now_ns
        self._is_due = True
        self._traffic.serve(now_ns)

    def needs_more(self) -> None:
        """Note that a robot needs places on its way, or keeps them at its end, of which that was not known."""
        self._is_due = self._is_active

    def solves(self, traveller: Traveller) -> bool:
        """Return whether moves lead a robot, so that it waits in no circle."""
        return self._moves is not None and traveller in self._moves.nodes

    def others(self, traveller: Traveller) -> Tuple[Traveller, ...]:
        """Return the other robots that drive by the moves, or for which there is no way."""
        return tuple(one for one in (self._held_back if self._moves is None else self._moves.nodes)
                     if one is not traveller)

    def allows(self, traveller: Traveller, areas: Sequence[Area]) -> Optional[bool]:
        """Return whether a robot may have places in ``areas`` by the moves; None: they say nothing.

        A robot for which there is no way may have none.
        """
        moves = self._moves
        if moves is None:
            return False if traveller in self._held_back else None
        if traveller in moves.nodes:
            return bool(self._left(traveller, self._traffic.simulation.now_ns)) and moves.allows(traveller, areas)
        return False if moves.uses(areas) else None

    def entered(self, traveller: Traveller, areas: Sequence[Area]) -> None:
        """Note that a robot has got a place in ``areas``."""
        if self._moves is not None and traveller in self._moves.nodes:
            self._moves.entered(traveller, areas)

    def leaves(self, traveller: Traveller, areas: Sequence[Area]) -> Tuple[Area, ...]:
        """Return those of ``areas``, which end where a robot has to wait, that it gives back: lanes, at their ends."""
        is_led = self._moves is not None and traveller in self._moves.nodes
        return tuple(area for area in areas if area.outline is None and area.point is None) if is_led else ()

    def way_on(self, traveller: Traveller, now_ns: int) -> Optional[Tuple[WayOver, bool]]:
        """Return (the way of the moves that a robot has yet to make, whether it ends at its goal), or None."""
        moves = self._moves
        left = [] if moves is None or traveller not in moves.nodes else self._left(traveller, now_ns)
        if moves is None or not left:
            return None
        pose = traveller.navigator.robot.pose_at(now_ns)
        places = self._places_of(traveller)
        edge = None if self.is_at_node(traveller, now_ns) else places.edge_at(pose.x, pose.y, traveller.held)
        turns = places.before_turn((pose.x, pose.y), edge, left)
        is_whole = len(turns) == len(left)
        return places.way((pose.x, pose.y), edge, turns), is_whole and moves.ends_at_goal(traveller)

    def given_up(self, traveller: Traveller, now_ns: int) -> None:
        """Note that a robot has no goal any more: without it, the moves cannot all be made."""
        if not self._is_active:
            return
        self._is_due = True
        if self._moves is not None and traveller in self._moves.nodes and self._left(traveller, now_ns):
            self._end_moves()

    def placed(self, traveller: Traveller) -> None:
        """Note that a robot is elsewhere, and has not driven there: without it, the moves cannot all be made."""
        self._is_due = self._is_active
        if self._moves is not None and traveller in self._moves.nodes:
            self._end_moves()

    def left(self, traveller: Traveller) -> None:
        """Note that a robot has been removed."""
        for known in (self._goals, self._turning):
            known.pop(traveller, None)
        self.placed(traveller)
        if traveller in self._to_start:
            self._to_start.remove(traveller)

    def _end_moves(self, in_vain: bool = False) -> None:
        """End the moves; search anew.

        If they were ``in_vain``, no robot has come to its goal by them. Then none are looked for again where these, and
        others in vain since the last that were made, began: so this comes to an end.
        """
        assert self._moves is not None
        self._in_vain = [*self._in_vain, self._searched] if in_vain else []
        self._searched = None
        self._to_start = sorted(self._moves.nodes, key=lambda one: one.rank)
        self._moves, self._is_due = None, True
        self._turning.clear()

    def _left(self, traveller: Traveller, now_ns: int) -> List[str]:
        """Return the nodes to which a robot still has to drive, of those to which its moves lead."""
        assert self._moves is not None
        pose, places = traveller.navigator.robot.pose_at(now_ns), self._places_of(traveller)
        node = places.node_at(pose.x, pose.y) if self.is_at_node(traveller, now_ns) else None
        edge = None if node else places.edge_at(pose.x, pose.y, traveller.held)
        return self._moves.left(traveller, node, () if edge is None else places.all_ends_of(edge))

    def _places_of(self, traveller: Traveller) -> LanePlaces:
        lanes: Any = traveller.lanes
        if lanes.source not in self._places:
            self._places[lanes.source] = LanePlaces(lanes, self._traffic.zones, self._traffic.nodes(lanes.source),
                                                    lambda edge: self._traffic.lane(lanes.source, edge))
        return self._places[lanes.source]

    def _look(self, now_ns: int) -> None:
        """Look whether all robots can come to their ends; if not, look for moves."""
        self._is_due = False
        stuck = cannot_stay(self._traffic.travellers())
        self.is_safe = not stuck
        if stuck:
            self._search(stuck, now_ns)
        else:
            self._hold_back(())

    def _search(self, stuck: Sequence[Traveller], now_ns: int) -> None:
        starts = self._starts(stuck, now_ns)
        same = self._places_of(starts[0].traveller).same if starts else ()
        if same:
            self._tell('same', [start.traveller for start in starts], now_ns, (
                'No way out of a jam is searched, because the nodes {} and {} are at one point. {} {}').format(
                    *same, _names(start.traveller for start in starts), _WITHOUT))
        if same or not starts:
            self._hold_back(())
            return
        net = self._net(starts)
        state = [(start.traveller.name, start.goal, tuple(start.traveller.held)) for start in starts], net.room
        if state == self._searched:
            return
        self._searched = state
        begin = tuple(start.place for start in starts)
        moves, without = ([], []) if state in self._in_vain else self._found(starts, net, begin, now_ns)
        self._hold_back(without)
        if not moves:
            return
        to_start = dict.fromkeys(self._to_start, True)
        self._moves = Moves([(start.traveller, start.goal) for start in starts], net, begin, moves)
        self._to_start = sorted({**to_start, **dict.fromkeys(self._moves.nodes, True)}, key=lambda one: one.rank)

    def _found(self, starts: Sequence[_Start], net: Net, begin: Joint,
               now_ns: int) -> Tuple[List[Move], List[Traveller]]:
        """Return (the moves, the robots for which there is no way)."""
        wanted, goals = self._wanted(starts, net), [start.goal for start in starts]
        without: List[Traveller] = []
        most = whole = MOST_STATES if len(starts) <= MOST_ROBOTS else MOST_STATES // MOST_ROBOTS
        try:
            moves = find_moves(net, begin, wanted, most, goals)
            if moves is not None:
                return moves, without
            most //= MOST_ROBOTS  # for each of the searches that follow
            moves, met = find_most(net, begin, wanted, most, goals)
            alone = net._replace(room={area: area.capacity or 0 for area in net.room})
            without = [start.traveller for number, start in enumerate(starts) if met[number] is None and find_moves(
                alone, begin, [*met[:number], start.goal, *met[number + 1:]], most, goals) is None]
        except TooManyStates:
            moves = []
            self._tell('states', [start.traveller for start in starts], now_ns, (
                'The search for a way out of a jam gave up after {:,} joint places. {} {}').format(
                    most, _names(start.traveller for start in starts), _WITHOUT))
        if most < whole and None not in wanted:
            self._tell_no_way(starts, without, now_ns)
        return moves, without

    def _hold_back(self, travellers: Iterable[Traveller]) -> None:
        held_back = dict.fromkeys(travellers, True)
        if held_back != self._held_back:
            self._held_back = held_back
            self._traffic.changed()
            for one in held_back:
                self._traffic.look_at(one)

    def _starts(self, stuck: Sequence[Traveller], now_ns: int) -> List[_Start]:
        """Return the robots that take part, in the order in which they got their goals."""
        driving = [one for one in self._traffic.travellers() if one.lanes is not None and one in self._goals
                   and one.navigator.travel.target is not None]
        concerned = [one for one in driving if one in stuck] or driving
        if len(driving) <= MOST_ALONE:
            concerned = driving
        elif len(concerned) > MOST_ROBOTS:
            self._tell('robots', concerned, now_ns, (
                'No way out of a jam is searched for more than {} robots at a time. {} {}').format(
                    MOST_ROBOTS, _names(concerned), _WITHOUT))
            return []
        concerned = [one for one in concerned if one.lanes.source == concerned[0].lanes.source]  # type: ignore[union-attr]
        found = [start for start in (self._start(one, now_ns) for one in concerned) if start is not None]
        return sorted(found, key=lambda start: (-start.traveller.priority, self._goals[start.traveller][1],
                                                start.traveller.rank))

    def _start(self, traveller: Traveller, now_ns: int) -> Optional[_Start]:
        """Return where a robot is, or None if that, or its goal, is not on the net."""
        target: Any = traveller.navigator.travel.target
        pose, places = traveller.navigator.robot.pose_at(now_ns), self._places_of(traveller)
        goal, node = places.node_at(target.x, target.y), places.node_at(pose.x, pose.y)
        if goal is None:
            return None
        if node is not None and self.is_at_node(traveller, now_ns):
            return _Start(traveller, node, None, goal)
        edge = places.edge_at(pose.x, pose.y, traveller.held)
        return None if edge is None else _Start(traveller, ('on its way', traveller.name), edge, goal)

    def is_at_node(self, traveller: Traveller, now_ns: int) -> bool:
        """Return whether a robot is at a node, and holds its places there: it may have set out to the next one."""
        pose, places = traveller.navigator.robot.pose_at(now_ns), self._places_of(traveller)
        node = places.node_at(pose.x, pose.y)
        return node is not None and all(area in traveller.held for area in places.areas[node])

    def _net(self, starts: Sequence[_Start]) -> Net:
        """Return the net on which ``starts`` move among the other robots, which stay in their areas."""
        places = self._places_of(starts[0].traveller)
        areas: Dict[Any, Tuple[Area, ...]] = dict(places.areas)
        steps: Dict[Any, Dict[str, Tuple[Area, ...]]] = dict(places.steps)
        for start in starts:
            if start.edge is not None:
                areas[start.place] = tuple(area for area in start.traveller.held if area.capacity is not None)
                steps[start.place] = dict.fromkeys(places.ends_of(start.edge, start.traveller.held),
                                                   places.on_edges[start.edge])
        taking_part = [start.traveller for start in starts]
        room = {area: 0 if area.is_closed else area.capacity - sum(one not in taking_part for one in area.holders)
                for area in self._traffic.areas() if area.capacity is not None}
        return Net(areas, steps, room)

    def _wanted(self, starts: Sequence[_Start], net: Net) -> List[Optional[str]]:
        """Return where each robot has to stand at the end; None: its goal is taken by a robot that comes first."""
        room = dict(net.room)
        wanted: List[Optional[str]] = []
        for start in starts:
            areas = net.areas[start.goal]
            is_free = all(room[area] > 0 for area in areas)
            for area in areas if is_free else ():
                room[area] = room[area] - 1
            wanted.append(start.goal if is_free else None)
        return wanted

    def _tell_no_way(self, starts: Sequence[_Start], without: Sequence[Traveller], now_ns: int) -> None:
        pairs = tuple(sorted((start.traveller.name, start.goal) for start in starts))
        self._tell(pairs, [start.traveller for start in starts], now_ns, (
            'There is no order of moves in which these robots all come to their goals: {}. Each place has room for so '
            'few that they cannot pass one another, unless a robot leaves its goal.{}').format(
                ', '.join('{} to {}'.format(*one) for one in pairs),
                ' Held until that changes: {}.'.format(_names(without)) if without else ''))

    def _tell(self, key: Any, travellers: Iterable[Traveller], now_ns: int, text: str) -> None:
        """Warn once for each ``key``, on behalf of the first robot by name."""
        if key not in self._told:
            self._told[key] = True
            first = min(travellers, key=lambda one: one.rank)
            first.tell(Warned(now_ns, first.name, text))


def _names(travellers: Iterable[Traveller]) -> str:
    names = [one.name for one in sorted(travellers, key=lambda one: one.rank)]
    return ', '.join(names[:10]) + (' and {} more'.format(len(names) - 10) if len(names) > 10 else '')
