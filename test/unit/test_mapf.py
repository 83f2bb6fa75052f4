"""Plans of MAPF solvers: read, driven as they say, and their conflicts counted."""
import json
import math
import random
import re
from collections import deque
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_mapf.command import main
from move_base_abstract_mapf.conflicts import Piece, nearest, plan_conflicts, swap_conflicts, vertex_conflicts
from move_base_abstract_mapf.driving import drive
from move_base_abstract_mapf.execution import AS_TIMED, CELL_LEFT, ORDER_KEPT, POLICIES
from move_base_abstract_mapf.layout import Grid, Site, read_folder, write_folder
from move_base_abstract_mapf.movingai import Problem, is_free, read_map, read_problems
from move_base_abstract_mapf.plans import make_plan, read_plan, written

FOLDER = Path(__file__).parent / 'movingai'
STEPS = ((1, 0), (-1, 0), (0, 1), (0, -1))


def open_grid(columns, rows, size=1.0):
    return Grid(np.zeros((rows, columns), bool), size)


def site_of(folder, grid, plan, settings=None, seconds=1.0):
    """Return the Site of a folder in which robots stand where the paths of a plan begin."""
    problems = [Problem(path[0], path[-1]) for path in plan.paths]
    write_folder(str(folder), grid, problems, seconds, 'a test')
    if settings:
        path = folder / 'scenario.yaml'
        raw = yaml.safe_load(path.read_text())
        raw['defaults'].update(settings)
        path.write_text(yaml.safe_dump(raw))
    return read_folder(str(folder))


def prioritized(blocked, problems):
    """Return paths without conflicts, one robot after the other: breadth first in cells and steps."""
    taken, edges, parked, paths = set(), set(), {}, []
    for start, goal in problems:
        latest = max([step for cell, step in taken if cell == goal], default=-1)
        queue, before = deque([(start, 0)]), {(start, 0): None}
        while queue:
            cell, step = queue.popleft()
            if cell == goal and step > latest:
                break
            for dx, dy in (*STEPS, (0, 0)):
                other = (cell[0] + dx, cell[1] + dy), step + 1
                if (is_free(blocked, other[0]) and other not in before and other not in taken and step < 400
                        and (other[0], cell, step) not in edges and step + 1 < parked.get(other[0], math.inf)):
                    before[other] = cell, step
                    queue.append(other)
        else:
            continue  # in the way of those before: this one is left out
        path, at = [], (cell, step)
        while at is not None:
            path.append(at[0])
            at = before[at]
        path.reverse()
        taken.update((cell, step) for step, cell in enumerate(path))
        edges.update((one, other, step) for step, (one, other) in enumerate(zip(path, path[1:])))
        parked[goal] = len(path) - 1
        paths.append(path)
    return paths


def crossing(seed, robots, columns=12, rows=9):
    """Return (blocked, paths without conflicts) of robots that cross a small hall with pillars."""
    draw = random.Random(seed)
    blocked = np.zeros((rows, columns), bool)
    blocked[2::3, 2::3] = True
    free = [(column, row) for row in range(rows) for column in range(columns) if not blocked[row, column]]
    starts, goals = draw.sample(free, robots), draw.sample(free, robots)
    paths = prioritized(blocked, zip(starts, goals))
    assert len(paths) > robots // 2
    return blocked, paths


def wandering(draw, columns, rows, robots, steps):
    """Return paths that care for nobody."""
    paths = []
    for _ in range(robots):
        path = [(draw.randrange(columns), draw.randrange(rows))]
        for _ in range(draw.randrange(1, steps)):
            x, y = path[-1]
            dx, dy = draw.choice((*STEPS, (0, 0)))
            path.append((x + dx, y + dy) if 0 <= x + dx < columns and 0 <= y + dy < rows else (x, y))
        paths.append(path)
    return paths


def brute_force(plan):
    """Return (vertex, swap) conflicts by looking at all pairs at all steps, and (meetings in a cell, swaps)."""
    steps = range(max(plan.costs) + 1)
    vertex = swap = meetings = 0
    for one, other in combinations(range(len(plan.paths)), 2):
        met = None
        for step in steps:
            a, b = plan.at(one, step), plan.at(other, step)
            vertex += a == b
            meetings += a == b and met != a
            met = a if a == b else None
            swap += bool(step) and a != b and (plan.at(one, step - 1), plan.at(other, step - 1)) == (b, a)
    return vertex, swap, meetings


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('policy', [AS_TIMED, ORDER_KEPT])
@pytest.mark.parametrize('size, seconds, rounding', [(1.0, 1.0, 0.0), (0.3, 0.7, 1e-5)])
def test_a_plan_without_delays_takes_as_long_as_its_solver_says(tmp_path, seed, policy, size, seconds, rounding):
    blocked, paths = crossing(seed, 14)
    plan = make_plan(paths, 'plan', blocked)
    assert plan_conflicts(plan) == (0, 0)
    found = drive(site_of(tmp_path, Grid(blocked, size), plan, seconds=seconds), plan, policy).outcome(0.7 * size)
    assert found.flow_time == pytest.approx(sum(map(len, paths)) - len(paths), abs=rounding, rel=0.0)
    assert found.makespan == pytest.approx(max(map(len, paths)) - 1, abs=rounding, rel=0.0)
    assert (found.vertex_conflicts, found.swap_conflicts, found.near_pairs, found.retries) == (0, 0, 0, 0)


