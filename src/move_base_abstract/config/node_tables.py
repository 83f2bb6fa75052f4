"""The parameters of the nodes, except those of a robot. The checks and the pages of the nodes use these tables."""
from __future__ import annotations

from typing import List

from ..common.kinds import ANY, BELOW_ROOT, FLAG, FRAME, PATH, integer, number, string
from ..common.parameter_table import Parameter
from ..common.ros_names import NAMESPACE_RULE, is_namespace

MAX_ROBOTS = 100_000  # in a scenario; the most that have been driven so far are ten thousand

def _names(value: object) -> List[str]:
    if not isinstance(value, list) or not all(is_namespace(item) for item in value):
        raise ValueError
    if len({item.strip('/') for item in value}) < len(value) or len(value) > MAX_ROBOTS:
        raise ValueError
    return value


def _task(value: object) -> str:
    if not is_namespace(BELOW_ROOT(value)):
        raise ValueError
    return str(BELOW_ROOT(value))


MAX_SECONDS = 2.0 ** 31 - 1.0  # the longest duration in ROS
_PATH = 'the path of a scenario file'

STATUS_FREQUENCY = 'actionlib_status_frequency'
ACTIONLIB = (
    Parameter('actionlib_server_pub_queue_size', 50, integer(-1),
              "Queue of actionlib's publishers, found in the node's namespace; 0 and -1 stand for 50."),
    Parameter('actionlib_server_sub_queue_size', 50, integer(-1),
              "Queue of actionlib's subscribers, found in the node's namespace; 0 and -1 stand for 50."),
    Parameter(STATUS_FREQUENCY, 5.0, number(0.0, unit='Hz, simulated'),
              'Rate at which the status is repeated; a namespace above counts, too. 0: only on transitions. With '
              '`events_only` it is 0.'),
)
#: the keys of a scenario that may be parameters of a node instead; they are checked like those in the file
INLINE = {parameter.name: parameter for parameter in (
    Parameter('defaults', None, ANY, 'Settings of every robot.', 'a mapping of settings of every robot'),
    Parameter('robots', None, ANY, 'The robots, in the order of their indices.', 'a list of robots'),
    Parameter('zones', None, ANY, 'Named areas.', 'a list of zones'),
    Parameter('deadlock', 'wait', string("'wait', 'abort', 'avoid' or 'retreat'"),
              'What happens to robots that wait for one another.'),
    Parameter('blocks', 1, ANY, 'Number of areas ahead that must have room.', 'a whole number in 1..100'),
    Parameter('lane_price', 0.0, ANY,
              'Weight of robots in the way when a robot chooses its way.', 'a number in 0..1000'),
    Parameter('groups', None, ANY,
              'Number of places of each group of areas.', 'a mapping of names to whole numbers >= 1'),
    Parameter('encounters', 'none', string("'calibrated' or 'none'"), 'Whether robots meet.'),
    Parameter('lanes', None, PATH, 'The net of lanes of all robots.'),
    Parameter('travel_matrix', None, PATH, 'The table of travel times of all robots.'),
    Parameter('places', None, ANY, 'Places where robots work.', 'a list of places'),
    Parameter('arrivals', None, ANY, 'Tasks that arrive.', 'a list of arrivals'),
    Parameter('orders', None, ANY, 'Orders that arrive.', 'a list of entries'),
    Parameter('dispatcher', None, ANY, 'Which robot gets which order, and when robots charge.', 'a mapping'),
)}
FLEET = (
    Parameter('scenario', '', string(_PATH), 'The scenario; its keys may be parameters of the node instead.'),
    Parameter('part', 0, integer(0), 'This process hosts this share of the robots.', 'a whole number >= 0 and < parts'),
    Parameter('parts', 1, integer(1), 'Number of shares, one for each process.'),
    Parameter('use_map', None, FLAG, "Replaces the defaults' `use_map`."),
    Parameter('backend', None, string('the name of a backend'), "Replaces the defaults' `backend`."),
    Parameter('seed', None, integer(0), "Replaces the scenario's `seed`."),
)
FLEET_INLINE = tuple(parameter for name_, parameter in INLINE.items()
                     if name_ not in ('arrivals', 'orders'))
TASK_SERVER = (
    Parameter('robots', [''], _names,
              'Namespaces of robots; each gets an action of its own.',
              'a list of different namespaces: ' + NAMESPACE_RULE),
    Parameter('scenario', '', string(_PATH), 'A scenario with places, or the parameter `places`.'),
    Parameter('task', 'work', _task,
              'Name of the action.', 'the name of the action below each namespace: ' + NAMESPACE_RULE),
    Parameter('duration', 1.0, number(0.0, MAX_SECONDS, unit='s, simulated'),
              'Duration of a task that has none, at a place that has none.'),
    Parameter('spread', 0.0, number(0.0, MAX_SECONDS, unit='s, simulated', note='not more than the duration'),
              'Durations are drawn evenly from `duration` - `spread` to `duration` + `spread`.'),
    Parameter('seed', 0, integer(0), 'Seed of these draws; each robot has a generator of its own.'),
    Parameter('feedback_freq', None, number(0.0, 1000.0, unit='Hz, simulated', note='0 = none'),
              'Rate of the feedback. If it is not set, it is 5; in lockstep with `events_only` it is 0.'),
    Parameter('min_answer_delay', 0.02, number(0.0, 1.0, unit='s, wall'),
              'The end of a goal is published no sooner than this after the goal came; not used in lockstep.'),
)
TASK_SERVER_INLINE = (INLINE['places'],)
TASK_SOURCE = (
    Parameter('scenario', '', string(_PATH),
              'The scenario; `places`, `arrivals` and `orders` may be parameters instead.'),
    Parameter('seed', None, integer(0), "Replaces the scenario's `seed`."),
    Parameter('topic', 'tasks', BELOW_ROOT, 'Topic of the tasks.'),
    Parameter('orders_topic', 'orders', BELOW_ROOT, 'Topic of the orders.'),
    Parameter('wait_for_listener', True, FLAG,
              'If true, the time of arrivals begins when a node subscribes (in lockstep: a participant). If false, it '
              'begins at once.'),
)
TASK_SOURCE_INLINE = (INLINE['places'], INLINE['arrivals'], INLINE['orders'])
MAP_FRAME = Parameter('frame_id', 'map', FRAME, 'Frame of the map.')
MAP_IMAGE = Parameter('image', None, PATH, 'The image, in the place of that in the YAML file.')
#: parameters that are read with the old form of map_server's command line
MAP_OLD_FORM = (
    Parameter('negate', 0, integer(0),
              'Meaning of shades; only with the old form of the command line.',
              'a whole number >= 0; 0 = white is free'),
    Parameter('occupied_thresh', 0.65, number(), 'A cell with more occupancy is occupied; only with the old form.'),
    Parameter('free_thresh', 0.196, number(), 'A cell with less occupancy is free; only with the old form.'),
)
