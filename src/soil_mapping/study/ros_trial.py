"""One trial on ROS: a ROS master of its own; time master, fleet and task server as children; the coordinator here."""
from __future__ import annotations

import math
import signal
import time
from typing import Any

from move_base_abstract.common import processes
from move_base_abstract_experiments.carrying.warm_loopback import WarmLoopback
from soil_mapping.mission.sampling import start_places
from soil_mapping.results.result import collect
from soil_mapping.stopwatch import Stopwatch

from .field_cache import truth_of

NODE = 'soil_coordinator'
TASK = 'take_sample'
POLL_S = 0.002  # wall
OWN_END_S = 10.0  # wall; time for the time master to end by itself
POSE_TOPIC = 'base_pose_ground_truth'


def run_ros_trial(spec: Any, folder: str, event_log: Any, bag: bool = False, over: Any = lambda: None) -> Any:
    """Run the trial of a TrialSpec in this process, which cannot run another one, and return its TrialResult.

    folder: the Path for bag and measured charge. event_log: the Path of the event log to write, in lockstep. bag:
    whether to record all topics. over: called when the mission is over.

    :raises LoopbackError, MissionFailed: if a node ends, or the mission cannot be carried out.
    """
    stopwatch = Stopwatch()
    began = time.perf_counter()
    with WarmLoopback() as ros:
        ros.adopt()
        names = [f'robot_{index}' for index in range(spec.config.robots)]
        nodes = _start_nodes(ros, spec, names, folder, event_log)
        from . import ros_mission  # while the nodes start
        recorder: Any = _recorder(ros, folder, names) if bag else None
        coordinator, run = ros_mission.carry_out(spec, NODE, names, (TASK, POSE_TOPIC), ros, stopwatch,
                                                 recorder.wait_until_connected if bag else lambda: None)
        over()
        ros_mission.leave()
        end_nodes(nodes, recorder, event_log if spec.clock != 'scaled' else None)
    seconds = dict(stopwatch.seconds, start_up=run.began - began, mission=run.wall_s,
                   end=time.perf_counter() - run.ended)
    inner = sum(seconds.get(name, 0.0) for name in ('kriging', 'allocation', 'maps'))
    return collect(coordinator, spec.about_engine, dict(seconds, messages=run.wall_s - inner), run.wall_s, spec.inputs)


def _start_nodes(ros: Any, spec: Any, names: Any, folder: Any, event_log: Any) -> Any:
    """Start the nodes of a trial, without waiting for them; return their Child objects, time master first."""
    nodes = [ros.run('time_master', 'time_master', parameters=_clock(spec, event_log))]
    with processes.importing():
        from . import ros_nodes  # noqa: F401 - while the time master starts, before the forks
    config = spec.config
    places = start_places(config.robots, spec.seed, truth_of(config).grid)
    quiet = {'events_only': True} if spec.clock != 'scaled' else {}  # the coordinator acts on events
    ros.set_param('/log_motion', True)  # so that a replay of the log is exact
    nodes.append(ros.run('fleet', 'fleet', parameters={
        **quiet,
        'defaults': {'max_speed': config.speed},
        'robots': [{'name': name, 'start_x': x, 'start_y': y} for name, (x, y) in zip(names, places)]}))
    nodes.append(ros.run('task_server', 'task_server', parameters={**quiet, 'robots': names, 'task': TASK}))
    if spec.charge != 'none':
        kind, _, path = spec.charge.partition(':')
        if kind.startswith('measured') and not path:
            path = str(folder / 'charge.jsonl')
        ros.set_param(f'/{NODE}/lockstep_charge', ':'.join(part for part in (kind, path) if part))
    return nodes


def _recorder(ros: Any, folder: Any, names: Any) -> Any:
    from .bag import BagRecorder
    return BagRecorder(ros, folder / 'trial.bag', names, ('move_base', TASK), POSE_TOPIC, NODE)


def _clock(spec: Any, event_log: Any) -> Any:
    """Return the time master's parameters."""
    if spec.clock == 'scaled':
        return {'mode': 'scaled', 'factor': float(spec.factor)}
    # It ends in the round in which the coordinator leaves. A later end would depend on the wall clock.
    return {'mode': 'lockstep', 'participants': ['/fleet', '/task_server', '/' + NODE], 'on_death': 'end',
            'end_with': ['/' + NODE], 'cores': 'all',  # trials run side by side, and the coordinator computes for long
            'speed_limit': float(spec.limit), 'event_log': str(event_log)}


def end_nodes(nodes: Any, recorder: Any, event_log: Any) -> None:
    """Wait until bag and event log are complete, then kill all nodes, which saves a second.

    The time master comes first in ``nodes``. It ends by itself when the coordinator has left. A signal could overtake
    the coordinator's last report, and would cut the run. So before the log is complete, the time master gets one only
    if it does not end.
    """
    if recorder is not None:
        recorder.close()
    if event_log is not None:
        deadline = time.monotonic() + OWN_END_S
        # The log gets its name when it is complete. After that, the end of roscpp takes a third of a second.
        while not event_log.exists() and nodes[0].process.poll() is None:
            if time.monotonic() > deadline:
                nodes[0].signal(signal.SIGTERM)
                deadline = math.inf
            time.sleep(POLL_S)
    for node in nodes:
        node.signal(signal.SIGKILL)
