"""A fleet in plain Python, without ROS: send goals, call :meth:`Fleet.run`, read the trace.

    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 2.0}]}))
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run()
    fleet.trace[-1]        # TraceEntry(time_ns=6000000000, robot='bot', kind='ended', ...)

The robots are those of the nodes, with the same settings, and time is kept in the same integer nanoseconds. Tests
compare the ROS fleet with this one.
"""
from __future__ import annotations

import collections.abc
import itertools
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Optional

from ..common.arguments import as_float, as_instant, check_function, check_kind, check_method, check_path
from ..common.errors import ConfigurationError, TimeError
from ..common.kinds import error
from ..common.old_names import warn_of_old
from ..common.units import NS_PER_S, seconds_to_ns
from ..driving.contacts import Contacts
from ..encounters.control import make_encounters
from ..engine.simulation import Simulation
from ..goals.events import robot_stream
from ..runs.event_log_file import End, write_event_log
from ..runs.trace import TraceEntry
from ..scenario import Scenario, make_robot
from ..sensing.surroundings import Surroundings
from ..tasks.room import Rooms
from ..traffic.control import Traffic
from .member import FleetWarning, Member
from .robot_rows import TraceRows
from .user_calls import UserCalls

if TYPE_CHECKING:
    from ..common.type_names import StrPath
    from ..engine.stream import Stream
    from ..maps.occupancy import OccupancyMap
    from ..maps.planning import StraightLinePlanner
    from ..scenario import RobotSpec
    from ..traffic.area import AreaState
    from .user_calls import OnEnd

__all__ = ['Fleet', 'FleetWarning', 'TraceEntry']

#: {a method of a Fleet until the next release, with a robot's name as its first argument: the name in Member}
_OF_ROBOTS = {'work': 'send_task', 'cancel_work': 'cancel_task', **{name: name for name in (
    'send', 'cancel', 'place', 'hold', 'release', 'fail', 'repair', 'set_charge', 'set_tool', 'set_priority', 'scan',
    'condition', 'pose', 'distance')}}

#: what a scenario may be, in words
SCENARIO = 'a Scenario, as read_scenario(path) or make_scenario(dictionary) returns it'
_MAP = 'an OccupancyMap, as load_map(read_description(path)) of maps.map_files returns it'


