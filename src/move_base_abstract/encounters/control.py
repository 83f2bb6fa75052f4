"""Encounters: robots of one process that come near each other on their ways, and the consequences.

The first instant at which two robots come within the law's radius is an event. At that instant the law determines which
robot has to stand, and for how long. The draws depend only on the seed, the names of both robots and the numbers of
their goals; they do not depend on the order in which the robots came, or on when they were looked at. Robots meet after
all else of an instant, and all pairs of one instant are judged by their ways before any robot stands. A robot that has
to stand is held, as for any other wait on its way; then it goes on. Two robots meet once for each pair of their goals,
so no robot stands for the same robot again and again.
"""
from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from ..common.errors import ConfigurationError
from ..common.units import NS_PER_S, seconds_to_ns
from ..engine.chance import Chance, Purpose
from ..engine.event_queue import USERS
from ..goals.events import Encounter, GoalChanged, Meets
from ..goals.outcome import NO_CONTROL
from ..motion.encounter_law import CROSSING, HEAD_ON, NO_COST, OVERTAKING, STANDING, EncounterLaw
from .nearness import closest, distance, first_beyond, first_within, gap, windows
from .neighbours import Neighbours
from .track import Track

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..motion.encounter_law import Cost
    from ..motion.stuck_law import StuckLaw
    from .nearness import Window

_NEARER = 0.01  # m; two robots that are near already meet only if they come nearer by this
_LEAST_WAY = 1e-3  # m; a robot that drives less than this until they are closest counts as standing
_ALONG = math.cos(math.radians(45.0))  # cosine of the largest angle between ways in the same direction
_GOALS = 1 << 20  # the number of draws that are reserved for one pair of goals


class Stay(NamedTuple):
    """The smallest distance of two robots [m], when that is [ns], and when they are apart again [ns], None: never."""

    nearest: float
    nearest_ns: int
    beyond_ns: Optional[int]


