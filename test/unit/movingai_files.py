"""Maps and problems in the format of the MovingAI benchmarks (move_base_abstract_mapf.movingai), and their optima.

Steps are straight (1) or diagonal (square root of 2); a diagonal one needs both cells beside it to be free.
"""
import heapq
import math
from pathlib import Path

from move_base_abstract_mapf.movingai import is_free, read_map

FOLDER = Path(__file__).parent / 'movingai'


def optima(path):
    """Return the lengths of the shortest ways over the cells [cells] that a .scen file names, in its order."""
    return [float(line.split('\t')[8]) for line in path.read_text(encoding='ascii').split('\n')[1:-1]]


def optimum(blocked, start, goal):
    """Return the (straight, diagonal) steps of the shortest way [column, row], or None: Dijkstra by floats."""
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
            if all(is_free(blocked, one) for one in (cell, (x + dx, y), (x, y + dy))):
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
