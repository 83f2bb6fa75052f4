"""Maps and scenarios in the format of the MovingAI benchmarks, and an own reckoning of their optimum.

A .map file: ``type octile``, ``height``, ``width``, ``map``, then rows from the north, '.' being free. A .scen file: a
version, then lines of bucket, map, width, height, start x, start y, goal x, goal y, optimum; y counts from the north.
Steps are straight (1) or diagonal (square root of 2); a diagonal one needs both cells beside it to be free.
"""
import heapq
import math
from pathlib import Path
from typing import NamedTuple, Tuple

import numpy as np

FOLDER = Path(__file__).parent / 'movingai'


class Problem(NamedTuple):
    """Start and goal (column, row from the north) and the length of the shortest way over the cells [cells]."""

    start: Tuple[int, int]
    goal: Tuple[int, int]
    optimum: float


def read_map(path):
    """Return which cells of a .map file are blocked, [row from the north, column]."""
    lines = path.read_text(encoding='ascii').split('\n')
    head = dict(line.split() for line in lines[:3])
    assert head['type'] == 'octile' and lines[3] == 'map'
    blocked = np.array([[letter not in '.G' for letter in line] for line in lines[4:4 + int(head['height'])]])
    assert blocked.shape == (int(head['height']), int(head['width']))
    return blocked


def read_problems(path):
    """Return the [Problem] of a .scen file."""
    lines = path.read_text(encoding='ascii').strip().split('\n')
    assert lines[0] == 'version 1'
    problems = []
    for line in lines[1:]:
        words = line.split('\t')
        x, y, goal_x, goal_y = map(int, words[4:8])
        problems.append(Problem((x, y), (goal_x, goal_y), float(words[8])))
    return problems


def optimum(blocked, start, goal):
    """Return the (straight, diagonal) steps of the shortest way [column, row], or None: Dijkstra by floats."""
    rows, columns = blocked.shape

    def is_free(x, y):
        return 0 <= x < columns and 0 <= y < rows and not blocked[y, x]
    best = {start: (0, 0)}
    queue = [(0.0, start)]
    done = set()
    while queue:
        _length, (x, y) = heapq.heappop(queue)
        if (x, y) == goal:
            return best[goal]
        if (x, y) in done:
            continue
        done.add((x, y))
        straight, diagonal = best[x, y]
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)):
            cell = x + dx, y + dy
            if is_free(*cell) and is_free(x + dx, y) and is_free(x, y + dy):
                steps = straight + (0 in (dx, dy)), diagonal + (0 not in (dx, dy))
                if cell not in best or _length_of(steps) < _length_of(best[cell]) - 1e-9:
                    best[cell] = steps
                    heapq.heappush(queue, (_length_of(steps), cell))
    return None


def _length_of(steps):
    return steps[0] + steps[1] * math.sqrt(2.0)


def write(folder, name, rows, problems):
    """Write NAME.map and NAME.scen; ``rows`` are texts, ``problems`` pairs of cells (column, row from the north)."""
    folder.mkdir(exist_ok=True)
    width, height = len(rows[0]), len(rows)
    (folder / (name + '.map')).write_text('type octile\nheight {}\nwidth {}\nmap\n{}\n'.format(
        height, width, '\n'.join(rows)), encoding='ascii')
    blocked = read_map(folder / (name + '.map'))
    lines = ['version 1']
    for start, goal in problems:
        length = _length_of(optimum(blocked, start, goal))
        words = [int(length / 4), name + '.map', width, height, *start, *goal, '{:.8f}'.format(length)]
        lines.append('\t'.join(map(str, words)))
    (folder / (name + '.scen')).write_text('\n'.join(lines) + '\n', encoding='ascii')
