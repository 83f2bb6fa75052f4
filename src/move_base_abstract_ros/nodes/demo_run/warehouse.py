"""The demo's warehouse: it is made from sizes, and has orders that arrive and the package's own dispatcher."""
import os
import time

import rospy

from move_base_abstract.msg import RobotEvent
from move_base_abstract.runs.states import NAMES
from move_base_abstract.runs.story import Story
from move_base_abstract.scenario import read_scenario
from move_base_abstract_worlds.layout import write_site
from move_base_abstract_worlds.sites import KINDS, make_site

from .nodes import WATCHED_POSES, shipped

KIND = 'warehouse'
ORDERS = 200
#: the participants in lockstep, besides the demo
PARTICIPANTS = ['/fleet', '/task_source', '/dispatcher']
_OVER = ('order_done', 'order_refused')


def make(folder, robots, orders, seed, speed, rviz):
    """Make the warehouse in ``folder``; return (path of its scenario, path of its map).

    ``robots``: their number, None for the default; ``orders``: the number within an hour; ``speed`` [m/s].
    """
    _, sizes, defaults = KINDS[KIND]
    values = {size.name: size.default for size in sizes}
    values.update(robots=robots or values['robots'], orders=orders, seed=seed)
    settings = {**defaults, 'max_speed': speed, 'log_motion': True, 'use_map': True,
                **({'pose_update_freq': WATCHED_POSES} if rviz else {})}
    write_site(make_site(KIND, values), values['robots'], settings, 'the demo', folder)
    return os.path.join(folder, 'scenario.yaml'), os.path.join(folder, 'map.yaml')


def start(ros, scenario, clock, map_path, policy, rviz):
    """Start the warehouse's nodes on the master of ``ros`` (Loopback); ``clock``: the time master's parameters."""
    ros.run('time_master', 'time_master', parameters=clock)
    ros.run('map_server', 'map_server', arguments=(map_path,))
    ros.run('fleet', 'fleet', parameters={'scenario': scenario})
    ros.run('task_source', 'task_source', parameters={'scenario': scenario})
    ros.run('dispatcher', 'dispatcher', parameters={'scenario': scenario, **({'policy': policy} if policy else {})})
    if rviz:
        ros.spawn('rviz', ['rviz', '-d', shipped('rviz', 'simulator.rviz')])


class OrdersRun:
    """Counts the orders that are done or refused, until none is left. ``participant``: as for MissionRun."""

    def __init__(self, scenario, participant=None):
        read = read_scenario(scenario)
        self.robots, self.count = len(read.robots), sum(1 for _ in read.orders())
        self.done = 0
        self._participant = participant
        self._since = self._until = None
        rospy.Subscriber('/dispatcher/events', RobotEvent, self._take, queue_size=1000, tcp_nodelay=True)

    def _take(self, message):
        self.done += message.kind in _OVER
        self._until = message.stamp.to_sec(), time.monotonic()

    def elapsed(self):
        """Return the (simulated, wall) seconds from the start of :meth:`run` to the last event of the dispatcher."""
        if self._since is None or self._until is None:
            return 0.0, 0.0
        return self._until[0] - self._since[0], self._until[1] - self._since[1]

    def run(self, tick, period=0.1):
        """Wait until all orders are done. Call ``tick``, which may raise, about every ``period`` [s, wall].

        In lockstep, it is called only when an order is done.
        """
        self._since = rospy.get_time(), time.monotonic()
        next_tick = 0.0
        while self.done < self.count:
            if time.monotonic() >= next_tick:
                tick()
                next_tick = time.monotonic() + period
            done = self.done
            if self._participant is None:
                time.sleep(period)
            else:
                self._participant.wait_until(lambda done=done: self.done > done, what='the end of an order')


def table_of(start_ns, rows):
    """Return (columns, rows) of a table of the robots: their orders and the time [s] that each spent in each state.

    ``start_ns``: the start of the log; ``rows``: (time [ns], robot, kind, values).
    """
    story = Story(start_ns)
    for row in rows:
        story.take(*row)
    story.close()
    return ('robot', 'orders', *(f'{state} [s]' for state in NAMES)), [
        (name, f'{one["orders"]:.0f}', *(f'{one[state]:.1f}' for state in NAMES))
        for name, one in story.figures.items()]
