"""The events of one robot, as values. Subscribe to the robot's :class:`Stream` to get them.

They are named tuples, which are made twice as fast as frozen dataclasses. Each begins with the instant [ns] and the
name of the robot. Poses are in the global frame [m, rad]. ``row()`` returns the event's row in the trace
(:class:`.trace.TraceEntry`); an event without it is written as its fields. The most frequent ones are rows themselves,
with their ``kind``, so that they cost next to nothing (of Ended and TaskEnded the first six fields are the row).
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Dict, NamedTuple, Tuple, Type, TypeVar

from ..engine.stream import Stream
from ..motion.told import told
from ..runs.trace import RowKind

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D
    from ..motion.leg import MotionLimits, Tolerances
    from ..motion.pieces import Motion
    from ..motion.recorded_range import Recorded as RecordedRange
    from ..motion.robot import Robot
    from .outcome import GoalState

#: the subscribers, in the order in which they get an event: it is logged and shown before anything acts on it
ORDER = (
    'trace',  # the trace of the plain fleet, and the event log
    'users',  # the user's calls, which come at the end of the instant
    'shown',  # poses, the wheels' speed, recovery, and warnings in the node's log
    'clients',  # the clients of goals and of tasks
    'plan',  # the topics with plans
    'battery',  # from which the work of tasks draws power
    'tasks',  # tasks at places, which end when the robot moves or fails
    'condition',  # /diagnostics, battery_state
    'markers',
    'failures',  # they count the time during which the robot has a goal
    'encounters',  # a robot stands for one only while it has the same goal
    'traffic',  # last, because traffic moves robots
)

Row = Tuple[Any, ...]
AnEvent = TypeVar('AnEvent', bound=NamedTuple)
#: {type of events that are written down: the kinds of their rows}
WRITTEN: Dict[Type[Any], Tuple[RowKind, ...]] = {}
#: ``new(Stands, (now_ns, name, pose))`` makes an event in half the time that its constructor takes; it takes all fields
new = tuple.__new__


def written(*kinds: RowKind) -> Callable[[Type[AnEvent]], Type[AnEvent]]:
    """Return what notes that the events of a class are written down, as rows of these ``kinds``."""
    def note(event: Type[AnEvent]) -> Type[AnEvent]:
        WRITTEN[event] = kinds
        return event
    return note


def robot_stream() -> Stream:
    """Return a new stream for the events of one robot."""
    return Stream(ORDER)


@written(RowKind('goal', 'goal id',
                 'the robot takes in a goal. The row comes before all others that follow from the goal: before `ended` '
                 'of the goal that it replaces, and before `ended` of a goal that is recalled or aborted at once. A '
                 '[silent](failures.md) robot takes in the goals that came meanwhile when it answers again. A goal '
                 'whose id the robot knows already is no new goal'))
class GoalTaken(NamedTuple):
    """The robot has taken in a goal, whatever becomes of it: this comes before all that follows from the goal."""

    time_ns: int
    robot: str
    kind: str
    goal_id: str


@written(RowKind('departed', 'x, y, yaw of the goal', 'the robot departs for its goal'))
class Departed(NamedTuple):
    """The robot departs for the goal ``x``, ``y``, ``yaw``."""

    time_ns: int
    robot: str
    kind: str
    x: float
    y: float
    yaw: float


@written(RowKind('driven', 'x, y, yaw of the robot, speed ahead, sideways, turn rate',
                 'the robot, which is [driven by velocities](velocity_robots.md), drives towards this velocity from '
                 'now on'))
class Driven(NamedTuple):
    """The robot is at ``x``, ``y``, ``yaw`` and drives towards another twist [m/s, m/s, rad/s] from now on."""

    time_ns: int
    robot: str
    x: float
    y: float
    yaw: float
    forward: float
    lateral: float
    turning: float


@written(RowKind('pieces', '[begin [ns], x, y, yaw, ux, uy, v, a, w, k], ...',
                 'after `departed` and `driven`: the [pieces](move_base.md#pieces-of-a-motion) of the leg, the last '
                 'one at rest at its end', True))
class Drives(NamedTuple):
    """The robot travels ``leg``, on which it has departed."""

    time_ns: int
    robot: str
    leg: Motion

    def row(self) -> Row:
        """Return its row, with the pieces and the rest from the arrival on."""
        return (self.time_ns, self.robot, 'pieces', *told(self.leg))


@written(RowKind('stands', 'x, y, yaw', 'the robot has arrived, was stopped, or was placed there'))
class Stands(NamedTuple):
    """The robot stands at ``x``, ``y``, ``yaw``: it has arrived, was stopped or was placed there."""

    time_ns: int
    robot: str
    kind: str
    x: float
    y: float
    yaw: float


@written(RowKind('ended', 'goal id, state, text', 'a goal has ended'))
class Ended(NamedTuple):
    """A goal has ended; ``stamp_ns`` [ns] is the stamp of its id."""

    time_ns: int
    robot: str
    kind: str
    goal_id: str
    state_name: str
    text: str
    stamp_ns: int
    state: GoalState


@written(RowKind('stalled', 'by',
                 'the robot, which is driven by velocities, touches a wall (`wall`) or the robot of this name, and '
                 'stands until a command leads away'))
class Stalled(NamedTuple):
    """The robot has come to a wall or another robot; ``by``: see :mod:`.driver`."""

    time_ns: int
    robot: str
    by: str


class Aimed(NamedTuple):
    """The robot works on ``goal`` from now on; it was sent with ``height`` [m] and ``quaternion`` (x, y, z, w)."""

    time_ns: int
    robot: str
    goal: Pose2D
    height: float
    quaternion: Tuple[float, float, float, float]


class GoalChanged(NamedTuple):
    """The robot has got a goal, or its goal has ended."""

    time_ns: int
    robot: str


class Abandoned(NamedTuple):
    """The robot has given up its target: its goal has ended, or another goal has replaced it."""

    time_ns: int
    robot: str


class BrokenOff(NamedTuple):
    """An unexpected error ended the robot's work. It stands, without a goal. Subscribers undo what is half done."""

    time_ns: int
    robot: str


