"""The one queue from which every event of a simulation comes."""
import heapq


class Event:
    """Something that is due: ``action(due_ns, now_ns)``.

    ``due_ns`` [ns] is when it was to happen; ``now_ns`` is the time that the clock really shows, the same or later.
    ``telling`` is the :class:`Series` that it belongs to where that only tells what is so, else None.
    """

    __slots__ = ('action', 'telling')

    def __init__(self, action, telling=None):
        self.action = action
        self.telling = telling

    def cancel(self):
        """Make this event not happen. May be said twice, and after it happened."""
        self.action = None


class EventQueue:
    """Events in the order of their time; at the same instant: lower robot index first, then first scheduled."""

    def __init__(self):
        self._heap = []  # of (due_ns, robot index, number, Event): tuples, since these are compared most of all
        self._sequence = 0
        self._telling = 0

    def count_telling(self, change):
        """``change`` more series that only tell have an event in the queue."""
        self._telling += change

    def schedule(self, due_ns, robot_index, action, telling=None):
        """Add ``action(due_ns, now_ns)`` at ``due_ns`` [ns] and return its :class:`Event`, which can be cancelled."""
        event = Event(action, telling)
        heapq.heappush(self._heap, (due_ns, robot_index, self._sequence, event))
        self._sequence += 1
        return event

    def next_due_ns(self):
        """Return when the next event is due [ns], or None if there is none."""
        heap = self._heap
        while heap and heap[0][3].action is None:
            heapq.heappop(heap)
        return heap[0][0] if heap else None

    def run_until(self, now_ns, enter=lambda due_ns: None):
        """Let all happen that is due at ``now_ns`` [ns] or before, in order, what is scheduled meanwhile included.

        ``enter(due_ns)`` is called before each event.
        """
        while True:
            due_ns = self.next_due_ns()
            if due_ns is None or due_ns > now_ns:
                return
            event = heapq.heappop(self._heap)[3]
            action, event.action = event.action, None
            enter(due_ns)
            action(due_ns, now_ns)

    def foresee(self, before_ns, most):
        """Return what series that only tell will do, as [(due_ns, [Series, ...]), ...], and what comes after it [ns].

        Instant by instant, in order. It ends before ``before_ns`` [ns], before the first instant at which anything else
        is due, and after ``most`` instants. Nothing is changed: :meth:`skip` says later how much of it has happened.
        """
        if not self._telling:
            due_ns = self.next_due_ns()
            return [], before_ns if due_ns is None else min(before_ns, due_ns)
        heap = []
        for due_ns, robot_index, sequence, event in self._heap:
            if event.action is not None:
                if event.telling is None:
                    before_ns = min(before_ns, due_ns)
                else:
                    heap.append((due_ns, robot_index, sequence, event.telling))
        heapq.heapify(heap)
        sequence = self._sequence
        instants = []
        while heap and heap[0][0] < before_ns:
            due_ns, robot_index, _, series = heap[0]
            if not instants or instants[-1][0] != due_ns:
                if len(instants) == most:
                    return instants, due_ns
                instants.append((due_ns, []))
            instants[-1][1].append(series)
            heapq.heapreplace(heap, (due_ns + series.period_ns, robot_index, sequence, series))
            sequence += 1
        return instants, before_ns

    def skip(self, until_ns):
        """Take what was foreseen up to ``until_ns`` [ns] as having happened."""
        while True:
            due_ns = self.next_due_ns()
            if due_ns is None or due_ns > until_ns:
                return
            heapq.heappop(self._heap)[3].telling.skip(due_ns)

    def shift(self, by_ns):
        """Move all that is due by ``by_ns`` [ns]; the order stays."""
        self._heap = [(due_ns + by_ns, *rest) for due_ns, *rest in self._heap]


class Series:
    """An event that comes back every ``period_ns`` [ns], on multiples counted from its start.

    ``action(due_ns, now_ns)`` is called once an instant; multiples that the clock has leapt over are left out, so that
    a fast clock does not bury its listeners, and the k-th one stays at start + k * period exactly. An action that has
    nothing to do for a while may return for how long [ns]; multiples in between are left out as well.

    ``only_tells``: the action changes nothing that another event could see, so that it can be done beforehand.
    """

    def __init__(self, queue, robot_index, period_ns, action, only_tells=False):
        if not period_ns > 0:
            raise ValueError('the period of a series must be > 0 ns, got {!r}'.format(period_ns))
        self._queue = queue
        self._robot_index = robot_index
        self.period_ns = period_ns
        self._action = action
        self._telling = self if only_tells else None
        self._event = None

    def start(self, first_ns):
        """Start anew, with the first call at ``first_ns`` [ns]."""
        self.stop()
        self._schedule(first_ns)
        self._queue.count_telling(self._telling is not None)

    def stop(self):
        """Stop; may be said twice."""
        if self._event is not None:
            self._event.cancel()
            self._event = None
            self._queue.count_telling(-(self._telling is not None))

    def tell(self, due_ns):
        """Do now what is foreseen for ``due_ns`` [ns]."""
        self._action(due_ns, due_ns)

    def skip(self, due_ns):
        """What was due at ``due_ns`` [ns] has been told beforehand."""
        self._schedule(due_ns + self.period_ns)

    def _schedule(self, due_ns):
        self._event = self._queue.schedule(due_ns, self._robot_index, self._happen, self._telling)

    def _happen(self, due_ns, now_ns):
        own = self._event
        pause_ns = self._action(due_ns, now_ns) or 0
        if self._event is own:  # not stopped, not started anew
            self._schedule(due_ns + self.period_ns * ((now_ns + pause_ns - due_ns) // self.period_ns + 1))
