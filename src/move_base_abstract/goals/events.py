"""What happens to one robot, as values. Subscribe to the robot's :class:`Stream` to hear of it.

Named tuples, made twice as fast as frozen dataclasses. Each begins with the instant [ns] and the name of the robot.
Poses are in the global frame [m, rad]. ``row()`` is its row (:class:`.trace.TraceEntry`); see PLAIN_ROWS for others.
"""
from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple, Sequence, Tuple

from ..engine.stream import Stream

if TYPE_CHECKING:
    from ..motion.approach import MotionPhases
    from ..motion.geometry import Pose2D
    from ..motion.leg import MotionLimits, Tolerances
    from ..motion.recorded_range import Recorded as RecordedRange
    from ..motion.robot import Robot
    from .outcome import GoalState

#: who hears of an event, in this order: it is written down before anybody acts on it, shown before it has consequences
ORDER = (
    'trace',  # of the plain fleet, and the event log
    'users',  # calls at the end of the instant
    'shown',  # poses, the wheels' speed, recovery; and what is wrong, in the node's log
    'clients',  # of goals and of tasks
    'plan',  # the topics with plans
    'battery',  # which feeds work
    'tasks',  # at places, which end when the robot moves or fails
    'condition',  # /diagnostics, battery_state
    'markers',
    'failures',  # which come with the time for which there is a goal
    'encounters',  # for which a robot stands only while it has the goal on whose way it was
    'traffic',  # last: what it does moves robots
)

Row = Tuple[Any, ...]


def robot_stream() -> Stream:
    """Return the stream of one robot."""
    return Stream(ORDER)


class Departed(NamedTuple):
    """The robot starts for ``goal``, by ``corners`` [(x, y)]; ``manner``: as of PacedLeg, if it differs from its law."""

    time_ns: int
    robot: str
    goal: Pose2D
    corners: Sequence[Tuple[float, float]] = ()
    manner: Tuple[float, ...] = ()

    def row(self) -> Row:
        """Return its row; one of a way that has corners has a :meth:`route` behind it."""
        time_ns, robot, goal, _, _ = self
        return time_ns, robot, 'departed', goal.x, goal.y, goal.yaw

    def route(self) -> Row:
        """Return the row of its corners."""
        return (self.time_ns, self.robot, 'route', *chain.from_iterable(self.corners))


class Stands(NamedTuple):
    """The robot has arrived at ``pose``, was stopped there, or was placed there."""

    time_ns: int
    robot: str
    pose: Pose2D

    def row(self) -> Row:
        """Return its row."""
        time_ns, robot, pose = self
        return time_ns, robot, 'stands', pose.x, pose.y, pose.yaw


class Ended(NamedTuple):
    """A goal has ended; ``stamp_ns`` [ns] is that of its id."""

    time_ns: int
    robot: str
    goal_id: str
    stamp_ns: int
    state: GoalState
    text: str

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'ended', self.goal_id, self.state._name_, self.text)


class Aimed(NamedTuple):
    """``goal`` is what the robot works on from now on, sent with ``height`` [m] and ``quaternion`` (x, y, z, w)."""

    time_ns: int
    robot: str
    goal: Pose2D
    height: float
    quaternion: Tuple[float, float, float, float]


class GoalChanged(NamedTuple):
    """The robot has got a goal, or has none any more."""

    time_ns: int
    robot: str


class Abandoned(NamedTuple):
    """The robot no longer goes to its target: its goal has ended, or another goal has replaced it."""

    time_ns: int
    robot: str


class BrokenOff(NamedTuple):
    """An error interrupted the robot's work. It stands, without a goal. Nothing may be left half done."""

    time_ns: int
    robot: str


class WheelsStopped(NamedTuple):
    """move_base would now send a zero velocity."""

    time_ns: int
    robot: str


class Recovery(NamedTuple):
    """Recovery behaviour ``index`` of ``behaviors`` begins."""

    time_ns: int
    robot: str
    pose: Pose2D
    index: int
    behaviors: Tuple[Any, ...]


class Warned(NamedTuple):
    """Something is wrong with a goal, or where the robot is."""

    time_ns: int
    robot: str
    text: str


class Held(NamedTuple):
    """The robot is held for ``reasons``, in the order in which they came; none: it is released."""

    time_ns: int
    robot: str
    reasons: Tuple[str, ...]

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'held' if self.reasons else 'released', *self.reasons)


class Failed(NamedTuple):
    """The robot has failed: ``kind`` and ``cause`` as of :mod:`.failures`."""

    time_ns: int
    robot: str
    kind: str
    cause: str


class Repaired(NamedTuple):
    """The robot is repaired."""

    time_ns: int
    robot: str


