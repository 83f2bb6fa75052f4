"""The node ``mapf_drive``: makes the robots of a fleet drive the plan of a MAPF solver, move by move.

It hears events of robots and sends goals. It uses topics and actions only. The class :class:`.Execution` decides which
robot may move, as in plain Python.
"""
import itertools

import rospy
from move_base_msgs.msg import MoveBaseActionGoal

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import TOPIC, one_of, string
from move_base_abstract.common.parameter_table import Parameter
from move_base_abstract.msg import RobotEvent
from move_base_abstract_mapf.driving import check_starts
from move_base_abstract_mapf.execution import ORDER_KEPT, POLICIES, Execution
from move_base_abstract_mapf.layout import read_folder
from move_base_abstract_mapf.plans import read_plan

from ...clocks.timing import make_timing
from ...messages import packing
from ...messages.outlets import Outlet
from ...process.node_process import parse_no_arguments, run_node
from ...process.own_parameters import own_values

_CONNECT_SECONDS = 30.0  # for the clock's wait_until: wall time, or simulated time in lockstep
_QUEUE_SIZE = 1000
_TABLE = (
    Parameter('folder', '', string('the path of a folder that mapf import made')),
    Parameter('plan', '', string('the path of a plan')),
    Parameter('policy', ORDER_KEPT, one_of(*POLICIES), allowed=', '.join(POLICIES)),
    Parameter('events', 'fleet/events', TOPIC),
)


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter or the plan cannot be used."""
    parse_no_arguments('mapf_drive', __doc__)
    run_node('mapf_drive', _build)


def _build():
    _, values = own_values(_TABLE)
    for name in ('folder', 'plan'):
        if not values[name]:
            raise ConfigurationError('parameter {}/{}: got none; allowed: {}'.format(
                rospy.get_name(), name, next(one.allowed for one in _TABLE if one.name == name)))
    site = read_folder(values['folder'])
    plan = read_plan(values['plan'], site.grid.blocked)
    check_starts(plan, site)
    clock = make_timing().make_clock()
    if not clock.start():
        return None
    node = PlanNode(clock, site, plan, values)
    clock.serve()
    return node


class PlanNode:
    """Connects topics with an Execution."""

    def __init__(self, clock, site, plan, values):
        self._clock = clock
        self._grid, self._step_ns = site.grid, site.step_ns
        self._names = [spec.name for spec in site.scenario.robots]
        self._numbers = {name: number for number, name in enumerate(self._names)}
        self._goal_numbers = [itertools.count(1) for _ in self._names]
        self._in_frame = packing.InFrame(str(site.scenario.defaults.get('global_frame', 'map')))
        self._goals = [Outlet('{}/move_base/goal'.format(name), MoveBaseActionGoal, _QUEUE_SIZE, tcp_nodelay=True)
                       for name in self._names]
        self._execution = None
        events = rospy.Subscriber(values['events'], RobotEvent, self._on_event, queue_size=_QUEUE_SIZE,
                                  tcp_nodelay=True)

        def are_there():
            return bool(events.get_num_connections()) and all(outlet.is_heard() for outlet in self._goals)
        clock.wait_until(are_there, _CONNECT_SECONDS, 'the robots')
        if not are_there():
            rospy.logwarn('%s: not all robots of the plan are there: goals of a missing robot are lost',
                          rospy.get_name())
        with clock.lock:
            self._execution = Execution(plan, values['policy'], clock.now_ns(), site.step_ns, self._send)
            for instant_ns in self._execution.instants_ns:
                self._look_at(instant_ns)

    def _look_at(self, instant_ns):
        self._clock.simulation.queue.schedule(instant_ns, 0, lambda due_ns, _now_ns: self._execution.look(due_ns))

    def _on_event(self, message):
        if self._execution is None or message.robot not in self._numbers or not _is_end(message):
            return
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            has_arrived = message.texts[1] == 'SUCCEEDED'
            self._execution.ended(self._numbers[message.robot], has_arrived, now_ns)
            if not has_arrived:
                self._look_at(now_ns + self._step_ns)
            self._execution.look(now_ns)
            if self._execution.is_over:
                rospy.loginfo('%s: all robots have come to their goals', rospy.get_name())

    def _send(self, robot, cell, towards):
        goal_id = '{}-{}'.format(self._names[robot], next(self._goal_numbers[robot]))
        target, now_ns = self._in_frame.target(*self._grid.pose(cell, towards)), self._clock.simulation.now_ns
        self._goals[robot].send(lambda seq: packing.action_goal(seq, goal_id, now_ns, target))


def _is_end(message):
    """Return whether a RobotEvent is the end of a goal, in the form that robots use: any node may publish others."""
    return message.kind == 'ended' and len(message.texts) == 3
