"""What is written down of a robot: the same entries in the trace of the plain Python fleet and in a run's event log."""
from __future__ import annotations

import math
from typing import Any, Callable, Iterable, Iterator, NamedTuple, Optional, Sequence, Tuple, Union

#: of what happens to robots, see :class:`TraceEntry` and :class:`TaskTrace`
KINDS = ('departed', 'route', 'stands', 'ended', 'entered', 'left', 'deadlock', 'held', 'released', 'failed',
         'repaired', 'battery', 'charging_began', 'charging_ended', 'motion', 'waiting_began', 'waiting_ended',
         'task_began', 'task_ended', 'meets', 'encounter', 'recorded', 'beyond')
#: takes an entry as one tuple: (time_ns, robot, kind, *values)
Record = Callable[[Tuple[Any, ...]], object]


class TraceEntry(NamedTuple):
    """Something that happened: when [ns], to which robot, what, and the details.

    Kinds and values: ``departed`` (x, y, yaw of the goal), ``stands`` (x, y, yaw), ``ended`` (goal id, state, text);
    ``route`` (x, y, x, y, ...), behind ``departed``: the corners of a way that has any;
    ``entered`` (area) and ``left`` (area): it got a place in a zone or on a lane, or gave it back; ``deadlock`` (robot,
    area, ...): it closed a circle of waiting;
    ``held`` (reason, ...): for which reasons the robot is held, whenever these change, and ``released`` ();
    ``failed`` (kind, cause, see :mod:`.failures`) and ``repaired`` ();
    ``recorded`` ('length', low, high, 'start_turn', low, high, perhaps 'clearance', low, high), of a robot with a
    calibration that says so, when it is there: what its legs were fitted to [m, rad, m], and ``beyond`` (what, value,
    ...), before ``departed``: a goal lies outside of that, see :mod:`.recorded_range`;
    ``meets`` (radius [m]): it takes part in encounters, and
    ``encounter`` (robot, kind, nearest distance [m], how long it stands for it [s]), see :mod:`.encounter_law`;
    ``battery`` (state of charge, what, see :mod:`.battery`), ``charging_began`` and ``charging_ended`` (zone);
    and, where it is asked for, ``motion`` (x, y, yaw of the robot, then by what it travels from the next leg on:
    max_speed, acceleration, turn_rate, xy_goal_tolerance, yaw_goal_tolerance, as the parameters of these names, in
    which 0 is an acceleration or a turn rate without limit). Positions in m, yaw in rad, global frame.
    """

    time_ns: int
    robot: str
    kind: str
    values: Any


def as_entries(rows: Iterable[Tuple[Any, ...]]) -> Iterator[TraceEntry]:
    """Return the rows that traces have recorded as :class:`TraceEntry` objects: what nobody reads need not be made."""
    return (TraceEntry(row[0], row[1], row[2], row[3:]) for row in rows)


def _nothing(_row: Tuple[Any, ...]) -> None:
    pass


class RobotTrace:
    """Makes the entries of one robot and hands each to ``record``.

    None for ``record`` records nothing.

    ``with_motion``: also by which limits the robot travels, so that its legs can be computed again from the entries.
    """

    def __init__(self, robot_name: str, record: Optional[Record] = None, with_motion: bool = False) -> None:
        self._robot_name = robot_name
        self._record = record or _nothing
        self._with_motion = with_motion

    def motion(self, robot: Any, now_ns: int) -> None:
        """``robot`` (Robot) is there, or has got other limits or tolerances."""
        if self._with_motion:
            pose, limits, tolerances = robot.pose_at(now_ns), robot.limits, robot.tolerances
            self._add(now_ns, 'motion', pose.x, pose.y, pose.yaw, limits.max_speed,
                      *(0.0 if math.isinf(limit) else limit for limit in (limits.acceleration, limits.turn_rate)),
                      tolerances.xy, tolerances.yaw)

    def departed(self, goal: Any, now_ns: int, corners: Sequence[Tuple[float, float]] = ()) -> None:
        """The robot starts for ``goal`` (Pose2D), by ``corners`` [(x, y)]."""
        self._record((now_ns, self._robot_name, 'departed', goal.x, goal.y, goal.yaw))
        if corners:
            self._add(now_ns, 'route', *(value for corner in corners for value in corner))

    def stands(self, pose: Any, now_ns: int) -> None:
        """The robot arrived at ``pose`` (Pose2D), was stopped there or was placed there."""
        self._record((now_ns, self._robot_name, 'stands', pose.x, pose.y, pose.yaw))

    def held(self, reasons: Tuple[str, ...], now_ns: int) -> None:
        """The robot is held for ``reasons``, or for none any more."""
        self._add(now_ns, 'held' if reasons else 'released', *reasons)

    def failed(self, kind: str, cause: str, now_ns: int) -> None:
        """The robot has failed."""
        self._add(now_ns, 'failed', kind, cause)

    def repaired(self, now_ns: int) -> None:
        """It is as before."""
        self._add(now_ns, 'repaired')

    def recorded(self, durations: Any, now_ns: int) -> None:
        """What the robot's ``durations`` (Durations, CalibratedDurations or None) were fitted to, if they say so."""
        if durations is not None and durations.recorded is not None:
            self._add(now_ns, 'recorded', *durations.recorded.row())

    def note(self, kind: str, now_ns: int, *values: Union[float, str]) -> None:
        """Something of ``kind`` happened to the robot."""
        self._add(now_ns, kind, *values)

    def battery(self, level: float, what: str, now_ns: int) -> None:
        """The state of charge has passed a level."""
        self._add(now_ns, 'battery', level, what)

    def charging(self, charger: str, is_charging: bool, now_ns: int) -> None:
        """It is charged, or no more."""
        self._add(now_ns, 'charging_began' if is_charging else 'charging_ended', charger)

    def ended(self, record: Any, stamp_ns: int) -> None:
        """A goal ended; ``record`` is the ledger's."""
        self._record((stamp_ns, self._robot_name, 'ended', record.goal_id, record.state._name_, record.text))

    def _add(self, time_ns: int, kind: str, *values: Union[float, str]) -> None:
        self._record((time_ns, self._robot_name, kind, *values))


class TaskTrace:
    """Makes the entries of one robot's tasks; ``record``: as of RobotTrace.

    ``waiting_began`` and ``waiting_ended`` (goal id, place), where a task has to wait; ``task_began`` (goal id, how
    long it will take [ns]), ``task_ended`` (goal id, state, text).
    """

    def __init__(self, robot_name: str, record: Optional[Record] = None) -> None:
        self._robot_name = robot_name
        self._record = record or _nothing

    def waits(self, record: Any, place: str, now_ns: int) -> None:
        """The task waits for room at ``place``."""
        self._add(now_ns, 'waiting_began', record.goal_id, place)

    def waited(self, record: Any, place: str, now_ns: int) -> None:
        """The task waits no more."""
        self._add(now_ns, 'waiting_ended', record.goal_id, place)

    def began(self, record: Any, duration_ns: int, now_ns: int) -> None:
        """Work on the task begins."""
        self._add(now_ns, 'task_began', record.goal_id, duration_ns)

    def ended(self, record: Any, stamp_ns: int) -> None:
        """The task ended."""
        self._add(stamp_ns, 'task_ended', record.goal_id, record.state.name, record.text)

    def _add(self, time_ns: int, kind: str, *values: Union[int, str]) -> None:
        self._record((time_ns, self._robot_name, kind, *values))