class Lapse(NamedTuple):
    """The robot ``begins`` or ends to report a wrong pose or none: ``kind`` and ``cause`` as in :mod:`.lapse`.

    ``by``: of a jump that begins, how far it goes (x, y [m], yaw [rad]).
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


#: what a ChargePassed is about, and what has changed a charge
FULL, EMPTY, ABOVE, BELOW, SET, USED, CHARGED = 'full', 'empty', 'above', 'below', 'set', 'used', 'charged'


class ChargePassed(NamedTuple):
    """The state of charge has passed ``level`` (0..1), or has been ``SET`` to it."""

    time_ns: int
    robot: str
    level: float
    what: str


class Charging(NamedTuple):
    """The robot is charged at the charger of this name from now on, or no more."""

    time_ns: int
    robot: str
    charger: str
    begins: bool

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'charging_began' if self.begins else 'charging_ended', self.charger)


class ChargeRead(NamedTuple):
    """The state of charge (0..1) of a battery of ``energy`` [J]; ``since`` the last one it was USED, CHARGED or SET."""

    time_ns: int
    robot: str
    charge: float
    energy: float
    since: str

    def row(self) -> Row:
        """Return its row."""
        return self.time_ns, self.robot, 'charge', self.charge, self.energy, self.since


class Recorded(NamedTuple):
    """The robot is there; ``range`` (RecordedRange) is what its calibration was fitted to."""

    time_ns: int
    robot: str
    range: RecordedRange

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'recorded', *self.range.row())


class Beyond(NamedTuple):
    """The robot's goal lies outside of what was recorded: ``found`` as of RecordedRange, and the same in ``words``."""

    time_ns: int
    robot: str
    found: Row
    words: str

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'beyond', *self.found)


class Meets(NamedTuple):
    """The robot takes part in encounters from now on, with who comes within ``radius`` [m]."""

    time_ns: int
    robot: str
    radius: float


class Encounter(NamedTuple):
    """The robot meets ``other``: how, how near they will come [m], for how long it has to stand [s]."""

    time_ns: int
    robot: str
    other: str
    kind: str
    nearest: float
    seconds: float


class TaskWaits(NamedTuple):
    """A task waits for room at ``place``."""

    time_ns: int
    robot: str
    goal_id: str
    place: str


class TaskWaited(NamedTuple):
    """A task waits no more."""

    time_ns: int
    robot: str
    goal_id: str
    place: str


class WorksAt(NamedTuple):
    """A task has got one of the ``capacity`` places there are at ``place``, and work on it begins."""

    time_ns: int
    robot: str
    goal_id: str
    place: str
    capacity: int


class TaskBegan(NamedTuple):
    """Work on a task begins, which will take ``duration_ns`` [ns]."""

    time_ns: int
    robot: str
    goal_id: str
    duration_ns: int


class TaskEnded(NamedTuple):
    """A task has ended; ``stamp_ns`` [ns] is that of its id."""

    time_ns: int
    robot: str
    goal_id: str
    stamp_ns: int
    state: GoalState
    text: str

    def row(self) -> Row:
        """Return its row."""
        return (self.time_ns, self.robot, 'task_ended', self.goal_id, self.state._name_, self.text)


class LoadChanged(NamedTuple):
    """From now on the robot's work draws so much [W] from its battery, besides what it needs itself."""

    time_ns: int
    robot: str
    watts: float


class MotionSet(NamedTuple):
    """The robot is there, at ``pose``, or has got other limits or tolerances, by which it travels from now on."""

    time_ns: int
    robot: str
    pose: Pose2D
    limits: MotionLimits
    tolerances: Tolerances

    def row(self) -> Row:
        """Return its row, in which 0 is what has no limit."""
        pose, limits, tolerances = self.pose, self.limits, self.tolerances
        return (self.time_ns, self.robot, 'motion', pose.x, pose.y, pose.yaw, limits.max_speed,
                *(0.0 if math.isinf(limit) else limit for limit in (limits.acceleration, limits.turn_rate)),
                tolerances.xy, tolerances.yaw)


class Phased(NamedTuple):
    """The robot is there, and begins and ends its legs in these ``phases``."""

    time_ns: int
    robot: str
    phases: MotionPhases

    def row(self) -> Row:
        """Return its row, the numbers of MotionPhases in their order."""
        start_turn, *others = vars(self.phases).values()
        return (self.time_ns, self.robot, 'phases', *start_turn, *others)


def motion_of(robot: Robot, now_ns: int) -> MotionSet:
    """Return the event that ``robot`` travels as it does from ``now_ns`` [ns] on."""
    return MotionSet(now_ns, robot.name, robot.pose_at(now_ns), robot.limits, robot.tolerances)


#: of the events whose fields are their rows, the kinds of these rows
PLAIN_ROWS = {
    Failed: 'failed', Repaired: 'repaired', ChargePassed: 'battery', Meets: 'meets', Encounter: 'encounter',
    TaskWaits: 'waiting_began', TaskWaited: 'waiting_ended', WorksAt: 'works_at', TaskBegan: 'task_began'}