class WheelsStopped(NamedTuple):
    """The robot's wheels are told to stop: move_base would send a zero velocity now."""

    time_ns: int
    robot: str


class Recovery(NamedTuple):
    """The recovery behaviour ``behaviors[index]`` (RecoveryBehavior) begins, with the robot at ``pose``."""

    time_ns: int
    robot: str
    pose: Pose2D
    index: int  # type: ignore[assignment]  # a tuple's method of that name is not needed
    behaviors: Tuple[Any, ...]


class Warned(NamedTuple):
    """Something is wrong with a goal or with the robot's position; ``text`` says what."""

    time_ns: int
    robot: str
    text: str


@written(RowKind('held', 'reason, ...',
                 'all reasons for which the robot is held, whenever they change. It stands with its goal ACTIVE, and '
                 'then goes on from rest, by a way that is planned again'),
         RowKind('released', '', 'nothing holds the robot any more'))
class Held(NamedTuple):
    """The robot is held for ``reasons``, in the order in which they came. Without reasons, it has been released."""

    time_ns: int
    robot: str
    reasons: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'held' if self.reasons else 'released', *self.reasons)


@written(RowKind('failed', 'kind, cause', 'the robot has [failed](failures.md)'))
class Failed(NamedTuple):
    """The robot has failed; :mod:`.failures` lists each ``kind`` and ``cause``."""

    time_ns: int
    robot: str
    kind: str
    cause: str


@written(RowKind('repaired', '', 'it is repaired'))
class Repaired(NamedTuple):
    """The robot is repaired."""

    time_ns: int
    robot: str


@written(RowKind('lapse_began', 'kind, cause; for a jump also x, y, yaw',
                 'the robot reports a [wrong pose](failures.md#on-purpose), by so much, or none'),
         RowKind('lapse_ended', 'kind, cause', 'it no longer does'))
class Lapse(NamedTuple):
    """The robot ``begins`` to report a wrong pose or none, or no longer does.

    ``kind`` and ``cause``: see :mod:`.buggify`. ``by``: if a jump begins, its size (x, y [m], yaw [rad]).
    """

    time_ns: int
    robot: str
    kind: str
    cause: str
    begins: bool
    by: Tuple[float, ...] = ()

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'lapse_began' if self.begins else 'lapse_ended', self.kind, self.cause,
                *self.by)