class Encounters:
    """The robots of one process that may meet; ``seed``: that of the draws. Not thread-safe, just as the simulation."""

    def __init__(self, simulation: Simulation, law: EncounterLaw, seed: int) -> None:
        self.simulation = simulation
        self.law = law
        #: the same for robots that get stuck by a law of their own: long blocks are robots that touch
        self._law_unless_stuck = replace(law, long_chance=0.0)
        self.neighbours = Neighbours(law.radius)
        self._seed = seed
        self._robots: Dict[int, Participant] = {}
        self._met: Dict[Tuple[int, int], Tuple[int, int]] = {}  # {pair: the numbers of the goals with which they met}
        self._meet_now: Dict[Tuple[int, int], bool] = {}  # the pairs that meet at this instant

    def join(self, navigator: Navigator, law: Optional[EncounterLaw], stream: Stream,
             failing: Any = None) -> Participant:
        """Add a robot; return its :class:`Participant`. ``law``: the law of encounters of the robot's calibration.

        ``failing`` (Failing): by this it gets stuck beside other robots; None, or without a law for that: it does not.

        :raises ConfigurationError: if that law differs from that of the other robots.
        """
        if law != self.law:
            raise ConfigurationError("robot '{}': encounters: its calibration has a different law for them, or none; "
                                     'all robots need the same law'.format(navigator.robot.name))
        participant = Participant(self, navigator, stream, failing)
        self._robots[navigator.robot.index] = participant
        stream.tell(Meets(self.simulation.now_ns, participant.name, self.law.radius))
        participant.moved(self.simulation.now_ns)
        return participant

    def leave(self, index: int) -> None:
        """Note that the robot is removed from the world."""
        self.neighbours.drop(index)
        self._forget(index)
        del self._robots[index]
        self._met = {pair: goals for pair, goals in self._met.items() if index not in pair}

    def moved(self, index: int, now_ns: int) -> None:
        """Note that a robot has another track from ``now_ns`` [ns] on; find the robots that it will meet."""
        participant = self._robots[index]
        self._forget(index)
        self.neighbours.put(index, participant.track)
        for other, times in self.neighbours.near(index, now_ns):
            pair = (index, other) if index < other else (other, index)
            one, two = (self._robots[number] for number in pair)
            if self._met.get(pair) == (one.goal_number, two.goal_number):
                continue
            due_ns = next_meeting(one.track, two.track, self.law.radius, times, now_ns)
            if due_ns is not None:
                event = self.simulation.queue.schedule(
                    due_ns, USERS - 1, lambda at_ns, _now_ns, pair=pair: self._meet(pair, at_ns))  # type: ignore[misc]
                one.ahead[two.index] = two.ahead[one.index] = event

    def _forget(self, index: int) -> None:
        own = self._robots[index]
        for other, event in own.ahead.items():
            event.cancel()
            del self._robots[other].ahead[index]
            self._meet_now.pop((min(index, other), max(index, other)), None)
        own.ahead.clear()

    def _meet(self, pair: Tuple[int, int], now_ns: int) -> None:
        if not self._meet_now:
            self.simulation.queue.decide(now_ns, self._all_meet)
        self._meet_now[pair] = True

    def _all_meet(self, now_ns: int, _now_ns: int) -> None:
        """Have all pairs meet that meet at this instant: each is judged before a robot of another one stands."""
        pairs: List[Tuple[Participant, Participant]] = []
        for index, other_index in self._meet_now:
            one, other = self._robots[index], self._robots[other_index]
            del one.ahead[other_index], other.ahead[index]
            self._met[index, other_index] = one.goal_number, other.goal_number
            pairs.append((one, other) if one.name < other.name else (other, one))
        self._meet_now.clear()
        pairs.sort(key=lambda pair: (pair[0].name, pair[1].name))
        costs = [first.guarded(self._cost, first, second, now_ns) or NO_COST for first, second in pairs]
        for (first, second), cost in zip(pairs, costs):
            for own, their, seconds in ((first, second, cost.seconds[0]), (second, first, cost.seconds[1])):
                if seconds > 0.0:
                    own.guarded(own.stand, their, seconds, cost.aborts, now_ns)
            for own, keeps_goal in zip((first, second), cost.keeps):
                own.guarded(own.failing.get_stuck, now_ns, keeps_goal)

    def _cost(self, first: Participant, second: Participant, now_ns: int) -> Cost:
        """Return what it costs two robots that they meet now, and report it."""
        stay = find_stay(first.track, second.track, self.law.radius, now_ns)
        kind, yields = kind_of(first.track, second.track, now_ns, stay.nearest_ns)
        chance = self.law.chance(kind, stay.nearest, first.width(second, stay.nearest_ns))
        draws = Chance(self._seed, '{} {}'.format(first.name, second.name))
        place = second.goal_number * _GOALS

        def uniform(purpose: Purpose, number: int) -> float:
            return draws.uniform(first.goal_number, purpose, place + number)
        law, keeps = self.law, None
        if first.stuck_law is not None and first.stuck_law == second.stuck_law:
            law, keeps = self._law_unless_stuck, first.stuck_law.draw(stay.nearest, uniform)
        cost = law.draw(chance, yields, uniform, stay.nearest) if keeps is None else NO_COST._replace(keeps=keeps)
        for own, their, seconds in ((first, second, cost.seconds[0]), (second, first, cost.seconds[1])):
            own.note(their, kind, stay.nearest, seconds, now_ns)
        return cost


def make_encounters(simulation: Simulation, scenario: Any) -> Optional[Encounters]:
    """Return the :class:`Encounters` of a Scenario, None if it has no law of encounters."""
    return None if scenario.encounters is None else Encounters(simulation, scenario.encounters, scenario.seed)


