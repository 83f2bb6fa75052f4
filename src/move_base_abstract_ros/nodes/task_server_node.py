"""The node ``task_server``: the tasks of robots that another program moves, by the action PlaceTask."""
import time

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.node_tables import TASK_SERVER, TASK_SERVER_INLINE
from move_base_abstract.engine.factors import Even
from move_base_abstract.fleet.robot_rows import write
from move_base_abstract.goals.events import robot_stream
from move_base_abstract.goals.outcome import NODE_KILLED
from move_base_abstract.tasks.room import Rooms

from .. import lockstep
from ..clocks.timing import make_timing
from ..fleet.fleet_scenario import given_scenario
from ..process.node_process import parse_no_arguments, run_node
from ..process.own_parameters import own_values
from ..replacing.bulk_registration import bulk_registration
from ..robot.host import Host
from ..robot.work_server import WorkServer

_INLINE = tuple(parameter.name for parameter in TASK_SERVER_INLINE)
_LAST_WORDS_SECONDS = 0.1


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter cannot be used."""
    parse_no_arguments('task_server', __doc__)
    run_node('task_server', _build, _say_goodbye)


def _build():
    """Read the parameters, wait for the clock, and return the servers; None if ROS shuts down meanwhile."""
    where = rospy.get_name()
    raw, values = own_values(TASK_SERVER, _INLINE)
    timing = make_timing()
    clock = timing.make_clock()
    if values['spread'] > values['duration']:
        raise ConfigurationError('parameter {}/spread: got {:g}; allowed: at most the duration, {:g}'.format(
            where, values['spread'], values['duration']))
    scenario = given_scenario(raw, values, _INLINE, where)
    if not clock.start():
        return None
    if values['feedback_freq'] is None:
        values['feedback_freq'] = timing.task_feedback_frequency
    values['frame'] = str(scenario.defaults.get('global_frame', 'map'))
    host = Host(clock, timing)
    rooms = Rooms(clock.simulation, scenario.places or {}, Even(values['duration'], values['spread']))
    with bulk_registration():
        servers = [_server(host, rooms, values, index, robot) for index, robot in enumerate(values['robots'])]
    clock.serve()
    return servers


def _server(host, rooms, values, index, robot):
    """Return the server of a robot's tasks. Another program moves the robot, so nobody here knows where it stands."""
    with lockstep.sender(index):
        stream = robot_stream()
        write(stream, 'trace', host.events.record(index))
        ns = rospy.resolve_name('/'.join(part for part in (robot, values['task']) if part))
        name = robot.strip('/') or rospy.get_namespace().strip('/') or rospy.get_name().strip('/')
        server = WorkServer(ns, name, index, host, rooms, values, stream)
    host.robot_count += 1
    return server


def _say_goodbye(servers):
    for server in servers:
        server.shut_down(NODE_KILLED)
    time.sleep(_LAST_WORDS_SECONDS)  # rospy closes connections at once, even if messages are still queued on them
