"""The node ``task_server``: serves the action TimedTask for some robots, and with places the action PlaceTask too."""
import time

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.node_tables import TASK_SERVER
from move_base_abstract.fleet.robot_rows import write
from move_base_abstract.goals.events import robot_stream
from move_base_abstract.goals.outcome import NODE_KILLED
from move_base_abstract.scenario import make_scenario, read_scenario
from move_base_abstract.tasks.room import Rooms
from move_base_abstract.tasks.timed_task import DrawnDurations

from .. import lockstep
from ..clocks.timing import make_timing
from ..process.node_process import parse_no_arguments, run_node
from ..process.own_parameters import own_values
from ..replacing.bulk_registration import bulk_registration
from ..robot.host import Host
from ..robot.task_server import TaskServer
from ..robot.work_server import ACTION as WORK, WorkServer

_LAST_WORDS_SECONDS = 0.1


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter cannot be used."""
    parse_no_arguments('task_server', __doc__)
    run_node('task_server', _build, _say_goodbye)


def _build():
    """Read the parameters, wait for the clock, and return the servers; None if ROS shuts down meanwhile."""
    where = rospy.get_name()
    raw, values = own_values(TASK_SERVER, ('places',))
    timing = make_timing()
    clock = timing.make_clock()
    try:
        durations = [DrawnDurations(values['duration'], values['spread'], values['seed'], index)
                     for index in range(len(values['robots']))]
    except ValueError as error:
        raise ConfigurationError('parameter {}/spread: {}'.format(where, error)) from None
    scenario = _read_places(raw, values, where)
    if not clock.start():
        return None
    if values['feedback_freq'] is None:
        values['feedback_freq'] = timing.task_feedback_frequency
    host = Host(clock, timing)
    with bulk_registration():
        servers = [TaskServer(_below(robot, values['task']), host, index, durations[index], values['feedback_freq'],
                              values['min_answer_delay']) for index, robot in enumerate(values['robots'])]
        if scenario.places is not None:
            servers += _work_servers(host, values, scenario)
    clock.serve()
    return servers


def _below(robot, name_):
    return rospy.resolve_name('/'.join(part for part in (robot, name_) if part))


def _read_places(raw, values, where):
    """Return the scenario that holds the places: of the file, of the parameter ``places``, or an empty one."""
    if values['scenario'] and 'places' in raw:
        raise ConfigurationError('parameters {0}/scenario and {0}/places: only one of them may be given'.format(where))
    if values['scenario']:
        return read_scenario(values['scenario'])
    return make_scenario({'places': raw['places']} if 'places' in raw else {}, where)


def _work_servers(host, values, scenario):
    """Return the servers of tasks at places, for robots that another node moves."""
    rooms = Rooms(host.clock.simulation, scenario.places)
    settings = {**values, 'frame': str(scenario.defaults.get('global_frame', 'map'))}
    servers = []
    for index, robot in enumerate(values['robots']):
        with lockstep.sender(index):
            stream = robot_stream()
            write(stream, 'trace', host.events.record(index))
            servers.append(WorkServer(_below(robot, WORK), robot.strip('/'), index, host, rooms, settings, stream))
    return servers


def _say_goodbye(servers):
    for server in servers:
        server.shut_down(NODE_KILLED)
    time.sleep(_LAST_WORDS_SECONDS)  # rospy closes connections at once, even if messages are still queued on them
