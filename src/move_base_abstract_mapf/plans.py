"""Plans of MAPF solvers: in which cell each robot is at each step. Three text formats are read, one is written.

CBSH2, EECBS and MAPF-LNS write a line for each robot: ``Agent 0: (row,column)->(row,column)->...``. PIBT and LaCAM
write a line for each step, after a line ``solution=``: ``0:(column,row),(column,row),...``. libMultiRobotPlanning
writes YAML: ``schedule: {agent0: [{x: column, y: row, t: step}, ...]}``.
"""
from __future__ import annotations

import itertools
import re
from typing import Any, List, NamedTuple, Sequence, Tuple

from move_base_abstract.common.bounded_yaml import Bounds, load_yaml_text
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import open_input
from move_base_abstract.common.shown import shown

from .movingai import Cell, is_free

_MOST_BYTES = 64 * 1024 * 1024
_BOUNDS = Bounds(_MOST_BYTES, 10_000_000, 128 * 1024 * 1024)
_MOST_STEPS = 1_000_000  # the largest number of a step
_LINE = re.compile(r'\s*Agent ([0-9]{1,7}):\s*((?:\([0-9]{1,6},\s*[0-9]{1,6}\)\s*(?:->\s*)?)+)')
_STEP = re.compile(r'\s*([0-9]{1,7}):\s*((?:\([0-9]{1,6},\s*[0-9]{1,6}\)\s*(?:,\s*)?)+)')
_HEAD = re.compile(r'agents=|solver=|map_file=')  # the first lines of LaCAM's files
_PLACE = re.compile(r'\(([0-9]{1,6}),\s*([0-9]{1,6})\)')


class Plan(NamedTuple):
    """A plan. ``paths``: for each robot its cells at steps 0, 1, ...; it stays in the last one.

    While a robot waits, its cell is repeated.
    """

    paths: Tuple[Tuple[Cell, ...], ...]

    @property
    def costs(self) -> List[int]:
        """The step at which each robot comes to its last cell and stays there."""
        return [len(path) - 1 for path in self.paths]

    def at(self, robot: int, step: int) -> Cell:
        """Return the cell of a robot at a step."""
        path = self.paths[robot]
        return path[min(step, len(path) - 1)]


def make_plan(paths: Sequence[Sequence[Cell]], where: str, blocked: Any = None) -> Plan:
    """Return the :class:`Plan` of paths; waits at their ends are left out.

    ``where``: the file, for errors; ``blocked``: as from read_map(), or None to accept all cells.

    :raises ConfigurationError: for a step that leads farther than to a neighbour, or to a cell that is not free.
    """
    if not paths:
        raise ConfigurationError('{}: got no path; allowed: at least one'.format(where))
    for robot, path in enumerate(paths):
        for step, cell in enumerate(path):
            if blocked is not None and not is_free(blocked, cell):
                raise ConfigurationError('{}: agent {}, step {}: got column {}, row {}; allowed: free cells of the map'
                                         .format(where, robot, step, *cell))
        for step, ((x, y), (u, v)) in enumerate(zip(path, path[1:]), 1):
            if abs(x - u) + abs(y - v) > 1:
                raise ConfigurationError('{}: agent {}, step {}: got a way from {} to {}; allowed: to one of the four '
                                         'neighbours, or none'.format(where, robot, step, (x, y), (u, v)))
    return Plan(tuple(_without_end(path) for path in paths))


def _without_end(path: Sequence[Cell]) -> Tuple[Cell, ...]:
    count = len(path)
    while count > 1 and path[count - 2] == path[-1]:
        count -= 1
    return tuple(path[:count])


