"""Goals as a navigator gets them."""
from enum import Enum
from typing import NamedTuple, Tuple


class BadFramePolicy(Enum):
    """What happens to a goal in an unknown frame: it ends at once, or, as in move_base, is retried until cancelled."""

    ABORT = 'abort'
    WAIT = 'wait'


class GoalPose(NamedTuple):
    """A goal as it was sent: position [m] and quaternion (x, y, z, w) in ``frame_id`` at ``stamp_ns`` [ns; 0 = now].

    ``height``: its z [m], which is only shown, because robots move in the plane.
    """

    frame_id: str
    stamp_ns: int
    position: Tuple[float, float]
    quaternion: Tuple[float, float, float, float]
    height: float = 0.0
