"""The node ``soil_coordinator``: an ordinary user's node that has robots map the compaction of a field.

It works with any robots that have an action server <robot>/move_base, and <robot>/<task> for the sampling. The
parameters of the mission are those of soil_mapping.config.TrialConfig, with the same names; see docs/soil_study_ros.md.
"""
from __future__ import annotations

import contextlib
import queue
import sys
import time
from typing import Any

import rospy

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.ros_names import NAMESPACE_RULE, is_namespace
from move_base_abstract.common.shown import shown
from move_base_abstract_ros import lockstep
from move_base_abstract_ros.process.clock_watch import watch_clock
from move_base_abstract_ros.process.node_process import parse_no_arguments, tell_error
from move_base_abstract_ros.process.process_end import ProcessEnd
from move_base_abstract_ros.replacing import rospy_start
from move_base_abstract_ros.replacing.bulk_registration import bulk_registration
from move_base_abstract_ros.replacing.log_files import survive_full_disk
from move_base_abstract_ros.time_master_client import TimeMasterClient
from soil_mapping.config import TrialConfig
from soil_mapping.ground_truth.field import field_of
from soil_mapping.ground_truth.inputs import inputs_of
from soil_mapping.mission.coordinator import Coordinator
from soil_mapping.results.result import collect
from soil_mapping.results.trial_folder import TrialFolder
from soil_mapping.stopwatch import Stopwatch

from .mission_run import MissionFailed, MissionRun
from .robot_link import RobotLink
from .views import Views

OWN_PARAMETERS = ('seed', 'names', 'task', 'pose_topic', 'hold', 'output', 'pictures', 'variance_frame',
                  'stay', 'lockstep_rank', 'lockstep_charge')


def main() -> None:
    """Run one mission. Exit with 0 when it is over, or with 1 if it could not be carried out."""
    began = time.perf_counter()
    parse_no_arguments('soil_coordinator', __doc__)
    end = ProcessEnd('soil_coordinator')
    try:
        survive_full_disk()
        rospy_start.prepare()
        rospy.init_node('soil_coordinator')
        _run(began)
    except (SimulatorError, MissionFailed) as error:
        rospy.logfatal('%s: %s', rospy.get_name(), error)
        sys.exit(1)
    except Exception as error:
        if end.asked.is_set():  # a wait of the mission has ended because ROS ends
            return
        sys.exit(tell_error('soil_coordinator', error))


def _run(began: Any) -> None:
    """Run the mission that the parameters describe."""
    raw = rospy.get_param('~', {})
    config = TrialConfig.from_dict({key: value for key, value in raw.items() if key not in OWN_PARAMETERS})
    names = _names(raw.get('names'), config.robots)
    stopwatch = Stopwatch()
    inputs = inputs_of(config.field)
    truth = field_of(config)
    rospy.loginfo('%s: field %s', rospy.get_name(), truth.about)
    coordinator = Coordinator(config, raw.get('seed', 0), truth, stopwatch)
    with TrialFolder(raw['output']) if raw.get('output') else contextlib.nullcontext() as folder:
        _carry_out(coordinator, stopwatch, names, raw, began, inputs, folder)
    if raw.get('stay', False):
        rospy.spin()  # so that its maps can still be seen


def _names(raw: Any, count: int) -> Any:
    """Return the robots' namespaces. :raises ConfigurationError: if names are not allowed, or not ``count`` of them."""
    names = raw or [f'robot_{index}' for index in range(count)]
    if not isinstance(names, list) or not all(is_namespace(name) for name in names) or len(
            {name.strip('/') for name in names}) < len(names):
        raise ConfigurationError(f'parameter {rospy.resolve_name("~names")}: got {shown(names)}; allowed: a list of '
                                 f'different namespaces: {NAMESPACE_RULE}')
    if len(names) != count:
        raise ConfigurationError(f'parameter {rospy.resolve_name("~names")}: got {len(names)} names for {count} robots')
    return names


def _carry_out(coordinator: Any, stopwatch: Any, names: Any, raw: Any, began: Any, inputs: Any, folder: Any) -> None:
    """Run the mission and write its TrialFolder, if there is one."""
    ready = time.perf_counter()
    run = run_mission(coordinator, names, raw.get('task', 'take_sample'),
                      raw.get('pose_topic', 'base_pose_ground_truth'), stopwatch)
    stopwatch.seconds.update(mission=run.wall_s, start_up=ready - began)
    engine = {'name': 'ros', 'clock': rospy.get_param('/time_master/mode', 'machine')}
    result = collect(coordinator, engine, stopwatch.seconds, run.wall_s, inputs)
    rospy.loginfo('%s: %s', rospy.get_name(), result.metrics)
    if folder is not None:
        folder.finish(result, raw.get('pictures', True))


def run_mission(coordinator: Any, names: Any, task: Any, pose_topic: Any, stopwatch: Any, check: Any = lambda: None,
                before: Any = lambda: None) -> Any:
    """Run a mission to its end in this process, whose node is initialised; return the MissionRun.

    names: the robots' namespaces. task: name of the sampling action below each. pose_topic: topic of nav_msgs/Odometry
    below each, in the map frame. check: called repeatedly while waiting for the robots; it may raise. before: called
    before the mission; in lockstep time stands still meanwhile.
    """
    participant = lockstep.join()
    if participant is None:
        watch_clock()
    events: Any = queue.Queue()  # made after joining, so that lockstep handles its locks
    frame = rospy.get_param('~variance_frame', 'map')
    with bulk_registration():
        robots = [RobotLink(index, name, task, pose_topic, events) for index, name in enumerate(names)]
        views = Views(coordinator, frame)

    def show() -> None:
        with stopwatch.phase('maps'):
            views.refresh()
    run = MissionRun(coordinator, robots, events, computing(participant), show)
    rospy.on_shutdown(run.shut_down)
    run.wait_until_ready(participant, check)
    run.go_to_start()
    before()
    coordinator.truth.values  # noqa: B018 - if it is not drawn yet, this draws it, outside of the measured time
    run.run()
    return run


HOLD_TIMEOUT_S = 60.0  # wall; no computation takes that long


def computing(participant: Any) -> Any:
    """Return a function that makes a context manager for the time during which the mission computes.

    ``participant`` is the value that lockstep.join has returned.
    """
    mode = rospy.get_param('/time_master/mode', None)
    if participant is not None or mode is None or not rospy.get_param('~hold', True):
        return contextlib.nullcontext
    client = TimeMasterClient()
    return lambda: client.hold(rospy.get_name(), HOLD_TIMEOUT_S)
