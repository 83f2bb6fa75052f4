"""Find the phases of orders from the rows of a dispatcher: when each is open and assigned, and its next stop."""
import json
from typing import NamedTuple

from move_base_abstract.runs.run_difference import MESSAGES

from .recording import is_number

OPEN, ASSIGNED = 0, 1
#: the ways in which orders end, in the order of the columns of counts
ENDINGS = ('done', 'late', 'failed', 'refused')
_STOP = 4  # values of a stop: place, x, y, action


class Phase(NamedTuple):
    """A time in which ``order`` (its name) is OPEN (``robot`` is ''), or ASSIGNED to ``robot``.

    Its next stop is at (x, y) [m].
    """

    begin_ns: int
    end_ns: int
    order: str
    kind: int
    robot: str
    x: float
    y: float
    stop: int  # the number of the next stop, from 1 on
    stops: int  # the number of all stops


class Orders:
    """The orders of a Recording.

    ``phases``: [Phase], in the order of their begins; ``counts``: [(time [ns], open, assigned, done, late, failed,
    refused)].
    """

    def __init__(self, recording):
        self.phases = []
        self.counts = []
        self._stops = {}  # {order: ((x, y), ...)}
        self._present = {}  # {order: (number, begin_ns, kind, robot, stop)}
        self._alive = {OPEN: 0, ASSIGNED: 0}
        self._ended = dict.fromkeys(ENDINGS, 0)
        self._found = []
        self._begun = 0
        handlers = {'order_arrived': self._arrived, 'order_assigned': self._assigned, 'order_stop': self._stop,
                    'order_returned': self._returned, 'order_done': self._done, 'order_refused': self._refused}
        for time_ns, name, kind, text in recording:
            if kind in handlers and kind not in MESSAGES:
                values = json.loads(text)
                if values and isinstance(values[0], str):
                    handlers[kind](time_ns, name, values)
                    self._count(time_ns)
        for order in list(self._present):
            self._close(recording.end_ns + 1, order)  # it is still there at the last instant
        self.phases = [phase for _, phase in sorted(self._found)]

    def _arrived(self, time_ns, _name, values):
        stops = tuple(tuple(values[place + 1:place + 3]) for place in range(3, len(values) - _STOP + 1, _STOP))
        if values[0] not in self._stops and stops and all(is_number(one) for stop in stops for one in stop):
            self._stops[values[0]] = stops
            self._begin(time_ns, values[0], OPEN, '', 1)

    def _assigned(self, time_ns, name, values):
        if values[0] in self._present:
            self._begin(time_ns, values[0], ASSIGNED, name, self._present[values[0]][4])

    def _stop(self, time_ns, name, values):
        if values[0] in self._present and len(values) > 1 and isinstance(values[1], int):
            stop = min(max(values[1], 1), len(self._stops[values[0]]))
            if stop != self._present[values[0]][4]:
                self._begin(time_ns, values[0], ASSIGNED, name, stop)

    def _returned(self, time_ns, _name, values):
        if values[0] in self._present:
            stop = values[2] if len(values) > 2 and isinstance(values[2], int) else 1
            self._begin(time_ns, values[0], OPEN, '', min(max(stop, 1), len(self._stops[values[0]])))

    def _done(self, time_ns, _name, values):
        if values[0] in self._present:
            self._close(time_ns, values[0])
            code = values[1] if len(values) > 1 and values[1] in ENDINGS else 'done'
            self._ended[code] += 1

    def _refused(self, _time_ns, _name, _values):
        self._ended['refused'] += 1

    def _begin(self, time_ns, order, kind, robot, stop):
        self._close(time_ns, order)
        self._present[order] = self._begun, time_ns, kind, robot, stop
        self._alive[kind] += 1
        self._begun += 1

    def _close(self, time_ns, order):
        number, begin_ns, kind, robot, stop = self._present.pop(order, (None, 0, 0, '', 0))
        if number is not None:
            self._alive[kind] -= 1
        if number is not None and time_ns > begin_ns:
            stops = self._stops[order]
            self._found.append((number, Phase(begin_ns, time_ns, order, kind, robot, *stops[stop - 1], stop,
                                              len(stops))))

    def _count(self, time_ns):
        row = (time_ns, *self._alive.values(), *self._ended.values())
        if self.counts and self.counts[-1][0] == time_ns:
            self.counts.pop()
        self.counts.append(row)
