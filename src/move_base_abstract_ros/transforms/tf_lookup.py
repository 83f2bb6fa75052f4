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
from move_base_abstract.common.units import NS_PER_S

from .. import lockstep
from ..messages import conversions
from .tf_watch import publishers

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

    from ..clocks.timing import Clock

_STATIC = '/tf_static'
_STATIC_SECONDS = 2.0  # wall
_POLL_SECONDS = 0.01
_CACHE_SECONDS = 10.0  # simulated; tf's own
_LONG_CACHE_SECONDS = 200.0  # a process without a turn for 2 s finds its goal's stamp at a factor of 100, too
_CONNECT_SECONDS = 1.0  # wall on the scaled clock, simulated in lockstep


class _Frames:
    """A buffer of tf, and its listener. ``cache`` [s, simulated]: for how long the buffer keeps what it hears."""

    def __init__(self, cache: float) -> None:
        self.buffer = tf2_ros.Buffer(rospy.Duration(cache), debug=False)
        self.since_ns = 0  # when the listener began
        self._listener: Any = None
        self._lock = threading.Lock()

    def listen(self) -> None:
        """Listen to tf from now on."""
        with self._lock:
            if self._listener is None:
                self.since_ns = rospy.Time.now().to_nsec()
                self._listener = tf2_ros.TransformListener(self.buffer)

    def close(self) -> None:
        """Stop listening."""
        if self._listener is not None:
            self._listener.unregister()


class _EarlyFrames(_Frames):
    """Frames with the static transforms that come in the first round."""

    def __init__(self) -> None:
        super().__init__(_CACHE_SECONDS)
        self._heard: Set[str] = set()
        self._subscriber = rospy.Subscriber(_STATIC, TFMessage, self._on_static, queue_size=None)

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


_shared: List[_Frames] = []  # one for all robots of a process


def listen_to_static_frames() -> None:
    """Receive all static transforms of nodes that do not take part. Call this in the first round. May block."""
    early = _EarlyFrames()
    _shared.append(early)
    early.wait()


class TfLookup:
    """Finds frames in the global frame. For an unknown frame it waits up to ``timeout`` [s, of ``clock``].

    Without a clock it does not wait.
    """

    def __init__(self, global_frame: Any, timeout: float = 0.0,
                 clock: Optional[Clock] = None) -> None:
        self._global_frame = global_frame
        self._timeout = timeout
        self._clock = clock
        self._frames: Optional[_Frames] = None
        self._has_warned = False

    def wait_for(self, frame_id: Any, stamp_ns: int) -> None:
        """Wait until ``frame_id`` can be found at ``stamp_ns`` [ns], or the time-out has passed. May block."""
        if self._frames is None:
            self._listen()
        if self._clock is not None:
            self._clock.wait_until(lambda: self._knows(frame_id, stamp_ns), self._timeout,
                                   "the frame '{}'".format(frame_id))

    def _listen(self) -> None:
        if self._clock is None:
            self._frames = _Frames(_CACHE_SECONDS)
        else:
            if not _shared:
                _shared.append(_Frames(_LONG_CACHE_SECONDS))
            self._frames = _shared[0]
        self._frames.listen()

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
        if self._frames is None:
            raise FrameError("frame '{}' has not been looked for yet".format(frame_id))
        try:
            transform = self._at(frame_id, stamp_ns)
        except tf2_ros.TransformException as error:
            transform = self._first_heard(frame_id, stamp_ns)
            if transform is None:
                raise FrameError(str(error)) from None
        return conversions.from_transform(transform.transform)

    def _at(self, frame_id: str, stamp_ns: int) -> Any:
        assert self._frames is not None
        return self._frames.buffer.lookup_transform_core(self._global_frame, frame_id, conversions.to_time(stamp_ns))

    def _first_heard(self, frame_id: str, stamp_ns: int) -> Any:
        """Return the latest transform, if ``stamp_ns`` [ns] is that of the goal with which listening began.

        tf tells nobody what was before it began to listen. Return None for any other stamp, or if nothing is known.
        """
        if self._clock is None or self._frames is None or not stamp_ns or abs(
                stamp_ns - self._frames.since_ns) > self._clock.patience_ns(_CONNECT_SECONDS):
            return None
        try:
            latest = self._at(frame_id, 0)
        except tf2_ros.TransformException:
            return None
        late_ns = latest.header.stamp.to_nsec() - stamp_ns
        if late_ns <= 0:
            return None
        if not self._has_warned:
            self._has_warned = True
            rospy.logwarn("%s: this node listens to tf since a goal in '%s' came: of %.3f s nothing is known, the pose "
                          '%.3f s later counts', rospy.get_name(), frame_id, stamp_ns / NS_PER_S, late_ns / NS_PER_S)
        return latest

    def close(self) -> None:
        """Stop listening. Frames that tf knows already can still be found. This is for a look-up without a clock."""
        if self._frames is not None:
            self._frames.close()
