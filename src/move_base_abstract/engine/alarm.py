"""One thing that a robot has ahead of it, which may be put off."""


class Alarm:
    """At most one event of a robot in ``queue`` (EventQueue); ``due_ns``: when it is due [ns], or None.

    ``keeps_going``: as of :meth:`.event_queue.EventQueue.schedule`.
    """

    def __init__(self, queue, robot_index, keeps_going=None):
        self._queue = queue
        self._robot_index = robot_index
        self._keeps_going = keeps_going
        self._event = None
        self.due_ns = None

    def set(self, due_ns, action):
        """Call ``action(due_ns)`` at ``due_ns`` [ns], and nothing else."""
        self.cancel()
        self.due_ns = due_ns
        self._event = self._queue.schedule(due_ns, self._robot_index, lambda at_ns, _: self._go_off(action, at_ns),
                                           keeps_going=self._keeps_going)

    def cancel(self):
        """Call nothing."""
        if self._event is not None:
            self._event.cancel()
            self._event = self.due_ns = None

    def shift(self, by_ns):
        """The queue has been shifted by ``by_ns`` [ns]."""
        if self.due_ns is not None:
            self.due_ns += by_ns

    def _go_off(self, action, at_ns):
        self._event = self.due_ns = None
        action(at_ns)
