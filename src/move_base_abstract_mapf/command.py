"""Read plans of MAPF solvers and let a fleet drive them.

    rosrun move_base_abstract mapf import room.map room.scen --agents 20 --out FOLDER
    rosrun move_base_abstract mapf run FOLDER paths.txt [--policy order_kept] [--log run.jsonl] [--json OUT.json]

Exit codes: 0 the folder is made, or all robots have come to their goals; 1 not all robots have; 2 a file cannot be
used, or the arguments are wrong.
"""
from __future__ import annotations

import argparse
import json
import os
import sys
from typing import Any, Optional, Sequence

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import ConfigurationError, telling
from move_base_abstract.common.kinds import integer
from move_base_abstract.common.options import POSITIVE, word_of

_FORMAT = '{"format": "move_base_abstract mapf 1",\n'
_NEAR = 0.7  # cells; two robots that follow each other around a corner come as near as 0.707


def main(words: Optional[Sequence[str]] = None) -> None:
    """Run the command with these arguments (default: those of the shell); exit with its code."""
    options = _parse(words)
    with telling('mapf'):
        sys.exit(options.run(options))


def _parse(words: Optional[Sequence[str]]) -> Any:
    parser = argparse.ArgumentParser(
        prog='mapf', description='Read plans of MAPF solvers and let a fleet drive them.',
        epilog='exit codes: 0 made, or all robots have come to their goals; 1 not all have; 2 a file cannot be used')
    commands = parser.add_subparsers(metavar='COMMAND', required=True)
    make = commands.add_parser('import', help='make a scenario of a MovingAI map and problem', description=(
        'Make a scenario, and a map for map_server, of a MovingAI map and the first problems of a file.'))
    make.add_argument('map', metavar='FILE.map', help='the map')
    make.add_argument('problems', metavar='FILE.scen', help='starts and goals')
    make.add_argument('--agents', type=word_of(integer(1)), required=True, metavar='N',
                      help='number of problems that are used, one robot each')
    make.add_argument('--out', required=True, metavar='FOLDER', help='a new folder, an empty one, or one that this '
                      'command made; nothing else is replaced')
    make.add_argument('--cell', type=POSITIVE, default=1.0, metavar='M', help='side of a cell [m] (default: 1)')
    make.add_argument('--step', type=POSITIVE, default=1.0, metavar='S', help='duration of a step [s] (default: 1)')
    make.set_defaults(run=_import)
    run = commands.add_parser('run', help='drive a plan, in plain Python', description=(
        "Drive a plan in plain Python, with the scenario's durations and failures, and print the result."))
    run.add_argument('folder', metavar='FOLDER', help='a folder that `import` made')
    run.add_argument('plan', metavar='PLAN', help='paths, as EECBS, LaCAM or libMultiRobotPlanning writes them')
    run.add_argument('--policy', choices=('as_timed', 'order_kept', 'cell_left'), default='order_kept',
                     help='what must be true before a robot moves (default: %(default)s)')
    run.add_argument('--goals', metavar='FILE.scen', help='check that paths lead from its starts to its goals')
    run.add_argument('--near', type=POSITIVE, default=None, metavar='M',
                     help='count robots that come nearer than this [m] (default: {} of a cell)'.format(_NEAR))
    run.add_argument('--seed', type=word_of(integer(0)), default=None, help="replaces the scenario's seed")
    run.add_argument('--log', metavar='RUN.jsonl', help='write the run as an event log, for replay')
    run.add_argument('--json', metavar='OUT.json', help='write the figures as JSON')
    run.set_defaults(run=_run)
    return parser.parse_args(words)


def _import(options: Any) -> int:
    from .layout import Grid, write_folder  # numpy takes a while to import
    from .movingai import read_map, read_problems
    grid = Grid(read_map(options.map), options.cell)
    problems = read_problems(options.problems, grid.blocked, options.map)
    if not 1 <= options.agents <= len(problems):
        raise ConfigurationError('--agents: got {}; allowed: 1..{}, as many as {} has'.format(
            options.agents, len(problems), options.problems))
    starts = [problem.start for problem in problems[:options.agents]]
    for number, start in enumerate(starts):
        if start in starts[:number]:
            raise ConfigurationError('problem {}: start: got column {}, row {}, as problem {}; allowed: a cell of its '
                                     'own for each robot'.format(number, *start, starts.index(start)))
    write_folder(options.out, grid, problems[:options.agents], options.step, 'mapf import {} {} --agents {}'.format(
        os.path.basename(options.map), os.path.basename(options.problems), options.agents))
    print('{}: {} robots on {} x {} cells'.format(
        os.path.join(options.out, 'scenario.yaml'), options.agents, *grid.blocked.shape[::-1]))
    return 0


def _run(options: Any) -> int:
    from .driving import drive
    from .layout import read_folder
    from .plans import read_plan
    site = read_folder(options.folder, options.seed)
    plan = read_plan(options.plan, site.grid.blocked)
    if options.goals is not None:
        _check_goals(plan, options.goals, site.grid.blocked)
    if options.json is not None:
        own_files.check_file(options.json, lambda line: line == _FORMAT.encode())
    done = drive(site, plan, options.policy)
    found = done.outcome(options.near or _NEAR * site.grid.size)
    _tell(found)
    if options.log is not None:
        done.fleet.write_log(options.log)
    if options.json is not None:
        with own_files.whole_file(options.json, 'w', encoding='utf-8') as stream:
            stream.write(_FORMAT + json.dumps(found._asdict(), indent=1)[1:].lstrip('\n') + '\n')
    return 0 if found.arrived == found.agents else 1


def _check_goals(plan: Any, path: str, blocked: Any) -> None:
    from .movingai import read_problems
    problems = read_problems(path, blocked)
    if len(problems) < len(plan.paths):
        raise ConfigurationError('--goals: {} has {} problems; allowed: at least {}, one for each path'.format(
            path, len(problems), len(plan.paths)))
    for number, (one, problem) in enumerate(zip(plan.paths, problems)):
        for verb, cell, what, expected in (('begins', one[0], 'start', problem.start),
                                           ('ends', one[-1], 'goal', problem.goal)):
            if cell != expected:
                raise ConfigurationError('agent {}: its path {} at column {}, row {}, but its {} is column {}, row '
                                         '{}'.format(number, verb, *cell, what, *expected))


def _tell(found: Any) -> None:
    print('policy {}: {} of {} robots have come to their goals'.format(found.policy, found.arrived, found.agents))
    print('                     plan       driven   [steps]')
    for name, planned, driven in (('sum of costs', found.planned_flow_time, found.flow_time),
                                  ('makespan', found.planned_makespan, found.makespan)):
        print('{:<16} {:>8}   {:>10}'.format(name, planned, '-' if driven is None else '{:.3f}'.format(driven)))
    for name, planned, driven in (('vertex conflicts', found.planned_conflicts[0], found.vertex_conflicts),
                                  ('swap conflicts', found.planned_conflicts[1], found.swap_conflicts)):
        print('{:<16} {:>8}   {:>10}'.format(name, planned, driven))
    print('pairs of robots nearer than {:g} m: {}{}'.format(
        found.near, found.near_pairs, '' if found.nearest is None else ', the nearest {:.3f} m'.format(found.nearest)))
    if found.retries:
        print('moves that failed and were tried again: {}'.format(found.retries))
    for name, other in list(found.waits_for.items())[:10]:
        print('{} waits until {} has left'.format(name, other))
