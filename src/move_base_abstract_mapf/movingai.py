"""Maps and problems in the format of the MovingAI benchmarks (N. Sturtevant): files ``.map`` and ``.scen``.

A map has ``type octile``, ``height``, ``width``, ``map``, then its rows from the north. A problem file has ``version
1``, then lines of bucket, map, width, height, start column, start row, goal column, goal row, length. Rows count from
the north.
"""
from __future__ import annotations

import os
from typing import Any, Dict, List, NamedTuple, Tuple

import numpy as np

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import open_text_input
from move_base_abstract.common.shown import shown

Cell = Tuple[int, int]  #: (column, row); row 0 is in the north

_FREE, _BLOCKED = '.GS', '@OTW'
_MOST_CELLS = 10_000  # along a side
_MOST_BYTES = 128 * 1024 * 1024
_COLUMNS = 9  # in a line of a problem file


class Problem(NamedTuple):
    """The start and the goal of a robot."""

    start: Cell
    goal: Cell


def read_map(path: str) -> Any:
    """Return which cells of a ``.map`` file are blocked: an array of booleans [row from the north, column].

    :raises ConfigurationError: naming file and line.
    """
    with open_text_input(path, _MOST_BYTES, what='file .map', encoding='ascii', errors='replace') as stream:
        lines = stream.read().splitlines()
    head: Dict[str, str] = {}
    for number, line in enumerate(lines[:4], 1):
        words = line.split()
        if words == ['map']:
            break
        if len(words) != 2 or words[0] not in ('type', 'height', 'width'):
            raise _error(path, number, line, "'type octile', 'height N', 'width N', then 'map'")
        if words[0] in head or words[0] == 'type' and words[1] != 'octile':
            raise _error(path, number, line, "'type octile', 'height N' and 'width N', each once")
        head[words[0]] = words[1]
    rows, columns = (_side(path, head, key) for key in ('height', 'width'))
    if 'type' not in head:
        raise ConfigurationError("{}: got no line 'type octile'; allowed: one".format(path))
    cells = lines[len(head) + 1:]
    while len(cells) > rows and not cells[-1].strip():
        cells.pop()
    for number, line in enumerate(cells, len(head) + 2):
        if len(line) != columns or line.strip(_FREE + _BLOCKED):
            raise _error(path, number, line, '{} letters of {}{}'.format(columns, _FREE, _BLOCKED))
    if len(cells) != rows:
        raise ConfigurationError('{}: got {} rows; allowed: {}, as its height says'.format(path, len(cells), rows))
    return np.array([[letter in _BLOCKED for letter in line] for line in cells])


def read_problems(path: str, blocked: Any = None, of_map: str = '') -> List[Problem]:
    """Return the problems of a ``.scen`` file, in its order.

    :param blocked: the map that it must be for, None: any. :param of_map: the path of its file, '': any; its name must
        be the one that the problems have.
    :raises ConfigurationError: naming file and line.
    """
    problems = []
    with open_text_input(path, _MOST_BYTES, what='file .scen', encoding='utf-8', errors='replace') as stream:
        for number, line in enumerate(stream, 1):
            words = line.split()
            if not words or (number == 1 and words[0] == 'version'):
                continue
            columns = line.rstrip('\n').split('\t') if '\t' in line else words
            if len(columns) != _COLUMNS or not all(
                    text.isascii() and text.isdecimal() and len(text) < 8 for text in columns[2:8]):
                raise _error(path, number, line, 'bucket, map, width, height, start column and row, goal column and '
                                                 'row, length')
            width, height, x, y, goal_x, goal_y = map(int, columns[2:8])
            if blocked is not None and (height, width) != blocked.shape:
                raise _error(path, number, line, 'width {} and height {}, as the map has'.format(*blocked.shape[::-1]))
            if of_map and os.path.basename(columns[1]) != os.path.basename(of_map):
                raise _error(path, number, line, 'problems for {}; a copy of the map under another name must be renamed'
                             .format(shown(os.path.basename(of_map))))
            problems.append(Problem((x, y), (goal_x, goal_y)))
    return problems


def is_free(blocked: Any, cell: Cell) -> bool:
    """Return whether a cell lies on the map and is not blocked."""
    column, row = cell
    return 0 <= row < blocked.shape[0] and 0 <= column < blocked.shape[1] and not blocked[row, column]


def _side(path: str, head: Dict[str, str], key: str) -> int:
    text = head.get(key, '')
    if not (text.isascii() and text.isdecimal()) or not 1 <= int(text[:9]) <= _MOST_CELLS:
        raise ConfigurationError('{}: {}: got {}; allowed: a whole number in 1..{}'.format(
            path, key, shown(text), _MOST_CELLS))
    return int(text)


def _error(path: str, number: int, line: str, allowed: str) -> ConfigurationError:
    return ConfigurationError('{}:{}: got {}; allowed: {}'.format(path, number, shown(line.rstrip('\n')), allowed))
