"""The node ``dispatcher``: gives orders to the robots of a fleet as they arrive, and sends robots to charge.

It hears orders and events of robots, and sends goals. It uses topics and actions only. The core (:class:`.Dispatcher`)
makes the decisions, as in plain Python.
"""
from dataclasses import asdict, replace

import rospy
from actionlib_msgs.msg import GoalID
from move_base_msgs.msg import MoveBaseActionGoal
from std_msgs.msg import Int32

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import TOPIC, string
from move_base_abstract.common.parameter_table import Parameter
from move_base_abstract.fleet.dispatch_world import Decisions, check_levels
from move_base_abstract.msg import Order, PlaceTaskActionGoal, PlaceTaskGoal, RobotEvent
from move_base_abstract.orders.dispatcher import Drive, GiveUp
from move_base_abstract.orders.policies import make_policy
from move_base_abstract.orders.settings import DISPATCHER_TABLE, DispatchSettings, settings_of

from ...clocks.timing import make_timing
from ...fleet.fleet_scenario import INLINE, given_scenario
from ...messages import conversions, orders, packing
from ...messages.outlets import Outlet
from ...process.node_process import parse_no_arguments, run_node
from ...process.own_parameters import own_values
from ...robot.events_topic import EventsTopic
from ...robot.work_server import ACTION as WORK

_CONNECT_SECONDS = 30.0  # for the clock's wait_until: wall time, or simulated time in lockstep
_QUEUE_SIZE = 1000
_MOST_TOLD = 3  # orders in the reason of a run's end


def _topics(value):
    if not isinstance(value, list) or not value:
        raise ValueError
    return [TOPIC(one) for one in value]


_TABLE = (
    Parameter('scenario', '', string('the path of a scenario file')),
    Parameter('events', ['fleet/events'], _topics, allowed='a list of topics'),
    Parameter('orders_topic', 'orders', TOPIC),
    *(replace(one, default=None) for one in DISPATCHER_TABLE),
)


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter or the scenario cannot be used."""
    parse_no_arguments('dispatcher', __doc__)
    run_node('dispatcher', _build)


def _build():
    where = rospy.get_name()
    raw, values = own_values(_TABLE, INLINE)
    scenario = given_scenario(raw, values, INLINE, where)
    if not scenario.robots:
        raise ConfigurationError('parameter {}/robots: got none; allowed: at least one, here or in the '
                                 'scenario'.format(where))
    given = {one.name: values[one.name] for one in DISPATCHER_TABLE if values[one.name] is not None}
    settings = settings_of({**asdict(scenario.dispatcher or DispatchSettings()), **given}, where)
    check_levels(scenario, settings, where)
    policy = make_policy(settings.policy, where)
    clock = make_timing().make_clock()
    if not clock.start():
        return None
    node = DispatcherNode(clock, scenario, settings, policy, values)
    clock.serve()
    return node


class DispatcherNode:
    """Connects topics with the core's :class:`.Dispatcher`."""

    def __init__(self, clock, scenario, settings, policy, values):
        self._clock = clock
        self._frame = str(scenario.defaults.get('global_frame', 'map'))
        self._places = scenario.places or {}
        self._in_frame = packing.InFrame(self._frame)
        self._record = EventsTopic(clock).record(0)
        self._decisions = Decisions(scenario, settings, policy, clock.simulation.queue, 0, self._tell, self._act,
                                    lambda error: rospy.logerr('%s: %s', rospy.get_name(), error))
        self._core = self._decisions.core
        self._goals = {spec.name: _Goals(
            spec, bool(scenario.zones) or getattr(spec.settings.network, 'has_capacities', False),
            settings.charge_reserve is not None or spec.settings.failures is not None
            or spec.settings.buggify is not None) for spec in scenario.robots}
        heard = [rospy.Subscriber(one, RobotEvent, self._on_event, queue_size=_QUEUE_SIZE, tcp_nodelay=True)
                 for one in values['events']]
        clock.wait_until(lambda: all(one.get_num_connections() for one in heard)
                         and all(goals.are_heard() for goals in self._goals.values()), _CONNECT_SECONDS, 'the robots')
        if not all(goals.are_heard() for goals in self._goals.values()):
            rospy.logwarn('%s: not all robots of the scenario are there: goals of a missing robot are lost',
                          rospy.get_name())
        self._order_topic = rospy.Subscriber(values['orders_topic'], Order, self._on_order, queue_size=_QUEUE_SIZE,
                                             tcp_nodelay=True)
        clock.owe(self._undone)
        with clock.lock:
            self._decisions.soon(clock.now_ns())

    def _undone(self):
        texts = list(self._core.undone())
        return 'waits for the end of orders: {}{}'.format(
            '; '.join(texts[:_MOST_TOLD]), '; ...' if len(texts) > _MOST_TOLD else '') if texts else ''

    def _on_order(self, message):
        with self._clock.lock:
            now_ns = self._present()
            try:
                order = orders.from_order(message, self._frame, self._places, now_ns)
            except ValueError as error:
                self._core.refuse(message.id, str(error))
                return
            self._core.arrived(order, now_ns)
            self._decisions.soon(now_ns)

    def _on_event(self, message):
        if not self._core.hears(message.robot, message.kind):
            return
        with self._clock.lock:
            now_ns = self._present()
            if message.kind == 'battery':
                values = [*message.numbers, *message.texts]
            else:
                values = [*message.texts, *message.numbers]
            warning = self._core.happened(message.robot, message.kind, values)
            if warning is not None:
                rospy.logwarn('%s: %s: %s', rospy.get_name(), message.robot, warning)
            self._decisions.soon(now_ns)

    def _present(self):
        """Return the present time [ns]. If a decision is due now, it stays due: it is made after all messages."""
        return self._clock.simulation.now_ns if self._decisions.is_due else self._clock.now_ns()

    def _act(self, commands, now_ns):
        for command in commands:
            self._goals[command.robot].do(command, self._in_frame, self._frame, now_ns)

    def _tell(self, row):
        self._record((self._clock.simulation.now_ns, *row))
        if row[1] == 'order_refused':
            rospy.logwarn('%s: order %s is refused: %s', rospy.get_name(), *row[2:])
        elif row[1] == 'policy_failed':
            rospy.logerr('%s: %s', rospy.get_name(), row[2])