@pytest.mark.parametrize('seed', range(30))
def test_conflicts_are_those_of_brute_force_at_all_steps(tmp_path, seed):
    draw = random.Random(seed)
    plan = make_plan(wandering(draw, 4, 3, 5, 14), 'plan')
    vertex, swap, meetings = brute_force(plan)
    assert plan_conflicts(plan) == (vertex, swap)
    done = drive(site_of(tmp_path, open_grid(4, 3), plan), plan, AS_TIMED)
    assert len(vertex_conflicts(done.execution.visits())) == meetings
    assert len(swap_conflicts(move for moves in done.execution.done for move in moves)) == swap


@pytest.mark.parametrize('seed', range(20))
def test_distances_are_those_of_many_samples(seed):
    draw = random.Random(seed)
    pieces = []
    for robot in range(4):
        time, place = 0.0, (draw.uniform(0, 4), draw.uniform(0, 4))
        for _ in range(6):
            other, until = (draw.uniform(0, 4), draw.uniform(0, 4)), time + draw.choice([0.3, 1.0, 5.0])
            pieces.append(Piece(robot, time, until, place, other))
            time, place = until, other
    found = nearest(pieces, 0.8, draw.choice([0.5, 1.0, 7.0]))
    sampled = {}
    for one, other in combinations(pieces, 2):
        begin, end = max(one.begin, other.begin), min(one.end, other.end)
        if one.robot != other.robot and begin < end:
            times = np.linspace(begin, end, 4001)
            (ax, bx), (ay, by) = ([np.interp(times, [piece.begin, piece.end], [piece.start[k], piece.goal[k]])
                                   for piece in (one, other)] for k in (0, 1))
            pair = min(one.robot, other.robot), max(one.robot, other.robot)
            sampled[pair] = min(sampled.get(pair, math.inf), np.hypot(ax - bx, ay - by).min())
    for pair, distance in sampled.items():
        if distance < 0.79:
            assert found[pair] == pytest.approx(distance, abs=0.01)
        elif distance > 0.81:
            assert pair not in found


@pytest.mark.parametrize('policy', POLICIES)
def test_robots_that_turn_in_a_circle_go_together_and_wait_for_ever_where_cells_must_be_left(tmp_path, policy):
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    plan = make_plan([[ring[k], ring[(k + 1) % 4]] for k in range(4)], 'plan')
    found = drive(site_of(tmp_path, open_grid(2, 2), plan), plan, policy).outcome(0.5)
    if policy == CELL_LEFT:
        assert found.arrived == 0 and found.flow_time is None
        assert found.waits_for == {'agent_{}'.format(k): 'agent_{}'.format((k + 1) % 4) for k in range(4)}
    else:
        assert (found.flow_time, found.makespan, found.vertex_conflicts, found.waits_for) == (4, 1, 0, {})


def test_cells_that_must_be_left_cost_a_step_for_each_who_follows(tmp_path):
    plan = make_plan([[(k, 0), (k + 1, 0)] for k in range(4)], 'plan')
    found = drive(site_of(tmp_path, open_grid(5, 1), plan), plan, CELL_LEFT).outcome(0.5)
    assert (found.flow_time, found.makespan) == (1 + 2 + 3 + 4, 4)


DELAYS = {'duration_factor': 1.6, 'duration_distribution': 'lognormal', 'duration_cv': 0.8, 'goal_overhead': 0.1}
FAILURES = {'failure_kind': 'abort', 'failures_per_hour': 120.0, 'repair_time': 6.0, 'failure_by_length': [[0.0, 0.05]]}


