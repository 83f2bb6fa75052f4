"""The parameters of the nodes, except those of a robot. The checks and the pages of the nodes use these tables."""
from __future__ import annotations

from typing import List

from ..common.parameter_table import Parameter, boolean, integer, name, number, text
from ..common.ros_names import NAMESPACE_RULE, is_namespace

MAX_ROBOTS = 100_000  # in a scenario; the most that have been driven so far are ten thousand

def _names(value: object) -> List[str]:
    if not isinstance(value, list) or not all(is_namespace(item) for item in value):
        raise ValueError
    if len({item.strip('/') for item in value}) < len(value) or len(value) > MAX_ROBOTS:
        raise ValueError
    return value


def _task(value: object) -> str:
    if not is_namespace(name(value)):
        raise ValueError
    return name(value)


def _as_it_is(value: object) -> object:
    return value


MAX_SECONDS = 2.0 ** 31 - 1.0  # the longest duration in ROS
_SEED = 'a whole number >= 0'
_PATH = 'the path of a scenario file'
_SECONDS = 'a number in 0..{:.0f} [s, simulated]'.format(MAX_SECONDS)

STATUS_FREQUENCY = 'actionlib_status_frequency'
ACTIONLIB = (
    Parameter('actionlib_server_pub_queue_size', 50, integer(-1), 'a whole number >= -1',
              "Queue of actionlib's publishers, found in the node's namespace; 0 and -1 stand for 50."),
    Parameter('actionlib_server_sub_queue_size', 50, integer(-1), 'a whole number >= -1',
              "Queue of actionlib's subscribers, found in the node's namespace; 0 and -1 stand for 50."),
    Parameter(STATUS_FREQUENCY, 5.0, number(0.0), 'a number >= 0 [Hz, simulated]',
              'Rate at which the status is repeated; a namespace above counts, too. 0: only on transitions. With '
              '`events_only` it is 0.'),
)
#: the keys of a scenario that may be parameters of a node instead; they are checked like those in the file
INLINE = {parameter.name: parameter for parameter in (
    Parameter('defaults', None, _as_it_is, 'a mapping of settings of every robot', 'Settings of every robot.'),
    Parameter('robots', None, _as_it_is, 'a list of robots', 'The robots, in the order of their indices.'),
    Parameter('zones', None, _as_it_is, 'a list of zones', 'Named areas.'),
    Parameter('deadlock', 'wait', text, "'wait', 'abort', 'avoid' or 'retreat'",
              'What happens to robots that wait for one another.'),
    Parameter('blocks', 1, _as_it_is, 'a whole number in 1..100',
              'Number of areas ahead that must have room.'),
    Parameter('lane_price', 0.0, _as_it_is, 'a number in 0..1000',
              'Weight of robots in the way when a robot chooses its way.'),
    Parameter('groups', None, _as_it_is, 'a mapping of names to whole numbers >= 1',
              'Number of places of each group of areas.'),
    Parameter('encounters', 'none', text, "'calibrated' or 'none'", 'Whether robots meet.'),
    Parameter('lanes', None, text, 'the path of a file', 'The net of lanes of all robots.'),
    Parameter('travel_matrix', None, text, 'the path of a file', 'The table of travel times of all robots.'),
    Parameter('places', None, _as_it_is, 'a list of places', 'Places where robots work.'),
    Parameter('arrivals', None, _as_it_is, 'a list of arrivals', 'Tasks that arrive.'),
    Parameter('orders', None, _as_it_is, 'a list of entries', 'Orders that arrive.'),
    Parameter('dispatcher', None, _as_it_is, 'a mapping', 'Which robot gets which order, and when robots charge.'),
)}
FLEET = (
    Parameter('scenario', '', text, _PATH, 'The scenario; its keys may be parameters of the node instead.'),
    Parameter('part', 0, integer(0), 'a whole number >= 0 and < parts', 'This process hosts this share of the robots.'),
    Parameter('parts', 1, integer(1), 'a whole number >= 1', 'Number of shares, one for each process.'),
    Parameter('use_map', None, boolean, 'true or false', "Replaces the defaults' `use_map`."),
    Parameter('backend', None, text, 'the name of a backend', "Replaces the defaults' `backend`."),
    Parameter('seed', None, integer(0), _SEED, "Replaces the scenario's `seed`."),
)
FLEET_INLINE = tuple(parameter for name_, parameter in INLINE.items()
                     if name_ not in ('arrivals', 'orders'))
TASK_SERVER = (
    Parameter('robots', [''], _names, 'a list of different namespaces: ' + NAMESPACE_RULE,
              'Namespaces of robots; each gets an action of its own.'),
    Parameter('scenario', '', text, _PATH, 'A scenario with places, or the parameter `places`.'),
    Parameter('task', 'work', _task, 'the name of the action below each namespace: ' + NAMESPACE_RULE,
              'Name of the action.'),
    Parameter('duration', 1.0, number(0.0, MAX_SECONDS), _SECONDS,
              'Duration of a task that has none, at a place that has none.'),
    Parameter('spread', 0.0, number(0.0, MAX_SECONDS), _SECONDS + ', not more than the duration',
              'Durations are drawn evenly from `duration` - `spread` to `duration` + `spread`.'),
    Parameter('seed', 0, integer(0), _SEED, 'Seed of these draws; each robot has a generator of its own.'),
    Parameter('feedback_freq', None, number(0.0, 1000.0), 'a number in 0..1000 [Hz, simulated], 0 = none',
              'Rate of the feedback. If it is not set, it is 5; in lockstep with `events_only` it is 0.'),
    Parameter('min_answer_delay', 0.02, number(0.0, 1.0), 'a number in 0..1 [s, wall]',
              'The end of a goal is published no sooner than this after the goal came; not used in lockstep.'),
)
TASK_SERVER_INLINE = (INLINE['places'],)
TASK_SOURCE = (
    Parameter('scenario', '', text, _PATH,
              'The scenario; `places`, `arrivals` and `orders` may be parameters instead.'),
    Parameter('seed', None, integer(0), _SEED, "Replaces the scenario's `seed`."),
    Parameter('topic', 'tasks', name, 'a topic name', 'Topic of the tasks.'),
    Parameter('orders_topic', 'orders', name, 'a topic name', 'Topic of the orders.'),
    Parameter('wait_for_listener', True, boolean, 'true or false',
              'If true, the time of arrivals begins when a node subscribes (in lockstep: a participant). If false, it '
              'begins at once.'),
)
TASK_SOURCE_INLINE = (INLINE['places'], INLINE['arrivals'], INLINE['orders'])
MAP_FRAME = Parameter('frame_id', 'map', name, 'a frame name', 'Frame of the map.')
#: parameters that are read with the old form of map_server's command line
MAP_OLD_FORM = (
    Parameter('negate', 0, integer(0), 'a whole number >= 0; 0 = white is free',
              'Meaning of shades; only with the old form of the command line.'),
    Parameter('occupied_thresh', 0.65, number(), 'a finite number',
              'A cell with more occupancy is occupied; only with the old form.'),
    Parameter('free_thresh', 0.196, number(), 'a finite number',
              'A cell with less occupancy is free; only with the old form.'),
)
