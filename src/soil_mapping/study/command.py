"""The command line of examples/study.py: trial, run and report; its status and rerun are those of ``experiment``.

Exit codes: 0 all is done; 1 a trial failed (the reason is printed); 2 wrong arguments; 130 interrupted.
"""
from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path
from typing import Any, Dict, List, Sequence, Union

from move_base_abstract.common import processes
from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import word_of
from soil_mapping import config, environment
from soil_mapping.config import PUBLISHED_CONFIGURATIONS, TrialConfig
from soil_mapping.ground_truth.readings import MEUSE_FILE

from . import groups
from .spec import CLOCKS, ENGINES, TrialSpec

DEFAULT_OUTPUT = 'study'
_NUMBER = word_of(number())
_COUNT = word_of(number(1, 10000, whole=True))  # of seeds, and of trials at a time
_SEED = word_of(number(-1e99, 1e99, whole=True))  # the configuration says which are allowed
ENGINE_OPTIONS = {  # options of one engine or clock only: default, and the arguments with which the option applies
    'clock': ('lockstep', '--engine ros'), 'factor': (10.0, '--engine ros --clock scaled'),
    'limit': (0.0, '--engine ros --clock lockstep'), 'charge': ('none', '--engine ros --clock lockstep'),
    'motion': ('euclidean', '--engine mesa'), 'bag': (False, '--engine ros')}
_OWN = ' a class of your own, my_package.module:Class'
#: options of the mission: {option: (field of TrialConfig, metavar, help)}
MISSION = {
    '--field': ('field', None, "'synthetic', 'synthetic:SEED', 'csv:PATH' or 'meuse'"),
    '--crs': ('crs', '{degrees,metres}', 'for csv:PATH: columns lat, lon in degrees, or x, y in metres such as UTM'),
    '--size': ('size', 'WxH', "for csv:PATH: stretch the readings' bounding box to this size in m, such as 324x220"),
    '--robots': ('robots', 'N', 'number of robots'), '--budget': ('budget_s', 'S', 'simulated s that a trial lasts'),
    '--dwell': ('dwell_s', 'S', 'simulated s that a sample takes'),
    '--dwell-spread': ('dwell_spread_s', 'S', 'each dwell is drawn evenly from dwell - S to dwell + S'),
    '--speed': ('speed', 'V', 'speed of the robots in m/s'),
    '--cell': ('cell_m', 'M', 'edge of a cell of truth and map in m; for synthetic and stretched fields 1 or 2')}

CHOSEN = ('allocation', 'sampling', 'coarse_cells')  # these are factors, or follow from them
GUARD_S = 300.0  # wall, in addition to the time that the clock needs; ends a trial that would never end
COLUMNS = {
    'rmse_kpa': {'title': 'Error of the map (RMSE)', 'unit': 'kPa', 'better': 'lower'},
    'mean_variance_kpa2': {'title': 'Mean kriging variance', 'unit': 'kPa²', 'better': 'lower'},
    'samples': {'title': 'Samples', 'better': 'higher'},
    'distance_m': {'title': 'Distance driven by all robots', 'unit': 'm'},
    'idle_s': {'title': 'Time without a task, all robots', 'unit': 's', 'better': 'lower'},
    'waiting_s': {'title': 'Time held up, all robots', 'unit': 's', 'better': 'lower'},
    'task_s': {'title': 'Mean time of a task', 'unit': 's', 'better': 'lower'},
}


def main(words: Any = None) -> Any:
    """Run the command of these words, by default those of the shell; return the exit code."""
    words = sys.argv[1:] if words is None else words
    if words[:1] in (['status'], ['rerun']):
        return _experiment(words)
    arguments = _parser().parse_args(words)
    return _code_of(arguments.run, arguments)