class Participant:
    """One robot that may meet others.

    ``track`` (Track): where it is and will be; ``ahead``: {index of another robot: the event of their meeting};
    ``failing`` (Failing): by this it gets stuck, or None.
    """

    def __init__(self, encounters: Encounters, navigator: Navigator, stream: Stream, failing: Any) -> None:
        self.index: int = navigator.robot.index
        self.name: str = navigator.robot.name
        self.ahead: Dict[int, Any] = {}
        self.track: Any = None
        self.failing = failing
        self._encounters = encounters
        self._navigator = navigator
        self._stream = stream
        self._stands: Dict[str, Any] = {}  # {reason for which it is held: the event that ends it}
        self._held_goal = 0  # the number of the goal on whose way it stands
        navigator.robot.follow(self.moved)
        stream.subscribe('encounters', {GoalChanged: lambda event: self._goal_changed(event.time_ns)})

    @property
    def goal_number(self) -> int:
        """The number of goals on which the robot has begun to work."""
        return self._navigator.goal_number

    @property
    def stuck_law(self) -> Optional[StuckLaw]:
        """The law by which the robot gets stuck beside others; None: it does not."""
        law: Optional[StuckLaw] = None if self.failing is None else self.failing.law
        return law

    def moved(self, now_ns: int) -> None:
        """Note that the robot has departed, or stands."""
        robot, known = self._navigator.robot, self.track
        if self.index not in self._encounters._robots:
            return
        pose = robot.pose_at(now_ns)
        if robot.leg is None and known is not None and now_ns >= known.end_ns and (
                (known.pose.x, known.pose.y) == (pose.x, pose.y)):
            return  # it stands where its track ends
        self.track = Track(robot.leg, pose, now_ns, self._encounters.neighbours.side)
        self._encounters.moved(self.index, now_ns)

    def width(self, other: Participant, now_ns: int) -> Optional[float]:
        """Return the width [m] of the free space around the middle between both at ``now_ns`` [ns], None: no map."""
        occupancy = getattr(self._navigator.planner, 'occupancy', None)
        limit = self._encounters.law.narrow_below
        if occupancy is None or not limit > 0.0:
            return None
        (x, y), (to_x, to_y) = self.track.place_at(now_ns), other.track.place_at(now_ns)
        from ..maps.clearance import clearance_at  # imported here, since only robots with a map need numpy
        return 2.0 * clearance_at(occupancy, 0.5 * (x + to_x), 0.5 * (y + to_y), 0.5 * limit)

    def note(self, other: Participant, kind: str, nearest: float, seconds: float, now_ns: int) -> None:
        """Report the encounter with ``other``: its kind, the smallest distance [m], the time that it stands [s]."""
        self._stream.tell(Encounter(now_ns, self.name, other.name, kind, nearest, seconds))

    def stand(self, other: Participant, seconds: float, aborts: bool, now_ns: int) -> None:
        """Let the robot stand for ``seconds`` [s] because of ``other``; then it gives up if ``aborts``, or goes on."""
        reason = 'encounter with {}'.format(other.name)
        self._held_goal = self.goal_number
        step = self._give_up if aborts else self._go_on
        self._stands[reason] = self._encounters.simulation.queue.schedule(
            now_ns + max(1, seconds_to_ns(seconds)), self.index, lambda due_ns, _now_ns: step(reason, due_ns))
        self._navigator.travel.hold(reason, now_ns)

    def guarded(self, step: Callable[..., Any], *arguments: Any) -> Any:
        """Return ``step(*arguments)``; an error breaks off this robot's goal only, and the result is None."""
        try:
            return step(*arguments)
        except Exception as error:
            self._navigator.break_off(error)
            return None

    def _go_on(self, reason: str, now_ns: int) -> None:
        del self._stands[reason]
        self._navigator.travel.release(reason, now_ns)

    def _give_up(self, _reason: str, now_ns: int) -> None:
        self._navigator.shut_down(NO_CONTROL, now_ns)  # this also ends all its stands, see _goal_changed

    def _goal_changed(self, now_ns: int) -> None:
        """End all stands if the goal on whose way the robot stood has ended or has been replaced."""
        if self._stands and (not self._navigator.is_active or self._held_goal != self.goal_number):
            for reason in self._forget_stands():
                self._navigator.travel.release(reason, now_ns)

    def _forget_stands(self) -> List[str]:
        reasons = list(self._stands)
        for event in self._stands.values():
            event.cancel()
        self._stands.clear()
        return reasons

    def reset(self, _now_ns: int) -> None:
        """Forget all stands: the robot is placed at its start next, and its navigator no longer holds it."""
        self._forget_stands()

    def restart(self, by_ns: int) -> None:
        """Do nothing: the clock has restarted, all events have been shifted, and the robot's new stand comes next."""

    def close(self) -> None:
        """Note that the robot is removed."""
        self._forget_stands()
        self._encounters.leave(self.index)


