"""The client of a robot's goals or tasks: the answers that do not come by the stream of events."""
from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Optional, Protocol

if TYPE_CHECKING:
    from ..motion.geometry import Pose2D
    from .ledger import GoalRecord


class Client(Protocol):
    """What a GoalLedger needs of a client: a status and ids of goals."""

    @property
    def publish_status(self) -> Optional[Callable[[], object]]:
        """A function that publishes the states of all goals; None: nobody wants to know."""
        ...

    def new_id(self, now_ns: int) -> str:
        """Return an id for a goal that came without one at ``now_ns`` [ns]."""
        ...


class GoalClient(Client, Protocol):
    """The client of a robot's goals, which gets feedback with the robot's pose on its way."""

    @property
    def is_feedback_heard(self) -> Optional[Callable[[], int]]:
        """A function that returns who hears the feedback, see ``is_heard`` of :class:`Series`; None: always send it."""
        ...

    def feedback(self, record: GoalRecord, pose: Pose2D, stamp_ns: int, is_last: bool) -> Optional[int]:
        """Send feedback: at ``stamp_ns`` [ns] the robot is at ``pose`` (global frame).

        Return for how long [ns] no feedback is needed, or None. ``is_last``: the robot has reached the goal; this
        feedback must not be left out.
        """
        ...


class TaskClient(Client, Protocol):
    """The client of a robot's tasks, which gets their progress."""

    @property
    def is_progress_heard(self) -> Optional[Callable[[], int]]:
        """A function that returns who hears the progress, see ``is_heard`` of :class:`Series`; None: always send it."""
        ...

    def progress(self, record: GoalRecord, elapsed_ns: int, duration_ns: int, now_ns: int) -> object:
        """Send at ``now_ns`` [ns] that ``elapsed_ns`` of the task's ``duration_ns`` [ns] are done."""
        ...


class NoClient:
    """A client that ignores all answers; ids begin with ``prefix``."""

    is_feedback_heard: Optional[Callable[[], int]] = None
    is_progress_heard: Optional[Callable[[], int]] = None
    publish_status: Optional[Callable[[], object]] = None

    def __init__(self, prefix: str) -> None:
        self._prefix = prefix

    def new_id(self, now_ns: int) -> str:
        """Return an id for a goal that came without one at ``now_ns`` [ns]."""
        return '{}-{}'.format(self._prefix, now_ns)

    def feedback(self, _record: GoalRecord, _pose: Pose2D, _stamp_ns: int, _is_last: bool) -> None:
        """Do nothing."""

    def progress(self, _record: GoalRecord, _elapsed_ns: int, _duration_ns: int, _now_ns: int) -> None:
        """Do nothing."""
