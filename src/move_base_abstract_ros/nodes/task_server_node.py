"""The node ``task_server``: the action TimedTask for some robots, in one process."""
import sys
import time

import rospy

from move_base_abstract.errors import ConfigurationError
from move_base_abstract.parameter_table import Parameter, integer, name, number, read_table, unknown_names
from move_base_abstract.timed_task import DrawnDurations

from ..bulk_registration import bulk_registration
from ..host import Host, read_action_options
from ..ros_clock import make_clock
from ..task_server import TaskServer
from .move_base_node import LOCKSTEP_PARAMETERS, away_from_signals

_LAST_WORDS_SECONDS = 0.1


def _names(value):
    if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
        raise ValueError
    if len(set(value)) < len(value):
        raise ValueError
    return value


_SECONDS = 'a finite number >= 0 [s, simulated]'
_TABLE = (
    Parameter('robots', [''], _names, 'a list of different namespaces'),
    Parameter('task', 'timed_task', name, 'the name of the action below each namespace'),
    Parameter('duration', 1.0, number(low=0.0), _SECONDS),
    Parameter('spread', 0.0, number(low=0.0), _SECONDS + ', not more than the duration'),
    Parameter('seed', 0, integer(0), 'a whole number >= 0'),
    Parameter('feedback_freq', None, number(0.0, 1000.0), 'a number in 0..1000 [Hz, simulated], 0 = none'),
    Parameter('min_answer_delay', 0.02, number(0.0, 1.0), 'a number in 0..1 [s, wall]'),
)


def main():
    """Run the node until ROS shuts down; exits with 1 when a parameter cannot be used."""
    rospy.init_node('task_server')
    try:
        servers = away_from_signals(_build)
    except ConfigurationError as error:
        rospy.logfatal('%s: %s', rospy.get_name(), error)
        sys.exit(1)
    if servers is not None:
        rospy.on_shutdown(lambda: _say_goodbye(servers))
        rospy.spin()


def _build():
    """Read the parameters, wait for the clock, and return the TaskServer objects."""
    where = rospy.get_name()
    raw = rospy.get_param(where, {})
    values = read_table(raw, _TABLE, where)
    for warning in unknown_names(raw, tuple(row.name for row in _TABLE) + LOCKSTEP_PARAMETERS, where):
        rospy.logwarn(warning)
    clock = make_clock()
    try:
        durations = [DrawnDurations(values['duration'], values['spread'], values['seed'], index)
                     for index in range(len(values['robots']))]
    except ValueError as error:
        raise ConfigurationError('parameter {}/spread: {}'.format(where, error)) from None
    if not clock.start():
        return None
    if values['feedback_freq'] is None:
        values['feedback_freq'] = 0.0 if clock.is_lockstep else 5.0
    host = Host(clock, read_action_options(clock.is_lockstep))
    with bulk_registration():
        servers = [TaskServer(rospy.resolve_name('/'.join(part for part in (robot, values['task']) if part)), host,
                              index, durations[index], values['feedback_freq'], values['min_answer_delay'])
                   for index, robot in enumerate(values['robots'])]
    clock.serve()
    return servers


def _say_goodbye(servers):
    for server in servers:
        server.shut_down()
    time.sleep(_LAST_WORDS_SECONDS)  # rospy closes connections at once, whatever is still queued on them
