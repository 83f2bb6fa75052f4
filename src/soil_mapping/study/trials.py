"""Runs trials of the study in this process, for `study.py trial` or as the function of the experiment.

Imports are done, and the field is made, before a process is forked for a trial, because both take longer than most
other parts of it.
"""
from __future__ import annotations

import contextlib
import importlib
import importlib.util
import os
import signal
import sys
import traceback
from dataclasses import replace
from typing import Any, Iterator

from move_base_abstract.common import processes
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.own_files import whole_file
from soil_mapping.config import TrialConfig
from soil_mapping.results.provenance import machine, versions
from soil_mapping.results.trial_folder import TrialFolder, write_files

from .field_cache import draw_ahead, truth_of
from .groups import specs_of

HEAVY = {'ros': ('soil_mapping.study.ros_trial', 'soil_mapping.study.ros_nodes', 'soil_mapping.study.ros_mission',
                 'rosmaster.master'), 'mesa': ('soil_mapping.mesa_models.mesa_model',)}
PACKAGES = {'ros': ('rospy', 'rosmaster', 'actionlib'), 'mesa': ('mesa',)}
END = signal.SIGTERM  # ends a trial of `study trial`, unless its mission is over and its record is not complete
RECORD_S = 30.0  # wall; time for an interrupted trial to write its record, if its mission is over
LOG = 'lockstep_events.jsonl'  # of a trial of `study trial`
NOT_REPEATABLE = 'scaled clock: when messages arrive depends on the machine'


def prepare(args: Any, factors: Any) -> None:
    """Import all that the experiment's trials need and make their fields; called once in each warm process."""
    for spec in specs_of(factors['engine'], _config(args)):
        check(spec)
        truth_of(spec.config).values  # noqa: B018 - this makes it
    versions()
    machine()


def check(spec: Any, ahead: bool = False, with_imports: bool = True) -> None:
    """Check the trial of a TrialSpec: import all that it needs, and read its field, if that comes from a file.

    ahead: whether another process draws a random field meanwhile. with_imports: False: packages are only searched.

    :raises ConfigurationError: if a package is missing, or a file or a class of the user's cannot be used.
    """
    from soil_mapping.mission.coordinator import Coordinator
    spec.inputs  # noqa: B018 - this computes and keeps them
    truth = truth_of(spec.config)
    if ahead:
        draw_ahead(spec.config)
    for name in HEAVY[spec.engine] if with_imports else PACKAGES[spec.engine]:
        (_import if with_imports else _look_for)(spec.engine, name)
    Coordinator(spec.config, spec.seed, truth)


def _import(engine: Any, module: Any) -> None:
    try:
        importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise _missing(engine, error.name) from None


def _look_for(engine: Any, package: str) -> None:
    if importlib.util.find_spec(package) is None:
        raise _missing(engine, package)


def _missing(engine: Any, package: Any) -> Any:
    why = 'it needs Python 3.11; trials on ROS do not need it' if package == 'mesa' else 'see docs/soil_study_ros.md'
    return ConfigurationError(f"engine '{engine}': {package} is not installed for {sys.executable} ({why})")


def _config(args: Any) -> Any:
    return TrialConfig.from_dict({name: value for name, value in args.items() if name != 'pictures'})


def run(trial: Any) -> Any:
    """Run a trial, as the function of the experiment: write its files, return its metrics."""
    config = replace(_config(trial.args), **{name: trial.configuration[name] for name in ('allocation', 'sampling')})
    spec = replace(specs_of([trial.configuration['engine']], config)[0], seed=trial.seed)
    result = _carry_out(spec, trial.files, trial.event_log)
    write_files(trial.files, result)
    if trial.args['pictures']:
        from soil_mapping.results.pictures import write_pictures
        write_pictures(trial.files, result)
    trial.simulated_seconds = result.simulated_s
    if spec.engine == 'ros' and spec.clock == 'scaled':
        trial.not_repeatable(NOT_REPEATABLE)
    return result.metrics._asdict()


def run_one(spec: Any, path: str, pictures: bool = False, bag: bool = False) -> None:
    """Run a trial in this process, which cannot run another one on ROS afterwards, and write its folder.

    An error is also written to error.txt in the unfinished folder.
    """
    with TrialFolder(path) as folder, _noted_errors(folder):
        result = _carry_out(spec, folder.path, folder.path / LOG, bag, lambda: signal.signal(END, signal.SIG_IGN))
        folder.finish(result, pictures, lambda: signal.signal(END, signal.SIG_DFL))


def in_child(body: Any) -> Any:
    """Call body(), which returns an exit code, in a forked process; return that code, or minus a signal's number.

    If this process is interrupted, the child ends: at once, or as soon as it no longer ignores END. The kernel ends its
    nodes with it.

    :raises KeyboardInterrupt: after an interruption, when the child has ended.
    """
    def child() -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent; in the child it could come anywhere
        code = body()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)  # rospy's own end takes half a second, and calls a ROS master that has ended
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    pid, statuses = None, {}
    try:
        pid = processes.fork(child)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        statuses[pid] = os.waitpid(pid, 0)[1]
        return processes.code_of(statuses[pid])
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        processes.end([] if pid is None or pid in statuses else [pid], END, RECORD_S, statuses)


def _carry_out(spec: Any, folder: Any, event_log: Any, bag: bool = False, over: Any = lambda: None) -> Any:
    """Run the mission of a TrialSpec; return its TrialResult. over: called when the mission is over."""
    if spec.engine == 'ros':
        from .ros_trial import run_ros_trial
        return run_ros_trial(spec, folder, event_log, bag, over)
    from soil_mapping.mesa_models.mesa_model import run_mesa_trial
    result = run_mesa_trial(spec.config, spec.seed, spec.motion, truth_of(spec.config), inputs=spec.inputs)
    over()
    return result


@contextlib.contextmanager
def _noted_errors(folder: Any) -> Iterator[Any]:
    """Write an error that ends a trial into the trial's folder, if that is possible."""
    try:
        yield
    except BaseException as error:
        with contextlib.suppress(SimulatorError, OSError):
            if folder.path.is_dir():
                with whole_file(folder.path / 'error.txt', encoding='utf-8') as stream:
                    stream.write(''.join(traceback.format_exception(type(error), error, error.__traceback__)))
        raise
