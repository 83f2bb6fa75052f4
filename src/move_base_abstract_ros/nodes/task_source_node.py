"""The node ``task_source``: publishes tasks and orders as they arrive, at random instants or at those of a file."""
from functools import partial

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown_text
from move_base_abstract.common.units import LAST_NS, far_ahead
from move_base_abstract.config.node_tables import TASK_SOURCE, TASK_SOURCE_INLINE
from move_base_abstract.msg import Order, Task
from move_base_abstract.tasks.arrivals import NEXT

from ..clocks.timing import make_timing
from ..fleet.fleet_scenario import given_scenario
from ..messages import orders, packing
from ..messages.outlets import Outlet
from ..process.node_process import parse_no_arguments, run_node
from ..process.own_parameters import own_values

#: parameters that hold the scenario itself, if no file is given
_INLINE = tuple(parameter.name for parameter in TASK_SOURCE_INLINE)


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter cannot be used."""
    parse_no_arguments('task_source', __doc__)
    run_node('task_source', _build)


def _build():
    where = rospy.get_name()
    raw, values = own_values(TASK_SOURCE, _INLINE)
    scenario = given_scenario(raw, values, _INLINE, where)
    if not scenario.arrivals and not scenario.order_sources:
        raise ConfigurationError('parameter {0}/arrivals: got none, and no orders; allowed: at least one of either, '
                                 'here or in the scenario'.format(where))
    timing = make_timing()
    clock = timing.make_clock()
    if not clock.start():
        return None
    source = TaskSource(clock, timing, scenario, values)
    clock.serve()
    return source


class TaskSource:
    """Publishes the tasks of a scenario on one topic, and its orders on another."""

    def __init__(self, clock, timing, scenario, values):
        frame = str(scenario.defaults.get('global_frame', 'map'))
        self._sources = []
        for is_there, items, topic, kind, to_message in (
                (scenario.arrivals, scenario.tasks, values['topic'], Task, orders.to_task),
                (scenario.order_sources, scenario.orders, values['orders_topic'], Order, orders.to_order)):
            if is_there:
                self._sources.append(_Source(clock, timing, items(values['seed']), topic, kind,
                                             partial(_packed, to_message, frame), values['wait_for_listener']))


def _packed(to_message, frame, item, stamp_ns):
    return packing.of_message(to_message(item, frame, stamp_ns))


class _Source:
    """Publishes each of ``items`` at its arrival. Arrivals count from the instant at which a node begins to listen.

    Without ``needs_listener`` they count from the start.
    """

    def __init__(self, clock, timing, items, topic, kind, pack, needs_listener):
        self._clock = clock
        self._timing = timing
        self._items = items
        self._pack = pack
        self._begin_ns = None
        self._has_waited = False  # whether it was said that something comes much later
        self._needs_listener = needs_listener
        self._outlet = None
        self._outlet = _Arrivals(topic, kind, self._look)
        clock.follow_restarts(self._restart)
        self._look()

    def _look(self):
        """Begin, if a node listens or none is needed."""
        if self._outlet is None or self._begin_ns is not None:
            return
        if not self._needs_listener or self._timing.is_audience(self._outlet.is_heard()):
            with self._clock.lock:
                if self._begin_ns is None:
                    self._begin_ns = self._clock.now_ns()
                    self._schedule(next(self._items, None))

    def _restart(self, before_ns, now_ns):
        if self._begin_ns is not None:
            self._begin_ns += now_ns - before_ns

    def _schedule(self, item):
        due_ns = None if item is None else self._begin_ns + item.arrival_ns
        if due_ns is None or due_ns > LAST_NS:
            rospy.loginfo('%s: no more %s arrive', rospy.get_name(), self._outlet.what)
            return
        if not self._has_waited:
            name = getattr(item, 'order_id', None) or getattr(item, 'task_id', '')
            ahead = far_ahead(NEXT.format(self._outlet.what[:-1], shown_text(name)), due_ns, self._clock.now_ns())
            if ahead:
                self._has_waited = True
                rospy.logwarn('%s: %s', rospy.get_name(), ahead)
        self._clock.simulation.queue.schedule(due_ns, 0, lambda due_ns, _now_ns: self._arrives(item, due_ns))

    def _arrives(self, item, due_ns):
        self._outlet.send(self._pack(item, due_ns))
        self._schedule(next(self._items, None))


class _Arrivals(Outlet):
    """The topic of a _Source. It calls ``came()`` when a node begins to listen."""

    def __init__(self, topic, kind, came):
        self.what = kind.__name__.lower() + 's'
        self._came = came
        super().__init__(topic, kind, queue_size=1000, tcp_nodelay=True)

    def greet(self, _peer_publish):
        """Call ``came()``, because a node begins to listen."""
        self._came()
