"""What goals are to a navigator, and whom it tells what becomes of them."""
from enum import Enum
from typing import NamedTuple, Tuple


class BadFramePolicy(Enum):
    """What becomes of a goal whose frame is not known: ended at once, or retried until it is cancelled (upstream)."""

    ABORT = 'abort'
    WAIT = 'wait'


class GoalPose(NamedTuple):
    """A goal as it was sent: position [m] and quaternion (x, y, z, w) in ``frame_id`` at ``stamp_ns`` [ns; 0 = now]."""

    frame_id: str
    stamp_ns: int
    position: Tuple[float, float]
    quaternion: Tuple[float, float, float, float]


class NavigatorListener:
    """What a :class:`Navigator` tells the outside. All times in ns, all poses in the global frame."""

    #: a function: whether feedback would be heard; None: it is told anyhow, see :class:`Series`
    is_feedback_heard = None
    #: a function: who hears of the battery, NOBODY to PARTICIPANTS; None: nobody
    is_battery_heard = None

    def departed(self, robot, goal, now_ns):
        """The robot starts for ``goal``."""

    def stands(self, robot, now_ns):
        """The robot arrived, was stopped or was placed elsewhere."""

    def target(self, goal, now_ns):
        """``goal`` is what the robot now works on."""

    def failed(self, kind, cause, now_ns):
        """The robot has failed: a text of FAILURE_KINDS, and one that says of what, see :mod:`.failures`."""

    def repaired(self, now_ns):
        """The robot that had failed is as before."""

    def battery(self, level, what, now_ns):
        """The state of charge has passed the ``level`` in 0..1: a text, see :mod:`.battery`."""

    def charging(self, charger, is_charging, now_ns):
        """The robot is charged from now on, or no more, at the charger of this name."""

    def held(self, reasons, now_ns):
        """The robot is held for ``reasons``, a tuple of texts in the order in which they came; none: it is released."""

    def beyond(self, recorded, found, now_ns):
        """The robot's goal lies outside of what was ``recorded`` (Recorded), in what Recorded.beyond has ``found``."""

    def noted(self, kind, now_ns, *values):
        """Something of ``kind`` (a text) has happened, of which there is nothing more to do than to write it down."""

    def abandons(self, now_ns):
        """Where the robot was going it goes no more: its goal has ended, or gives way to another one."""

    def broken_off(self, now_ns):
        """An error has come up in whatever the robot was about; it stands, without a goal. Nothing may be half done."""

    def stop_wheels(self):
        """move_base would now send a zero velocity."""

    def feedback(self, record, pose, stamp_ns, is_last=False):
        """The robot with the active goal ``record`` is at ``pose``; may return for how long to be silent [ns].

        ``is_last``: it has reached the goal, of which nobody may be left in the dark.
        """

    def recovery(self, pose, index, behaviors, stamp_ns):
        """Recovery behaviour ``index`` of ``behaviors`` begins."""

    def warn(self, text):
        """Something is wrong with a goal."""
