"""What goals are to a navigator."""
from enum import Enum
from typing import NamedTuple, Tuple


class BadFramePolicy(Enum):
    """What happens to a goal in an unknown frame: it ends at once, or is retried until it is cancelled (upstream)."""

    ABORT = 'abort'
    WAIT = 'wait'


class GoalPose(NamedTuple):
    """A goal as it was sent: position [m] and quaternion (x, y, z, w) in ``frame_id`` at ``stamp_ns`` [ns; 0 = now].

    ``height``: its z [m]. Robots move in the plane; it is only shown.
    """

    frame_id: str
    stamp_ns: int
    position: Tuple[float, float]
    quaternion: Tuple[float, float, float, float]
    height: float = 0.0
