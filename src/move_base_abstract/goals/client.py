"""The client of a robot's goals or tasks, as far as it is answered apart from the stream of events."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Optional, Protocol

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D
    from .ledger import GoalRecord


class Client(Protocol):
    """What a GoalLedger asks for: see there."""

    def publish_status(self) -> object:
        """Tell the states of all goals."""
        ...

    def new_id(self, now_ns: int) -> str:
        """Return an id for a goal that came without one at ``now_ns`` [ns]."""
        ...


class GoalClient(Client, Protocol):
    """The client of a robot's goals, who may want to know where it is on its way."""

    @property
    def is_feedback_heard(self) -> Optional[Callable[[], int]]:
        """A function: who would hear it, as of :class:`Series`; None: it is told anyhow."""
        ...

    def feedback(self, record: GoalRecord, pose: Pose2D, stamp_ns: int, is_last: bool) -> Optional[int]:
        """Tell that the robot is at ``pose`` (global frame); return for how long to be silent [ns], if at all.

        ``is_last``: it has reached the goal, of which nobody may be left in the dark.
        """
        ...


class TaskClient(Client, Protocol):
    """The client of a robot's tasks, who may want to know how much is done."""

    @property
    def is_progress_heard(self) -> Optional[Callable[[], int]]:
        """A function: who would hear it, as of :class:`Series`; None: it is told anyhow."""
        ...

    def progress(self, record: GoalRecord, elapsed_ns: int, duration_ns: int, now_ns: int) -> object:
        """Tell how much of the task is done."""
        ...


class NoClient:
    """A client that ignores all answers; ids begin with ``prefix``."""

    is_feedback_heard: Optional[Callable[[], int]] = None
    is_progress_heard: Optional[Callable[[], int]] = None

    def __init__(self, prefix: str) -> None:
        self._prefix = prefix

    def publish_status(self) -> None:
        """Tell nobody."""

    def new_id(self, now_ns: int) -> str:
        """Return an id for a goal without one."""
        return '{}-{}'.format(self._prefix, now_ns)

    def feedback(self, _record: GoalRecord, _pose: Pose2D, _stamp_ns: int, _is_last: bool) -> None:
        """Tell nobody."""

    def progress(self, _record: GoalRecord, _elapsed_ns: int, _duration_ns: int, _now_ns: int) -> None:
        """Tell nobody."""