@pytest.mark.parametrize('delays', [DELAYS, FAILURES], ids=['durations', 'failures'])
@pytest.mark.parametrize('seed', range(3))
def test_with_delays_the_order_of_the_plan_keeps_robots_apart_and_their_own_clocks_do_not(tmp_path, seed, delays):
    blocked, paths = crossing(seed, 20)
    plan = make_plan(paths, 'plan', blocked)
    conflicts = {}
    for policy in POLICIES:
        done = drive(site_of(tmp_path / policy, Grid(blocked, 1.0), plan, delays), plan, policy)
        found = done.outcome(0.7)
        assert found.arrived == found.agents
        assert found.flow_time > found.planned_flow_time
        conflicts[policy] = found.vertex_conflicts + found.swap_conflicts
        if policy != AS_TIMED:
            _check_order(plan, done.execution)
    assert conflicts[ORDER_KEPT] == conflicts[CELL_LEFT] == 0
    assert conflicts[AS_TIMED] > 0


def _check_order(plan, execution):
    """Each cell was visited in the order of the plan."""
    wanted, seen = {}, {}
    for robot, path in enumerate(plan.paths):
        came = [(0, path[0]), *((step, cell) for step, (before, cell) in enumerate(zip(path, path[1:]), 1)
                                if before != cell)]
        for step, cell in came:
            wanted.setdefault(cell, []).append((step, robot))
    for visit in execution.visits():
        seen.setdefault(visit.cell, []).append((visit.arrive_ns, visit.robot))
    assert {cell: [robot for _, robot in sorted(visits)] for cell, visits in wanted.items()} == {
        cell: [robot for _, robot in sorted(visits)] for cell, visits in seen.items()}


LACAM = """agents=2
map_file=room.map
solver=planner
solved=1
soc=5
makespan=3
comp_time=0.25
seed=0

starts=(0,0),(3,2),
goals=(1,1),(2,2),
solution=
"""
LACAM_STEPS = '0:(0,0),(3,2),\n1:(1,0),(3,2),\n2:(1,0),(2,2),\n3:(1,1),(2,2),\n'


def test_all_formats_say_the_same_and_what_is_written_is_read(tmp_path):
    paths = [[(0, 0), (1, 0), (1, 0), (1, 1)], [(3, 2), (3, 2), (2, 2)]]
    plan = make_plan(paths, 'plan')
    (tmp_path / 'a.txt').write_text('Agent 0: (0,0)->(0,1)->(0,1)->(1,1)->\nAgent 1: (2,3)->(2,3)->(2,2)->(2,2)->\n')
    (tmp_path / 'b.yaml').write_text(yaml.safe_dump({'statistics': {'cost': 5}, 'schedule': {
        'agent0': [{'x': 0, 'y': 0, 't': 0}, {'x': 1, 'y': 0, 't': 1}, {'x': 1, 'y': 1, 't': 3}],
        'agent1': [{'x': 3, 'y': 2, 't': 0}, {'x': 3, 'y': 2, 't': 1}, {'x': 2, 'y': 2, 't': 2}]}}))
    (tmp_path / 'c.txt').write_text(written(plan))
    (tmp_path / 'd.txt').write_text(LACAM + LACAM_STEPS)
    assert [read_plan(str(tmp_path / name)) for name in ('a.txt', 'b.yaml', 'c.txt', 'd.txt')] == [plan] * 4
    assert plan.costs == [3, 2]


@pytest.mark.parametrize('text, told', [
    ('', 'schedule'), ('Agent 1: (0,0)->\n', ':1:'), ('Agent 0: (0,0)->(0,2)\n', 'neighbours'),
    ('Agent 0: (0,0)->(1,1)\n', 'neighbours'), ('Agent 0: (0,x)\n', ':1:'), ('Agent 0: (9,9)\n', 'free cells'),
    ('schedule: {agent0: 3}\n', 'agent0'), ('schedule: {agent1: []}\n', 'agent0 is missing'),
    ('schedule: {}\n', 'no path'), ('schedule: {agent0: [{x: 0, y: 0, t: 1}]}\n', 't: got 1'),
    ('schedule: {agent0: [{x: 0, y: 0, t: 0}, {x: 0, y: 0, t: 99999999}]}\n', 'whole numbers'),
    (LACAM[:40], 'solution='), (LACAM, 'no path'), (LACAM + '1:(0,0),(1,1),\n', ':13: .* allowed: 0:'),
    (LACAM + '0:(0,0),(1,1),\n1:(0,0),\n', ':14: .* each agent'), (LACAM + '0:(0,0),(1,1),\nx\n', ':14:'),
    (LACAM + '0:(0,0),(2,2),\n1:(1,1),(2,2),\n', 'neighbours'), (LACAM + LACAM_STEPS, 'free cells'),
    ('Agent 0: ' + '(0,0) ' * 5000 + 'x', ':1:'),
    ('schedule: {agent0: [{x: true, y: 0, t: 0}]}\n', 'whole numbers'), ('schedule: {1: [], 2: []}\n', 'schedule')])
