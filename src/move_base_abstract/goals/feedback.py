"""The feedback that a robot sends on its way to a goal, at a rate in simulated time."""
from __future__ import annotations

from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from ..engine.event_queue import Series
    from ..engine.simulation import Simulation
    from ..motion.robot import Robot
    from .client import GoalClient
    from .ledger import GoalLedger


class GoalFeedback:
    """Sends the pose of ``robot`` to ``client`` (GoalClient) while ``ledger`` has an active goal."""

    def __init__(self, robot: Robot, simulation: Simulation, ledger: GoalLedger, client: GoalClient) -> None:
        self._robot = robot
        self._simulation = simulation
        self._ledger = ledger
        self._client = client
        self._series: Optional[Series] = None
        self.frequency = 0.0  # Hz, simulated; 0: never

    def set_frequency(self, frequency: float) -> None:
        """Send feedback ``frequency`` times per simulated second from now on; 0: never."""
        self.stop()
        self.frequency = frequency
        self._series = self._simulation.series(self._robot.index, frequency, self._tell,
                                               only_tells=True, is_heard=self._client.is_feedback_heard)
        if self._ledger.active is not None:
            self.start(self._simulation.now_ns)

    def start(self, now_ns: int) -> None:
        """Begin to send feedback for a goal at ``now_ns`` [ns]."""
        if self._series is not None:
            self._series.start(now_ns)

    def stop(self) -> None:
        """Stop sending feedback, because the goal has ended."""
        if self._series is not None:
            self._series.stop()

    def tell_last(self, now_ns: int) -> None:
        """Send the last feedback of a goal, which the robot has reached at ``now_ns`` [ns]; it is never left out."""
        record, telling = self._ledger.active, self._robot.telling
        if record is not None and self._series is not None and not telling.is_mute:
            self._client.feedback(record, telling.pose_at(now_ns), now_ns, True)

    def _tell(self, due_ns: int, _now_ns: int) -> Optional[int]:
        record, telling = self._ledger.active, self._robot.telling
        if record is None or self._ledger.is_silent or telling.is_mute:
            return None
        return self._client.feedback(record, telling.pose_at(due_ns), due_ns, False)
