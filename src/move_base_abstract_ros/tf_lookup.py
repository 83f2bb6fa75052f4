"""Looking foreign frames up in tf, listening only from the first goal on that needs it.

Every listener of /tf costs each process time for each message of every robot; most set-ups send their goals in the
global frame and never need one.
"""
import time

import rospy
import tf2_ros

from move_base_abstract.errors import FrameError

from . import conversions

_POLL_SECONDS = 0.02


class TfLookup:
    """Finds frames in the global frame; waits up to ``timeout`` [s, wall] for what is not known yet."""

    def __init__(self, global_frame, timeout):
        self._global_frame = global_frame
        self._timeout = timeout
        self._buffer = None
        self._listener = None

    def wait_for(self, frame_id, stamp_ns):
        """Wait until ``frame_id`` can be found at ``stamp_ns`` [ns], or the time-out has passed. May block."""
        if self._buffer is None:
            self._buffer = tf2_ros.Buffer(debug=False)
            self._listener = tf2_ros.TransformListener(self._buffer)
        deadline = time.monotonic() + self._timeout
        while time.monotonic() < deadline and not rospy.is_shutdown():
            try:
                self.lookup(frame_id, 0 if stamp_ns > rospy.Time.now().to_nsec() else stamp_ns)
                return
            except FrameError:
                time.sleep(_POLL_SECONDS)

    def lookup(self, frame_id, stamp_ns):
        """Return the Pose2D of ``frame_id`` in the global frame at ``stamp_ns`` [ns; 0 = latest]. Never blocks.

        :raises FrameError: if tf does not know.
        """
        if self._buffer is None:
            raise FrameError("frame '{}' has not been looked for yet".format(frame_id))
        try:
            transform = self._buffer.lookup_transform_core(self._global_frame, frame_id, conversions.to_time(stamp_ns))
        except tf2_ros.TransformException as error:
            raise FrameError(str(error)) from None
        return conversions.from_transform(transform.transform)

    def close(self):
        """Listen no more; what was looked up stays what it was."""
        listener, self._listener = self._listener, None
        if listener is not None:
            listener.unregister()