#: values of ``what`` in a ChargePassed (the first five), and of ``since`` in a ChargeRead (the last three)
FULL, EMPTY, ABOVE, BELOW, SET, USED, CHARGED = 'full', 'empty', 'above', 'below', 'set', 'used', 'charged'


@written(RowKind('battery', 'state of charge, what',
                 'the charge has passed a [threshold](battery.md#thresholds-and-empty), or was set'))
class ChargePassed(NamedTuple):
    """The state of charge has passed ``level`` (0..1), or has been set to it.

    ``what``: FULL, EMPTY, ABOVE, BELOW or SET.
    """

    time_ns: int
    robot: str
    level: float
    what: str


@written(RowKind('charging_began', 'zone', 'a charger begins to charge the robot'),
         RowKind('charging_ended', 'zone', 'it no longer does'))
class Charging(NamedTuple):
    """The robot ``begins`` to be charged at the charger of this name, or no longer is."""

    time_ns: int
    robot: str
    charger: str
    begins: bool

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'charging_began' if self.begins else 'charging_ended', self.charger)


@written(RowKind('charge', 'state of charge, energy of a full battery [J], `used`, `charged` or `set`',
                 'the charge, and what has changed it', True))
class ChargeRead(NamedTuple):
    """The state of charge (0..1) of a battery that holds ``energy`` [J] when full.

    ``since``: what has changed it since the last ChargeRead: USED, CHARGED or SET.
    """

    time_ns: int
    robot: str
    charge: float
    energy: float
    since: str


@written(RowKind('recorded',
                 "'length', low, high [m], 'start_turn', low, high [rad], perhaps 'clearance', low, high [m]",
                 'the legs to which its [calibration](calibrate.md#goals-outside-of-what-was-recorded) was fitted, '
                 'when the robot is made'))
class Recorded(NamedTuple):
    """The robot exists from now on; its calibration was fitted to legs in ``range`` (RecordedRange)."""

    time_ns: int
    robot: str
    range: RecordedRange

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'recorded', *self.range.row())


@written(RowKind('beyond', 'name, value, ...', 'before `departed`: the goal lies outside of that'))
class Beyond(NamedTuple):
    """The robot's goal lies outside of the range of its calibration.

    ``found``: in which respects, see RecordedRange.beyond; ``words``: the same for people to read.
    """

    time_ns: int
    robot: str
    found: Row
    words: str

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'beyond', *self.found)


@written(RowKind('meets', 'radius [m]', 'the robot takes part in [encounters](encounters.md)'))
class Meets(NamedTuple):
    """The robot takes part in encounters from now on, with robots that come within ``radius`` [m]."""

    time_ns: int
    robot: str
    radius: float


@written(RowKind('encounter', 'robot, kind, nearest distance [m], time for which it stands [s]',
                 'the robot meets another one'))
class Encounter(NamedTuple):
    """The robot meets the robot ``other``.

    ``kind``: how they meet; ``nearest`` [m]: how near they will come; ``seconds`` [s]: for how long this robot stands.
    """

    time_ns: int
    robot: str
    other: str
    kind: str
    nearest: float
    seconds: float


@written(RowKind('motion',
                 'x, y, yaw of the robot, max_speed, acceleration, turn_rate (0: no limit), xy_goal_tolerance, '
                 'yaw_goal_tolerance',
                 'the limits from now on, and the tolerances from the next leg on: when the robot is made, and '
                 'when they change', True))
class MotionSet(NamedTuple):
    """From now on the robot travels by these limits and tolerances: it has been made, at ``pose``, or they changed."""

    time_ns: int
    robot: str
    pose: Pose2D
    limits: MotionLimits
    tolerances: Tolerances

    def row(self) -> Row:
        """Return its row, in which 0 stands for no limit."""
        pose, limits, tolerances = self.pose, self.limits, self.tolerances
        return (self.time_ns, self.robot, 'motion', pose.x, pose.y, pose.yaw, limits.max_speed,
                *(0.0 if math.isinf(limit) else limit for limit in (limits.acceleration, limits.turn_rate)),
                tolerances.xy, tolerances.yaw)


def motion_of(robot: Robot, now_ns: int) -> MotionSet:
    """Return the event that ``robot`` travels from ``now_ns`` [ns] on by the limits and tolerances that it has."""
    return MotionSet(now_ns, robot.name, robot.pose_at(now_ns), robot.limits, robot.tolerances)