class Fleet:
    """Robots on one event queue. At equal times: lower robot index first, then first scheduled, then users' calls.

    ``on_end(robot, goal_id, state, text, now_ns)``, if given, is called when a goal ends, and may send the next one.
    ``on_worked`` is called in the same way when a task at a place ends (:meth:`.Member.send_task`). ``on_event(entry)``
    is called with each :class:`TraceEntry`, at the end of its instant and in the order of the trace. With
    ``trace=None`` nothing is recorded; otherwise :attr:`trace` is a list that begins with the entries of ``trace``.
    ``occupancy`` (OccupancyMap in the global frame) is the map of the robots with ``use_map``. ``planner`` replaces the
    planner that the settings ask for. :attr:`warnings` has the warnings that a node would log, for example why a goal
    has no plan: [:class:`FleetWarning`, ...]; it is empty if there is no trace.
    """

    _member_type = Member

    def __init__(self, scenario: Scenario = Scenario(()), start_ns: int = NS_PER_S, on_end: Optional[OnEnd] = None,
                 planner: Optional[StraightLinePlanner] = None, trace: Optional[Iterable[TraceEntry]] = (),
                 occupancy: Optional[OccupancyMap] = None, on_worked: Optional[OnEnd] = None,
                 on_event: Optional[Callable[[TraceEntry], object]] = None) -> None:
        check_kind(scenario, Scenario, 'scenario', SCENARIO)
        if planner is not None:
            check_method(planner, 'corners', 'planner', 'a planner, an object with corners(start, goal)')
        if occupancy is not None:
            _check_map(occupancy)
        self.simulation = Simulation(as_instant(start_ns, 'start_ns'))
        self._start_ns = self.simulation.now_ns
        self._trace = None if trace is None else _entries(trace)
        self._rows = None if trace is None else TraceRows()  # the rows of the trace that are not in self._trace yet
        self._user_calls = UserCalls(self.simulation, on_event, on_end, on_worked)
        self._streams = [self._stream(with_motion) for with_motion in (False, True)]  # robots have copies
        self.scenario = scenario
        self._rooms = None if scenario.places is None else Rooms(self.simulation, scenario.places)
        self._planner = planner
        self._occupancy = occupancy
        self.traffic = Traffic(self.simulation, scenario.zones, scenario.traffic)
        self.surroundings = Surroundings()
        self.contacts = Contacts(self.simulation)
        self.encounters = make_encounters(self.simulation, scenario)
        self._members: Dict[str, Member] = {}  # {name: Member}, in the order of their indices
        self.warnings: List[FleetWarning] = []
        self._indices = itertools.count()
        for spec in scenario.robots:
            self._add(spec)

    @property
    def trace(self) -> Optional[List[TraceEntry]]:
        """All that has happened, a list of :class:`TraceEntry`, or None; each access adds the new entries to it."""
        if self._trace is not None and self._rows is not None:
            self._trace += self._rows.read()
        return self._trace

    @property
    def now_ns(self) -> int:
        """The present simulated time [ns]."""
        return self.simulation.now_ns

    @property
    def now(self) -> float:
        """The present simulated time [s]."""
        return self.simulation.now_ns / NS_PER_S

    @property
    def names(self) -> List[str]:
        """The robots' names, in the order of their indices."""
        return list(self._members)

    @property
    def robots(self) -> List[Member]:
        """The robots, in the order of their indices: [:class:`.Member`, ...]."""
        return list(self._members.values())

    def robot(self, name: str) -> Member:
        """Return the :class:`.Member` of that name, a robot. :raises ConfigurationError: if there is none."""
        try:
            return self._members[name]
        except (KeyError, TypeError):  # TypeError: not even a name
            raise ConfigurationError("robot '{}' is unknown; there are: {}".format(
                name, ', '.join(list(self._members)[:10]) or 'none')) from None

    def __repr__(self) -> str:
        return '<Fleet of {} robots at {:.3f} s>'.format(len(self._members), self.now)

    def add(self, name: str, **parameters: Any) -> None:
        """Add a robot now; ``parameters`` are those of the ``move_base`` node.

        :raises ConfigurationError: if the name is taken or not a ROS name, or a parameter is not allowed.
        """
        if isinstance(name, str) and name in self._members:
            raise ConfigurationError("robot '{}' is there already".format(name))
        self._add(make_robot(name, parameters, name))

    def remove(self, name: str) -> None:
        """Remove a robot; its goal, if any, is aborted."""
        self.robot(name)._remove(self.now_ns)
        del self._members[name]

    def reset(self) -> None:
        """Put all robots back to their start, without goals. Simulated time is not reset."""
        for member in self._members.values():
            member._reset(self.now_ns)

    def close_zone(self, name: str, closed: bool = True) -> None:
        """Let no robot into a zone from now on, or, with ``closed=False``, let robots in again.

        :raises ConfigurationError: if there is no zone of that name.
        """
        check_kind(name, str, 'name')
        check_kind(closed, bool, 'closed')
        self.traffic.close_zone(name, closed)

    def set_zone_limit(self, name: str, max_speed: Optional[float] = None) -> None:
        """Limit the speed of robots in a zone to ``max_speed`` [m/s] from now on; None removes the limit.

        :raises ConfigurationError: if there is no zone of that name, or the speed is not allowed.
        """
        check_kind(name, str, 'name')
        self.traffic.set_zone_limit(name, max_speed)

    @property
    def zones(self) -> List[AreaState]:
        """The zones, and the lanes with a capacity, with the robots in them and waiting: [:class:`.AreaState`, ...]."""
        return self.traffic.states()

    def use_map(self, occupancy: OccupancyMap) -> None:
        """Use another map from now on; routes that it blocks are planned again."""
        _check_map(occupancy)
        self._occupancy = occupancy
        for member in self._members.values():
            member._use_map(occupancy)
        for member in self._members.values():
            member.navigator.travel.map_changed(self.now_ns)

    def at(self, time_ns: int, action: Callable[[Fleet], object]) -> None:
        """Call ``action(fleet)`` at the simulated time ``time_ns`` [ns], a whole number.

        :raises TimeError: if that time is past, or after the end of simulated time.
        """
        time_ns = as_instant(time_ns, 'time_ns')
        check_function(action, 'action(fleet)')
        if time_ns < self.now_ns:
            raise TimeError('time {} ns is past, it is {} ns'.format(time_ns, self.now_ns))
        self._user_calls.at(time_ns, lambda _due_ns, _now_ns: action(self))

    def run(self, until_ns: Optional[int] = None, until: Optional[float] = None) -> int:
        """Run up to ``until_ns`` [ns] or ``until`` [s], or until no events are left; return the time [ns].

        Without either, the run waits neither for a battery to be charged or used up, nor for failures yet to come.

        :raises TimeError: if that time is past, or after the end of simulated time.
        """
        if until is not None:
            until_ns = seconds_to_ns(as_float(until, 'until'))
        until_ns = None if until_ns is None else as_instant(until_ns, 'until_ns')
        self.simulation.run(until_ns)
        return self.now_ns

    def run_for(self, seconds: float) -> int:
        """Run for ``seconds`` of simulated time; return the time [ns]."""
        return self.run(self.now_ns + seconds_to_ns(as_float(seconds, 'seconds')))

    def write_log(self, path: StrPath) -> None:
        """Write :attr:`trace` as an event log (JSON lines), which replay, compare and the report read.

        :raises ConfigurationError: if the fleet has no trace, or ``path`` is a file that is not an event log.
        :raises OutputError: if the file cannot be written.
        """
        check_path(path, 'path')
        trace = self.trace
        if trace is None:
            raise error('trace', None, 'a list', ', so there is nothing to write')
        write_event_log(path, trace, self._start_ns, End(
            self.now_ns, not self.simulation.queue.is_busy(),
            [name for name, member in self._members.items() if member.navigator.is_active]))

    def _stream(self, with_motion: bool) -> Stream:
        """Return a stream of which the trace and the user's functions hear; ``with_motion``: of all rows."""
        stream = robot_stream()
        if self._rows is not None:
            self._rows.subscribe(stream, with_motion)
        self._user_calls.subscribe(stream, with_motion)
        return stream

    def _note(self, warning: FleetWarning) -> None:
        if self._trace is not None:
            self.warnings.append(warning)

    def _add(self, spec: RobotSpec) -> None:
        self._members[spec.name] = self._member_type(
            self, spec, next(self._indices), self._planner, self._occupancy)


def _of_robot(old: str, new: str) -> Callable[..., Any]:
    def of_robot(fleet: Fleet, name: str, *values: Any, **more: Any) -> Any:
        warn_of_old('Fleet.{}(name)'.format(old), 'Fleet.robot(name).{}'.format(new))
        found = getattr(fleet.robot(name), new)
        return found(*values, **more) if callable(found) else found
    of_robot.__name__ = old
    return of_robot


for _old, _new in _OF_ROBOTS.items():  # set here, so that they are none of a Fleet's for type checkers and editors
    setattr(Fleet, _old, _of_robot(_old, _new))


def _check_map(occupancy: object) -> None:
    from ..maps.occupancy import OccupancyMap  # imports numpy, which only maps need
    check_kind(occupancy, OccupancyMap, 'occupancy', _MAP)


def _entries(trace: Iterable[TraceEntry]) -> List[TraceEntry]:
    check_kind(trace, collections.abc.Iterable, 'trace', 'None, or a list of TraceEntry')
    entries = list(trace)
    for entry in entries:
        check_kind(entry, TraceEntry, 'trace', 'None, or a list of TraceEntry')
    return entries