def next_meeting(one: Track, other: Track, radius: float, times: List[Window], now_ns: int) -> Optional[int]:
    """Return the instant [ns] at which two robots meet next, in one of the windows ``times``, or None.

    That is the first instant from ``now_ns`` [ns] on at which they are within ``radius`` [m]. If they are near already,
    they meet at once if they will come nearer, otherwise when they are near again after having been apart.
    """
    if not times:
        return None
    if times[0].begin_ns <= now_ns:
        now = distance(one, other, now_ns)
        if now <= radius:
            stay = find_stay(one, other, radius, now_ns)
            if stay.nearest < now - _NEARER:
                return now_ns
            if stay.beyond_ns is None:
                return None
            now_ns = stay.beyond_ns
    for window in times:
        if window.end_ns > now_ns:
            found = first_within(one, other, radius, window._replace(begin_ns=max(now_ns, window.begin_ns)))
            if found is not None:
                return found
    return None


def find_stay(one: Track, other: Track, radius: float, now_ns: int) -> Stay:
    """Return the :class:`Stay` of two robots that are within ``radius`` [m] at ``now_ns`` [ns]."""
    best = distance(one, other, now_ns), now_ns
    for window in windows(one, other, now_ns, max(now_ns, one.end_ns, other.end_ns)):
        beyond_ns = first_beyond(one, other, radius, window)
        inside = window if beyond_ns is None else window._replace(end_ns=beyond_ns)
        best = min(best, closest(one, other, inside))
        if beyond_ns is not None:
            return Stay(*best, beyond_ns)
    return Stay(*best, None)


def kind_of(first: Track, second: Track, now_ns: int, nearest_ns: int) -> Tuple[str, Tuple[int, ...]]:
    """Return (kind of an encounter at ``now_ns`` [ns], numbers of the robots that may have to stand).

    The numbers are 0 for ``first`` and 1 for ``second``; the robots are closest at ``nearest_ns`` [ns]. If both go in
    the same direction, only the one behind may have to stand. If one stands already, only the other one may have to.
    """
    until_ns = max(nearest_ns, now_ns + NS_PER_S // 1000)
    ways = [_way(track, now_ns, until_ns) for track in (first, second)]
    lengths = [math.hypot(*way) for way in ways]
    moves = tuple(number for number, length in enumerate(lengths) if length > _LEAST_WAY)
    if len(moves) < 2:
        return STANDING, tuple(number for number in moves or (0, 1) if (first, second)[number].leg is not None)
    cosine = (ways[0][0] * ways[1][0] + ways[0][1] * ways[1][1]) / (lengths[0] * lengths[1])
    if cosine < -_ALONG:
        return HEAD_ON, moves
    if cosine <= _ALONG:
        return CROSSING, moves
    x, y = gap(first, second, now_ns)
    return OVERTAKING, (0,) if x * (ways[0][0] + ways[1][0]) + y * (ways[0][1] + ways[1][1]) > 0.0 else (1,)


def _way(track: Track, begin_ns: int, end_ns: int) -> Tuple[float, float]:
    (x, y), (to_x, to_y) = track.place_at(begin_ns), track.place_at(end_ns)
    return to_x - x, to_y - y
