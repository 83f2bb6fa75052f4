"""Prepare a trial's launch file or command for lockstep: roslaunch's configuration, changed for one run."""
from __future__ import annotations

import contextlib
import dataclasses
import os
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from move_base_abstract.common.options import parameters_of as parameters_of_options
from move_base_abstract.radio import network
from move_base_abstract.runs import error_lines
from move_base_abstract_ros.launching.conditions import Condition
from move_base_abstract_ros.loopback import PACKAGE

from ..description import launch_files
from ..description.experiment import Experiment
from ..description.job import Job
from .metrics import Place, Starts
from .run_folders import Folders
from .termination import END_NODE

LOG_MOTION, PARTICIPANTS = '/log_motion', '/time_master/participants'
RECORDER_NODE = '/experiment_recorder'
DECISIONS = 'chaos_decisions.jsonl'  # the file of the decisions of chaos, if record.files names it
START_NOTE = 'started'  # the file that the time master writes when time starts


class Run(NamedTuple):
    """One run of a Job. ``condition``: the condition of a second run; None: the first run."""

    job: Job
    folders: Folders
    condition: Optional[Condition] = None

    @property
    def experiment(self) -> Experiment:
        """The experiment of the trial."""
        return self.job.trial.experiment

    @property
    def is_reversed(self) -> bool:
        """Whether nodes start one after another, in reverse order."""
        return self.condition is not None and '--start-order' in self.condition.options

    def path(self, name: str) -> str:
        """Return the path of a file in the run's own folder."""
        return os.path.join(self.folders.own, name)


def plan_of(run: Run) -> Any:
    """Return the Plan of a run."""
    from move_base_abstract_ros.launching import plan
    plan.name_anonymous_ones_alike()
    trial, experiment = run.job.trial, run.experiment
    config = launch_files.read([(launch_files.find(trial.launch, experiment.folder), trial.arguments)]
                               if trial.launch else [], experiment.adopt or experiment.tolerant)
    _add_own_nodes(config, run)
    options = _launch_options(config, run)
    options = launch_files.adopted(config, options) if experiment.adopt else options
    return plan.plan_of(config, _with_participants(config, experiment, options))


def _add_own_nodes(config: Any, run: Run) -> None:
    from roslaunch.core import Node, Param
    experiment = run.experiment
    if experiment.record.motion and LOG_MOTION not in config.params:
        config.params[LOG_MOTION] = Param(LOG_MOTION, True)
    if experiment.command:  # its participants are not in a launch file
        config.params[PARTICIPANTS] = Param(PARTICIPANTS, list(experiment.participants or ()))

    def add(name: str, kind: str, parameters: Dict[str, Any], required: bool) -> None:
        node = Node(PACKAGE, 'lockstep', name=name.lstrip('/'), required=required,
                    args=f'--own move_base_abstract_ros.nodes.{kind}_node')
        node.machine = config.machines['']
        config.nodes.append(node)
        for key, value in parameters.items():
            config.params[f'{name}/{key}'] = Param(f'{name}/{key}', value)
    if experiment.until.topic:
        add(END_NODE, 'end_at_message', {'topic': experiment.until.topic}, True)
    if experiment.record.messages:
        add(RECORDER_NODE, 'message_recorder', {'topics': list(experiment.record.messages),
                                                'path': run.folders.messages}, False)


def parameters_of(run: Run, start_s: float) -> Dict[str, Any]:
    """Return the parameters of the time master. start_s: when the clock starts [s]."""
    experiment, until = run.experiment, run.experiment.until
    found: Dict[str, Any] = {'event_log': run.folders.log, 'note_of_start': run.path(START_NOTE),
                             **network.resolve(parameters_of_options(run.job.trial.run_options), experiment.folder),
                             **parameters_of_options(until), **parameters_of_options(experiment.record)}
    if DECISIONS in experiment.record.files and experiment.chaos_seed:
        found['chaos_decisions'] = os.path.join(run.folders.files, DECISIONS)
    found.update({'speed_limit': run.job.speed_limit} if run.job.speed_limit else {})
    ends = [*([start_s + until.seconds] if until.seconds else []), *([until.at] if until.at else [])]
    return {**found, **({'end_at': min(ends)} if ends else {})}


def _launch_options(config: Any, run: Run) -> Any:
    from move_base_abstract_ros.launching import plan
    condition, start = run.condition, config.params.get('/time_master/start_time')
    own_environment: Tuple[Tuple[str, str], ...] = ()
    if condition is not None and '--own-hash-seed' in condition.options:
        seed = condition.options[condition.options.index('--own-hash-seed') + 1]
        own_environment = (('PYTHONHASHSEED', seed),)
    return plan.launch_options(
        run.job.trial.run_options, parameters_of(run, 1.0 if start is None else start.value),
        is_reversed=run.is_reversed, own_environment=own_environment,
        environment=((error_lines.VARIABLE, run.folders.own), *(condition.environment if condition else ())))


def _with_participants(config: Any, experiment: Experiment, options: Any) -> Any:
    """Return options with the experiment's list of participants, if it has one: all other nodes look on."""
    from move_base_abstract_ros.launching import roles
    if experiment.participants is None or experiment.command:
        return options
    forced = experiment.participants
    names = [roles.name_of(node) for node in config.nodes if not (roles.is_time_master(node) or roles.is_display(node))]
    return dataclasses.replace(options, participant=forced, onlooker=tuple(
        name for name in names if name not in (*forced, END_NODE, RECORDER_NODE)))


def starts_of(config: Any) -> Starts:
    """Return {robot: (x, y)} [m] for the robots in the parameters of nodes move_base and of fleets."""
    found: Starts = {}
    for key, param in config.params.items():
        node, _, name = key.rpartition('/')
        if node.endswith('/move_base'):
            values = [config.params.get(f'{node}/{one}') for one in ('start_x', 'start_y')]
            found[node.rpartition('/')[0].strip('/')] = _place([None if one is None else one.value for one in values])
        elif name == 'robots' and isinstance(param.value, list):
            found.update((one['name'], _place([one.get('start_x'), one.get('start_y')]))
                         for one in param.value if isinstance(one, dict) and isinstance(one.get('name'), str))
    return found


def _place(values: List[Any]) -> Place:
    with contextlib.suppress(TypeError, ValueError):
        x, y = (0.0 if value is None else float(value) for value in values)
        return x, y
    return None