def test_what_is_no_plan_is_an_error_that_says_where(tmp_path, text, told):
    (tmp_path / 'plan').write_text(text)
    with pytest.raises(ConfigurationError, match='plan.*' + told):
        read_plan(str(tmp_path / 'plan'), np.zeros((3, 3), bool))


@pytest.mark.parametrize('text, told', [
    ('type octile\nheight 2\nwidth 2\nmap\n..\n', '1 rows'), ('type octile\nheight 1\nwidth 2\nmap\n.x\n', ':5:'),
    ('height 1\nwidth 99999999\nmap\n.\n', 'width'), ('hello\n', ':1:'), ('type octile\nmap\n', 'height')])
def test_what_is_no_map_is_an_error_that_says_where(tmp_path, text, told):
    (tmp_path / 'a.map').write_text(text)
    with pytest.raises(ConfigurationError, match=told):
        read_map(str(tmp_path / 'a.map'))


def run(*words):
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return ended.value.code


def test_the_command_makes_a_scenario_drives_a_plan_and_tells_what_has_come_of_it(tmp_path, capsys):
    grid, problems = FOLDER / 'boxes.map', FOLDER / 'boxes.scen'
    folder, log, figures = tmp_path / 'site', tmp_path / 'run.jsonl', tmp_path / 'out.json'
    assert run('import', grid, problems, '--agents', 5, '--out', folder) == 0
    paths = prioritized(read_map(grid), read_problems(problems)[:5])
    (tmp_path / 'plan.txt').write_text(written(make_plan(paths, 'plan')))
    words = ('run', folder, tmp_path / 'plan.txt', '--goals', problems, '--log', log, '--json', figures)
    assert run(*words) == 0
    assert run(*words) == 0  # what it made is replaced
    told = json.loads(figures.read_text())
    assert (told['policy'], told['arrived'], told['flow_time']) == (ORDER_KEPT, 5, sum(map(len, paths)) - 5)
    (tmp_path / 'few.scen').write_text(''.join(problems.read_text().splitlines(True)[:4]))
    assert run(*words, '--goals', tmp_path / 'few.scen') == 2
    assert 'few.scen has 3 problems; allowed: at least 5, one for each path' in capsys.readouterr().err
    lines = [line.split('\t') for line in problems.read_text().splitlines()]
    lines[1][6:8] = lines[2][6:8]  # the goal of another robot
    (tmp_path / 'moved.scen').write_text('\n'.join(map('\t'.join, lines)))
    assert run(*words, '--goals', tmp_path / 'moved.scen') == 2
    assert 'agent 0: its path ends at column' in capsys.readouterr().err
    assert run(*words) == 0
    assert 'sum of costs' in capsys.readouterr().out
    assert log.read_text().startswith('{"event_log":1')
    (tmp_path / 'plan.txt').write_text(written(make_plan(paths[::-1], 'plan')))
    assert run(*words) == 2
    assert 'agent 0: its path begins at column' in capsys.readouterr().err
    assert run('run', folder, tmp_path / 'plan.txt') == 2
    assert 'agent_0: the plan begins at' in capsys.readouterr().err
    assert run('import', grid, problems, '--agents', 99, '--out', folder) == 2
    for word, value, told in (('--cell', '1e308', 'start_x: got inf'), ('--step', '1e-320', 'max_speed: got inf')):
        assert run('import', grid, problems, '--agents', 5, '--out', tmp_path / 'far', word, value) == 2
        assert told in capsys.readouterr().err
    assert not (tmp_path / 'far').exists()
    (tmp_path / 'other.map').write_text(grid.read_text())
    assert run('import', tmp_path / 'other.map', problems, '--agents', 5, '--out', folder) == 2
    assert re.search(r"boxes.scen:2: got .*; allowed: problems for 'other.map'", capsys.readouterr().err)
    (folder / 'mine.txt').write_text('x')
    assert run('import', grid, problems, '--agents', 5, '--out', folder) == 2


@pytest.mark.parametrize('call, text', [
    (lambda: drive('site', None, 'as_timed'), "site: got 'site'; allowed: a Site, as read_folder(folder) returns it"),
    (lambda: drive(Site(None, None, 1), 'plan', 'as_timed'), "plan: got 'plan'; allowed: a Plan, as read_plan(path)"),
    (lambda: drive(Site(None, None, 1), make_plan([[(0, 0)]], 'x'), 'as-timed'),
     "policy: got 'as-timed'; allowed: as_timed, order_kept, cell_left"),
    (lambda: read_folder(3), 'folder: got 3; allowed: the path of a file'),
    (lambda: read_plan(3), 'path: got 3; allowed: the path of a file')])
def test_an_object_of_another_kind_is_refused_at_the_call(call, text):
    with pytest.raises(ConfigurationError) as error:
        call()
    assert text in str(error.value)