def _code_of(run: Any, arguments: Any) -> Any:
    """Run a command and return its exit code; errors are printed."""
    try:
        return run(arguments)
    except (ConfigurationError, FileNotFoundError) as error:
        print(f'study: {error}', file=sys.stderr)
        return 2
    except (SimulatorError, OSError) as error:
        print(f'study: {error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print('\nstudy: interrupted; complete trials stay', file=sys.stderr)
        return 130


def _trial(arguments: Any) -> Any:
    """Run one trial, in a process forked from this one, and print its metrics."""
    from soil_mapping.results.trial_folder import TrialFolder

    from . import trials
    options = _engine_options(arguments)
    bag = options.pop('bag')
    spec = TrialSpec(config=_config(arguments), seed=arguments.seed, engine=arguments.engine, **options)
    path = _folder(arguments)
    TrialFolder(path).check()
    began = time.monotonic()
    processes.keep_memory()
    trials.check(spec, ahead=True, with_imports=False)  # imports are done while nodes start

    def run(_: Any) -> int:
        try:
            trials.run_one(spec, path, arguments.pictures, bag)
        except RuntimeError as error:  # on ROS: a node has ended, or the mission cannot be carried out
            print(f'study: the trial failed: {error}', file=sys.stderr)
            return 1
        return 0
    code = trials.in_child(lambda: _code_of(run, arguments))
    if code < 0:
        print(f'study: the trial failed: its process was killed by signal {-code}', file=sys.stderr)
    elif code == 0:
        _print_trial(path, time.monotonic() - began)
    return 1 if code < 0 else code


def _engine_options(arguments: Any) -> Any:
    """Return the values of ENGINE_OPTIONS. :raises ConfigurationError: if an option is given that does not apply."""
    words = f'--engine {arguments.engine} --clock {arguments.clock or "lockstep"}'.split()
    found = {}
    for name, (default, applies) in ENGINE_OPTIONS.items():
        value = getattr(arguments, name)
        if value is not None and not set(applies.split()) <= set(words):
            raise ConfigurationError(f'--{name} applies to {applies} only, got {" ".join(words)}')
        found[name] = default if value is None else value
    return found


def _folder(arguments: Any) -> Any:
    """Return the absolute path of the folder to which the command writes."""
    if not arguments.output:
        raise ConfigurationError("--output: must be the name of a folder, got ''")
    return Path(os.path.abspath(arguments.output))


def _print_trial(path: str, total_s: Any) -> None:
    """Print the results of a trial."""
    from soil_mapping.results.trial_folder import read_about
    about: Any = read_about(path)
    for name, value in about['metrics'].items():
        print(f'{name:<20} {"none" if value is None else f"{value:.6g}"}')
    phases = ', '.join(f'{name} {seconds:.2f}' for name, seconds in about['wall_s'].items())
    print(f'{about["simulated_s"]:g} s simulated, {about["speed_up"]["moving"]:.1f} times real time; {total_s:.2f} s '
          f'in all; wall seconds: {phases}')
    if about['field']['extent']:
        print(f'field: {about["field"]["extent"]}')
    print(path)


def _run(arguments: Any) -> Any:
    """Run the missing trials of the study's experiment, then write the report."""
    from yaml import safe_dump

    from move_base_abstract.common import temporary
    from move_base_abstract_experiments import sweep
    from move_base_abstract_experiments.results import outputs

    from . import trials
    mission = _config(arguments)
    names = groups.chosen(arguments.groups, os.environ.get('STUDY_1X') == '1')
    output = _folder(arguments)
    outputs.OUT.check(output)
    for spec in groups.specs_of(names, mission):
        trials.check(spec, with_imports=False)
    content = document(mission, names, arguments.seeds, arguments.scaled_seeds, arguments.verify, arguments.pictures)
    with temporary.folder('study_') as folder:
        file = os.path.join(folder, 'experiment.yaml')
        with open(file, 'w', encoding='utf-8') as stream:
            safe_dump(content, stream, sort_keys=False, allow_unicode=True)
        bad = sweep.run(file, str(output), arguments.jobs, arguments.scheduler, folder=str(output))
    _report(arguments)
    return 1 if bad else 0


def document(mission: TrialConfig, names: Sequence[str], seeds: int, scaled_seeds: int, verify: float = 0.0,
             pictures: bool = False) -> Dict[str, Union[List[str], Dict[str, Any], str]]:
    """Return the experiment's file as a mapping.

    mission: its allocation and sampling are not used: they are factors. names: those of groups, of groups.py.
    seeds: number of seeds, from 0 on. scaled_seeds: the same for the scaled clock, which is slower. verify: share of
    the trials that run twice. pictures: whether trials draw pictures.
    """
    values: Any = mission.to_dict()
    kind, _, path = values['field'].partition(':')
    if kind == 'csv':
        values['field'] = f'csv:{os.path.abspath(path)}'
    files = [os.path.abspath(path)] if kind == 'csv' else [str(MEUSE_FILE)] if kind == 'meuse' else []
    slowest = max([mission.budget_s / groups.FACTORS[group] for group in names if group in groups.FACTORS], default=0.0)
    counts = {group: scaled_seeds if group in groups.FACTORS else seeds for group in names}
    most = max(counts.values())
    fewer = {group: count for group, count in counts.items() if count < most}
    factors: Dict[str, Any] = {'engine': list(names)}
    for place, name in enumerate(('allocation', 'sampling')):
        factors[name] = list(dict.fromkeys(each[place] for each in PUBLISHED_CONFIGURATIONS))
    return {
        'experiment': 'soil compaction mapping', 'function': 'soil_mapping.study.trials:run',
        'prepare': 'soil_mapping.study.trials:prepare', 'inputs': files,
        'args': {**{name: value for name, value in values.items() if name not in CHOSEN}, 'pictures': pictures},
        'factors': factors, 'replications': {'all': most, **({'engine': fewer} if fewer else {})},
        'record': {'files': ['*']}, 'metrics': {'columns': COLUMNS},
        'report': 'soil_mapping.study.sections:sections', 'verify': verify, 'time_limit': GUARD_S + 2.0 * slowest}  # type: ignore[dict-item]


def _report(arguments: Any) -> int:
    """Write the report on the trials that exist."""
    from move_base_abstract_experiments.report import command
    path, problems = command.write(_folder(arguments))
    for problem in problems:
        print(f'study: {problem}', file=sys.stderr)
    print(path)
    return 0


def _experiment(words: Any) -> Any:
    """Run the command of `experiment`, with the Python that has all that the study needs."""
    from move_base_abstract_experiments.command import main as command
    return command(words)


def _config(arguments: Any) -> Any:
    return TrialConfig(**{name: value for name, value in vars(arguments).items() if hasattr(TrialConfig, name)})


def _parser() -> Any:
    parser = argparse.ArgumentParser(prog='study.py', description='The soil compaction mapping study: trials on ROS '
                                     'and on Mesa, and their comparison. Each ROS trial has a ROS master of its own.')
    commands = parser.add_subparsers(required=True, metavar='trial|run|report|status|rerun|setup')
    _add_trial(commands.add_parser('trial', help='run one trial'))
    _add_run(commands.add_parser('run', help='run the missing trials of the whole study, then write the report'))
    report = commands.add_parser('report', help='write the report on the trials that exist')
    report.add_argument('--output', default=DEFAULT_OUTPUT, metavar='DIR',
                        help='folder of the study (default: %(default)s)')
    report.set_defaults(run=_report)
    setup = commands.add_parser('setup', help='make the Python environment that the study needs, for this user; '
                                'packages that Debian lacks come from PyPI')
    setup.set_defaults(run=lambda arguments: environment.main([str(environment.of_the_user())]))
    return parser


def _add_trial(parser: Any) -> None:
    parser.set_defaults(run=_trial)
    parser.add_argument('--engine', choices=ENGINES, default='ros', help='default: %(default)s')
    parser.add_argument('--clock', choices=CLOCKS, help='clock of ROS (default: lockstep)')
    parser.add_argument('--factor', type=_NUMBER, metavar='F',
                        help='simulated s per wall s of the scaled clock, 0.01..1e6 (default: 10)')
    parser.add_argument('--limit', type=_NUMBER, metavar='F',
                        help='in lockstep, upper limit of simulated s per wall s; 0 = no limit (default: 0)')
    parser.add_argument('--charge', help='simulated time that computing takes in lockstep: none, '
                        'fixed:SECONDS, measured[:FILE], measured_cpu[:FILE], replay:FILE (default: none)')
    parser.add_argument('--motion', choices=('euclidean', 'eight'),
                        help='motion on Mesa: euclidean = straight; eight = one 2 m cell a second in eight directions, '
                        'with --cell 2 (default: euclidean)')
    parser.add_argument('--seed', type=_SEED, default=0, metavar='S', help='whole number >= 0 (default: %(default)s)')
    parser.add_argument('--bag', action='store_true', default=None, help='record all topics to trial.bag')
    parser.add_argument('--output', default='trial', metavar='DIR', help='folder of the results (default: %(default)s)')
    _add_mission(parser, {'--allocation': ('allocation', 'NAME', 'rr (round robin), ssi (auction), or' + _OWN),
                          '--sampling': ('sampling', 'NAME', 'random, dynamic, grid, or' + _OWN)}, pictures=True)


def _add_run(parser: Any) -> None:
    parser.set_defaults(run=_run)
    parser.add_argument('--seeds', type=_COUNT, default=10, metavar='N',
                        help='seeds 0..N-1 of each configuration on Mesa and in lockstep (default: %(default)s)')
    parser.add_argument('--scaled-seeds', type=_COUNT, default=3, metavar='N',
                        help='seeds 0..N-1 of each configuration and factor on the scaled clock (default: %(default)s)')
    parser.add_argument('--groups', nargs='+', metavar='GROUP',
                        help='only these groups of trials, such as mesa or ros-lockstep')
    parser.add_argument('--jobs', type=_COUNT, default=len(os.sched_getaffinity(0)), metavar='N',
                        help='number of trials at a time (default: number of cores, %(default)s)')
    parser.add_argument('--scheduler', metavar='ADDRESS',
                        help='a running Dask scheduler that runs the trials instead, tcp://HOST:PORT')
    parser.add_argument('--verify', type=word_of(number(0.0, 1.0)), default=0.05, metavar='SHARE',
                        help='chance that a trial runs twice, 0..1; the first trial always does (default: %(default)s)')
    parser.add_argument('--output', default=DEFAULT_OUTPUT, metavar='DIR',
                        help='folder of the study; complete trials in it are kept (default: %(default)s)')
    _add_mission(parser, {}, pictures=False)


def _add_mission(parser: Any, rows: Any, pictures: Any) -> None:
    defaults = TrialConfig()
    for option, (name, metavar, text) in {**rows, **MISSION}.items():
        default = getattr(defaults, name)
        parser.add_argument(option, dest=name, metavar=metavar, default=getattr(default, 'value', default),
                            type=word_of(config.KINDS[name]) if name in config.KINDS else str,
                            help=f'{text} (default: {"its own" if default == "" else "%(default)s"})')
    parser.add_argument('--pictures', action=argparse.BooleanOptionalAction, default=pictures,  # type: ignore[attr-defined]
                        help='draw the maps of the trial')