class _Goals:
    """The topics by which one robot gets its goals, and its priority if it ``may_wait`` for zones or lanes.

    ``may_lose``: whether the dispatcher may take its order from it.
    """

    def __init__(self, spec, may_wait, may_lose):
        self._priority = rospy.Publisher('{}/move_base/priority'.format(spec.name), Int32, queue_size=10,
                                         tcp_nodelay=True) if may_wait else None
        self._drive = Outlet('{}/move_base/goal'.format(spec.name), MoveBaseActionGoal, _QUEUE_SIZE, tcp_nodelay=True)
        self._work = Outlet('{}/{}/goal'.format(spec.name, WORK), PlaceTaskActionGoal, _QUEUE_SIZE, tcp_nodelay=True)
        self._cancels = {is_work: rospy.Publisher('{}/{}/cancel'.format(spec.name, action), GoalID, queue_size=10,
                                                  tcp_nodelay=True)
                         for is_work, action in ((False, 'move_base'), (True, WORK))} if may_lose else {}

    def are_heard(self):
        """Return whether the robot listens to all these topics."""
        return bool(self._drive.is_heard() and self._work.is_heard()
                    and all(one.get_num_connections() for one in self._cancels.values()))

    def do(self, command, in_frame, frame, now_ns):
        """Carry out a command of the core: a GiveUp, a Drive or a task at a place."""
        if isinstance(command, GiveUp):
            if self._cancels:
                self._cancels[command.is_work].publish(GoalID(id=command.goal_id))
        elif isinstance(command, Drive):
            pose = command.pose
            if command.priority is not None and self._priority is not None:
                self._priority.publish(command.priority)
            target = in_frame.target(pose.x, pose.y, pose.yaw)
            self._drive.send(lambda seq: packing.action_goal(seq, command.goal_id, now_ns, target))
        else:
            message = PlaceTaskActionGoal(goal=PlaceTaskGoal(orders.to_task(command.task, frame, now_ns)))
            message.header.stamp = conversions.to_time(now_ns)
            message.goal_id = GoalID(conversions.to_time(now_ns), command.goal_id)
            self._work.send(packing.of_message(message))
