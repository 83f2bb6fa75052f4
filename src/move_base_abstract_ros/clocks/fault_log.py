"""Write unexpected errors into the node's log."""
from __future__ import annotations

import traceback
from typing import Any

import rospy

from move_base_abstract.engine.guard import fault_text

from .throttle import WallThrottle

_REPEATED_RATE = 0.2  # Hz, wall


class FaultLog:
    """Logs the errors that a Simulation reports; the same error at most once in 5 s of wall time."""

    def __init__(self) -> None:
        self._last = None
        self._throttle = WallThrottle(_REPEATED_RATE)

    def __call__(self, who: str, error: Any) -> None:
        """Log the exception ``error`` with its traceback. ``who``: the part in which it came up, a text."""
        told: Any = who, fault_text(error)
        if told != self._last or self._throttle.ready():
            self._last = told
            rospy.logerr('%s: %s\n%s', *told, ''.join(traceback.format_exception(
                type(error), error, error.__traceback__)).rstrip())