def read_plan(path: str, blocked: Any = None) -> Plan:
    """Return the :class:`Plan` in a file of any of the formats; ``blocked``: as from read_map(), or None.

    :raises ConfigurationError: naming file and line, or the robot and the step.
    """
    with open_input(path, _MOST_BYTES, what='plan') as stream:
        text = stream.read(_MOST_BYTES + 1).decode('utf-8', 'replace')
    lines = [line for line in text.splitlines() if line.strip()]
    first = lines[0].lstrip() if lines else ''
    read = _of_lines if first.startswith('Agent') else _of_steps if _HEAD.match(first) else _of_yaml
    return make_plan(read(path, text), path, blocked)


def _of_lines(path: str, text: str) -> List[List[Cell]]:
    paths: List[List[Cell]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        found = _LINE.fullmatch(line)
        if found is None or int(found.group(1)) != len(paths):
            raise ConfigurationError('{}:{}: got {}; allowed: Agent {}: (row,column)->(row,column)->...'.format(
                path, number, shown(line[:80]), len(paths)))
        paths.append([(int(column), int(row)) for row, column in _PLACE.findall(found.group(2))])
    return paths


def _of_steps(path: str, text: str) -> List[List[Cell]]:
    steps: List[List[Cell]] = []
    lines = enumerate(text.splitlines(), 1)
    if not any(line.strip() == 'solution=' for _, line in lines):
        raise ConfigurationError('{}: got no line "solution="; allowed: one, and a line "0:(column,row),..." for each '
                                 'step behind it'.format(path))
    for number, line in lines:  # the lines after it
        found = _STEP.fullmatch(line)
        cells = [] if found is None else [(int(column), int(row)) for column, row in _PLACE.findall(found.group(2))]
        if found is None or int(found.group(1)) != len(steps) or len(cells) != len((steps or [cells])[0]):
            if line.strip():
                raise ConfigurationError('{}:{}: got {}; allowed: {}:(column,row),... with a cell for each '
                                         'agent'.format(path, number, shown(line[:80]), len(steps)))
            continue
        steps.append(cells)
    return [list(one) for one in zip(*steps)]


def _of_yaml(path: str, text: str) -> List[List[Cell]]:
    raw = load_yaml_text(text, path, _BOUNDS)
    schedule = raw.get('schedule') if isinstance(raw, dict) else None
    if not isinstance(schedule, dict) or not all(isinstance(name, str) for name in schedule):
        raise ConfigurationError('{}: got {}; allowed: lines "Agent 0: (row,column)->...", a file with agents= and '
                                 'solution=, or YAML with a mapping schedule'.format(path, shown(raw)))
    names = ['agent{}'.format(number) for number in range(len(schedule))]
    missing = next((name for name in names if name not in schedule), None)
    if missing is not None:
        raise ConfigurationError('{}: schedule: {} is missing: agents are agent0, agent1, ...'.format(path, missing))
    return [_timed(schedule[name], '{}: schedule: {}'.format(path, name)) for name in names]


def _timed(entries: Any, where: str) -> List[Cell]:
    """Return the cells of one robot; between two entries it stays in the cell of the first one."""
    path: List[Cell] = []
    for entry in entries if isinstance(entries, list) else [None]:
        values: List[Any] = [entry.get(key) for key in 'xyt'] if isinstance(entry, dict) else [None]
        if not all(type(value) is int and 0 <= value <= _MOST_STEPS for value in values):
            raise ConfigurationError('{}: got {}; allowed: a list of {{x: column, y: row, t: step}}, whole numbers '
                                     '>= 0'.format(where, shown(entry)))
        column, row, step = values
        if step < len(path) or (not path and step):
            raise ConfigurationError('{}: t: got {}; allowed: 0 first, then more at each entry'.format(where, step))
        path += itertools.repeat(path[-1] if path else (column, row), step - len(path))
        path.append((column, row))
    return path


def written(plan: Plan) -> str:
    """Return a :class:`Plan` as text in the first format."""
    return ''.join('Agent {}: {}\n'.format(number, '->'.join('({},{})'.format(row, column) for column, row in path))
                   for number, path in enumerate(plan.paths))
