"""One trial on ROS: a master of its own, time master, fleet and task server as children, the coordinator here."""

import os
import signal
import time

import rosgraph
import rospy

from move_base_abstract_ros.loopback import Loopback, LoopbackError
from soil_mapping.coordinator import Coordinator
from soil_mapping.grid import Grid
from soil_mapping.result import collect
from soil_mapping.ros.mission_run import MissionFailed
from soil_mapping.ros.nodes.coordinator_node import run_mission
from soil_mapping.sampling import start_places
from soil_mapping.stopwatch import Stopwatch

from .truth import truth_of

NODE = 'soil_coordinator'
TASK = 'take_sample'
POSE_TOPIC = 'base_pose_ground_truth'
BAG_TIMEOUT_S = 20.0  # wall


def run_ros_trial(spec, folder, bag=False):
    """Run the trial of a TrialSpec in this process, which can run no other, and return its TrialResult.

    folder: where event log, bag and a measured charge go (a Path). :raises LoopbackError, MissionFailed: if it fails.
    """
    stopwatch = Stopwatch()
    began = time.perf_counter()
    with Loopback() as ros:
        ros.adopt()
        names = [f'robot_{index}' for index in range(spec.config.robots)]
        _start_nodes(ros, spec, names, folder)
        if bag:
            recorder = _start_bag(ros, folder)
        coordinator = Coordinator(spec.config, spec.seed, truth_of(spec.config), stopwatch)
        rospy.init_node(NODE, disable_signals=True)
        try:
            run = run_mission(coordinator, names, TASK, POSE_TOPIC, stopwatch, ros.check)
        except rospy.ROSInterruptException:
            ros.check()
            raise MissionFailed('ROS was shut down during the mission') from None
        finally:
            rospy.signal_shutdown('the mission is over')
        if bag:
            _end_bag(recorder)
    seconds = dict(stopwatch.seconds, start_up=run.began - began, mission=run.wall_s,
                   end=time.perf_counter() - run.ended)
    inner = sum(seconds.get(name, 0.0) for name in ('kriging', 'allocation', 'maps'))
    return collect(coordinator, spec.about_engine, dict(seconds, messages=run.wall_s - inner), run.wall_s)


def _start_nodes(ros, spec, names, folder):
    """Start the nodes of a trial; they come up while this process goes on."""
    ros.run('time_master', 'time_master', parameters=_clock(spec, folder))
    config = spec.config
    places = start_places(config.robots, spec.seed, Grid.of_field(config.cell_m))
    ros.run('fleet', 'fleet', parameters={
        'defaults': {'max_speed': config.speed},
        'robots': [{'name': name, 'start_x': x, 'start_y': y} for name, (x, y) in zip(names, places, strict=True)]})
    ros.run('task_server', 'task_server', parameters={
        'robots': names, 'task': TASK, 'duration': config.dwell_s, 'spread': config.dwell_spread_s, 'seed': spec.seed})
    if spec.charge != 'none':
        kind, _, path = spec.charge.partition(':')
        if kind.startswith('measured') and not path:
            path = str(folder / 'charge.jsonl')
        ros.set_param(f'/{NODE}/lockstep_charge', ':'.join(part for part in (kind, path) if part))


def _clock(spec, folder):
    """Return the time master's parameters."""
    if spec.clock == 'scaled':
        return {'mode': 'scaled', 'factor': float(spec.factor)}
    return {'mode': 'lockstep', 'participants': ['/fleet', '/task_server', '/' + NODE], 'on_death': 'end',
            'speed_limit': float(spec.limit), 'event_log': str(folder / 'lockstep_events.jsonl')}


def _start_bag(ros, folder):
    """Record all topics to trial.bag; return the Child once it listens to the clock."""
    recorder = ros.spawn('/bag', ['rosbag', 'record', '--all', '--lz4', '-O', os.path.abspath(folder / 'trial.bag'),
                                  '__name:=bag'])
    master = rosgraph.Master('/study', master_uri=ros.uri)
    deadline = time.monotonic() + BAG_TIMEOUT_S
    while True:
        ros.check()
        subscribers = dict(master.getSystemState()[1])
        if '/bag' in subscribers.get('/clock', []):
            return recorder
        if time.monotonic() > deadline:
            raise LoopbackError(f'rosbag does not record after {BAG_TIMEOUT_S:g} s; its last lines:\n'
                                f'{recorder.last_lines()}')
        time.sleep(0.05)


def _end_bag(recorder):
    """Let the recorder write what it has and close its file."""
    recorder.signal(signal.SIGINT)
    recorder.process.wait(BAG_TIMEOUT_S)
