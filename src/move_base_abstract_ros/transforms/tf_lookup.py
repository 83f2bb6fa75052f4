"""Look-up of foreign frames in tf. It listens to tf only from the first goal on that needs it.

A listener of /tf takes time for each message of every robot. Most set-ups send their goals in the global frame and
never need one.
"""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, List, Optional, Set

import rospy
import tf2_ros
from tf2_msgs.msg import TFMessage

from move_base_abstract.common.errors import FrameError

from .. import lockstep
from ..messages import conversions
from .tf_watch import publishers

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

    from ..clocks.timing import Clock

_STATIC = '/tf_static'
_STATIC_SECONDS = 2.0  # wall
_POLL_SECONDS = 0.01


class _EarlyFrames:
    """One buffer for all robots of a process, with the static transforms that come in the first round."""

    def __init__(self) -> None:
        self.buffer = tf2_ros.Buffer(debug=False)
        self._heard: Set[str] = set()
        self._listener = None
        self._lock = threading.Lock()
        self._subscriber = rospy.Subscriber(_STATIC, TFMessage, self._on_static, queue_size=None)

    def listen(self) -> None:
        """Listen to /tf, too, from now on."""
        with self._lock:
            if self._listener is None:
                self._listener = tf2_ros.TransformListener(self.buffer)

    def wait(self) -> None:
        """Wait for all onlookers that publish static transforms; these are latched, so each of them sends some."""
        # The transforms of participants come in a later round.
        takes_part = lockstep.participant().members.is_member  # type: ignore[union-attr]
        expected = {name for name in publishers(_STATIC) if not takes_part(name)}
        deadline = time.monotonic() + _STATIC_SECONDS
        while not expected <= self._heard and not rospy.is_shutdown():
            if time.monotonic() > deadline:
                rospy.logwarn('%s: nothing has come on %s from %s: their frames may be unknown to goals',
                              rospy.get_name(), _STATIC, ', '.join(sorted(expected - self._heard)))
                return
            time.sleep(_POLL_SECONDS)

    def _on_static(self, message: Any) -> None:
        for transform in message.transforms:
            self.buffer.set_transform_static(transform, 'default_authority')
        self._heard.add(message._connection_header['callerid'])


_early: List[_EarlyFrames] = []


def listen_to_static_frames() -> None:
    """Receive all static transforms of nodes that do not take part. Call this in the first round. May block."""
    _early.append(_EarlyFrames())
    _early[0].wait()


class TfLookup:
    """Finds frames in the global frame. For an unknown frame it waits up to ``timeout`` [s, of ``clock``].

    Without a clock it does not wait.
    """

    def __init__(self, global_frame: Any, timeout: float = 0.0,
                 clock: Optional[Clock] = None) -> None:
        self._global_frame = global_frame
        self._timeout = timeout
        self._clock = clock
        self._buffer = None
        self._listener = None

    def wait_for(self, frame_id: Any, stamp_ns: int) -> None:
        """Wait until ``frame_id`` can be found at ``stamp_ns`` [ns], or the time-out has passed. May block."""
        if self._buffer is None:
            self._listen()
        if self._clock is not None:
            self._clock.wait_until(lambda: self._knows(frame_id, stamp_ns), self._timeout,
                                   "the frame '{}'".format(frame_id))

    def _listen(self) -> None:
        if _early:
            _early[0].listen()
            self._buffer = _early[0].buffer
        else:
            self._buffer = tf2_ros.Buffer(debug=False)
            self._listener = tf2_ros.TransformListener(self._buffer)

    def _knows(self, frame_id: str, stamp_ns: int) -> bool:
        try:
            self.lookup(frame_id, 0 if stamp_ns > rospy.Time.now().to_nsec() else stamp_ns)
        except FrameError:
            return False
        return True

    def lookup(self, frame_id: Any, stamp_ns: int) -> Pose2D:
        """Return the Pose2D of ``frame_id`` in the global frame at ``stamp_ns`` [ns; 0 = latest]. Never blocks.

        :raises FrameError: if tf cannot find the frame.
        """
        if self._buffer is None:
            raise FrameError("frame '{}' has not been looked for yet".format(frame_id))
        try:
            transform = self._buffer.lookup_transform_core(self._global_frame, frame_id, conversions.to_time(stamp_ns))
        except tf2_ros.TransformException as error:
            raise FrameError(str(error)) from None
        return conversions.from_transform(transform.transform)

    def close(self) -> None:
        """Stop listening. Frames that tf knows already can still be found."""
        listener, self._listener = self._listener, None
        if listener is not None:
            listener.unregister()
