"""The events of one robot's tasks, as values; see :mod:`.events`."""
from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..runs.trace import RowKind
from .events import written

if TYPE_CHECKING:
    from .outcome import GoalState


@written(RowKind('waiting_began', 'goal id, place', 'a [task](tasks.md) waits for room'))
class TaskWaits(NamedTuple):
    """A task waits for room at ``place``."""

    time_ns: int
    robot: str
    goal_id: str
    place: str


@written(RowKind('waiting_ended', 'goal id, place', 'it no longer does'))
class TaskWaited(NamedTuple):
    """A task no longer waits for room at ``place``."""

    time_ns: int
    robot: str
    goal_id: str
    place: str


@written(RowKind('works_at', 'goal id, place, capacity', 'before `task_began`: a task has got room there'))
class WorksAt(NamedTuple):
    """A task has got room at ``place``, which has room for ``capacity`` tasks, and work on it begins."""

    time_ns: int
    robot: str
    goal_id: str
    place: str
    capacity: int


@written(RowKind('task_began', 'goal id, duration [ns]', 'work on a task begins'))
class TaskBegan(NamedTuple):
    """Work on a task begins; it will take ``duration_ns`` [ns]."""

    time_ns: int
    robot: str
    goal_id: str
    duration_ns: int


@written(RowKind('task_ended', 'goal id, state, text', 'a task has ended'))
class TaskEnded(NamedTuple):
    """A task has ended; ``stamp_ns`` [ns] is the stamp of its id."""

    time_ns: int
    robot: str
    kind: str
    goal_id: str
    state_name: str
    text: str
    stamp_ns: int
    state: GoalState


class LoadChanged(NamedTuple):
    """From now on the robot's work draws ``watts`` [W] from its battery, besides what the robot itself needs."""

    time_ns: int
    robot: str
    watts: float
