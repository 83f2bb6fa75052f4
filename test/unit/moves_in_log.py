"""Judges from an event log alone where robots were: in which places, on one another, past one another on a lane.

It imports nothing of the product. It counts the rows ``entered`` and ``left`` against the rows ``places``, and computes
the robots' positions from the rows ``pieces`` and ``stands``, whatever these rows say. It knows straight pieces only.
"""
import bisect
import json
import math

_STEP_NS = 100_000_000  # the positions are compared as often, and at each instant of a row


def _rows(path):
    with open(path, encoding='utf-8') as stream:
        return [row for row in map(json.loads, stream) if 'kind' in row]


def counted_wrongly(path):
    """Return what is wrong with the places that robots hold by the rows of the log: [text, ...]."""
    room, inside, found = {}, {}, []
    for row in _rows(path):
        values = row['values']
        if row['kind'] == 'places':
            room[values[0]] = values[1]
        elif row['kind'] == 'entered':
            robots = inside.setdefault(values[0], [])
            robots.append(row['robot'])
            if len(robots) > room.get(values[0], math.inf):
                found.append(f"{row['time_ns']}: {robots} hold places in {values[0]}")
        elif row['kind'] == 'left':
            inside[values[0]].remove(row['robot'])
    return found


class Positions:
    """Where robots are by a log; ``starts``: {robot: (x, y) [m]} before its first row."""

    def __init__(self, path, starts):
        self.robots = {name: [(0, x, y, 0.0, 0.0, 0.0)] for name, (x, y) in starts.items()}  # (ns, x, y, ux, v, ...)
        self.instants = [0]
        for row in _rows(path):
            self.instants.append(row['time_ns'])
            known = self.robots[row['robot']]
            if row['kind'] == 'pieces':
                del known[bisect.bisect_left([one[0] for one in known], row['time_ns']):]
                for begin, x, y, _, ux, uy, v, a, _, k in row['values']:
                    assert not k
                    known.append((begin, x, y, ux * v, uy * v, a * ux, a * uy))
            elif row['kind'] == 'stands':
                del known[bisect.bisect_left([one[0] for one in known], row['time_ns']):]
                known.append((row['time_ns'], *row['values'][:2], 0.0, 0.0, 0.0, 0.0))
        self.instants = sorted({*self.instants, *range(self.instants[1] if self.instants[1:] else 0,
                                                       self.instants[-1], _STEP_NS)})

    def at(self, robot, now_ns):
        """Return (x, y) [m] of a robot at ``now_ns``."""
        known = self.robots[robot]
        begin, x, y, *rest = known[bisect.bisect_right(known, (now_ns, math.inf)) - 1]
        if not any(rest):
            return x, y
        vx, vy, ax, ay = rest
        t = (now_ns - begin) / 1e9
        return x + vx * t + 0.5 * ax * t * t, y + vy * t + 0.5 * ay * t * t


def _place(xy, nodes, edges, reach):
    """Return the place at (x, y): a node within ``reach`` [m] in x and y, or a lane; None: the robot is off the net."""
    x, y = xy
    for name, (to_x, to_y) in nodes.items():
        if max(abs(x - to_x), abs(y - to_y)) < reach:
            return name
    for one, other in edges:
        (ax, ay), (bx, by) = nodes[one], nodes[other]
        length = math.dist((ax, ay), (bx, by))
        along = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length
        off = abs((x - ax) * (by - ay) - (y - ay) * (bx - ax)) / length
        if off < 1e-6 and 0.0 < along < length:
            return one, other
    return None


def met(path, starts, nodes, edges, reach):
    """Return what is wrong with the robots' positions: [text, ...].

    ``nodes``: {name: (x, y) [m]}, each the spot of one robot that reaches ``reach`` [m] to each side; ``edges``: pairs
    of names, lanes for one robot. Two robots may not be in one spot or on one lane, and none may leave the net.
    """
    positions = Positions(path, starts)
    found, nodes_of, last = [], {name: [] for name in starts}, {}
    for now_ns in positions.instants:
        here = {}
        for robot in starts:
            xy = positions.at(robot, now_ns)
            place = _place(xy, nodes, edges, reach - 1e-3)
            if place is None:
                found.append(f'{now_ns}: {robot} is off the net at {xy}')
            elif place in here:
                found.append(f'{now_ns}: {here[place]} and {robot} are both in {place}')
            here[place] = robot
            if place in nodes:
                if nodes_of[robot] and nodes_of[robot][-1][1] == place:
                    nodes_of[robot][-1][2] = now_ns
                else:
                    nodes_of[robot].append([now_ns, place, now_ns])
            last[robot] = xy
    drives = [(robot, one[1], other[1], one[2], other[0]) for robot, visits in nodes_of.items()
              for one, other in zip(visits, visits[1:])]
    for number, (robot, begin, end, from_ns, to_ns) in enumerate(drives):
        for other, its_begin, its_end, its_from_ns, its_to_ns in drives[:number]:
            if robot != other and (begin, end) == (its_end, its_begin) and max(from_ns, its_from_ns) < min(
                    to_ns, its_to_ns):
                found.append(f'{from_ns}: {robot} and {other} pass one another between {begin} and {end}')
    return found, last
