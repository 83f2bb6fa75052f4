"""Robots on tiny nets with room for one robot everywhere: who can arrive by an exhaustive search, and who does."""
import json
import os
import shutil
import subprocess

import pytest
import yaml
from night import times

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario
from moves_in_log import counted_wrongly, met
from tiny_nets import APART, ZONE, Instance, instance, is_solvable

NO_WAY = (1_000_000_000, 'There is no order of moves in which these robots all come to their goals')
_CBS = shutil.which('cbs')


def run(one, folder, has_zones=False):
    """Let all robots of an instance drive to their goals; return (the fleet, what its log shows to be wrong)."""
    lanes, log = folder / 'net.yaml', folder / 'run.jsonl'
    lanes.write_text(yaml.safe_dump(one.net(**({} if has_zones else {'node_capacity': 1}))))
    fleet = Fleet(make_scenario(one.scenario(lanes, has_zones, deadlock='avoid')))
    for name, (_, goal) in one.robots.items():
        x, y = one.nodes[goal]
        fleet.robot(name).send(APART * x, APART * y)
    fleet.run(until=10_000.0)
    fleet.write_log(log)
    nodes = {name: (APART * x, APART * y) for name, (x, y) in one.nodes.items()}
    found, last = met(log, {name: nodes[start] for name, (start, _) in one.robots.items()}, nodes, one.edges, ZONE)
    for row in map(json.loads, log.read_text().splitlines()):
        if row.get('kind') == 'ended' and row['values'][1] == 'SUCCEEDED':
            goal = nodes[one.robots[row['robot']][1]]
            if max(abs(a - b) for a, b in zip(last[row['robot']], goal)) > 1e-6:
                found.append(f"{row['robot']} is said to be at {goal}, and is at {last[row['robot']]}")
    return fleet, [*counted_wrongly(log), *found]


def is_solved(fleet):
    return all(not robot.navigator.is_active for robot in fleet.robots) and [
        entry.values[1] for entry in fleet.trace if entry.kind == 'ended'] == ['SUCCEEDED'] * len(fleet.robots)


# 369 and 1155: robots that turn round at the end of the lane on which the search finds them
@pytest.mark.parametrize('seed', [*range(times(50, 2000)), *times([369, 1155], [])])
def test_all_robots_arrive_where_there_is_a_way_and_it_is_said_at_once_where_there_is_none(seed, tmp_path):
    one = instance(seed)
    fleet, wrong = run(one, tmp_path)
    assert not wrong
    assert is_solved(fleet) == is_solvable(one)
    assert is_solvable(one) == (NO_WAY not in [(warning.time_ns, warning.text[:len(NO_WAY[1])])
                                               for warning in fleet.warnings])


@pytest.mark.parametrize('seed', range(times(25, 500)))
def test_all_robots_arrive_where_there_is_a_way_if_zones_are_their_places(seed, tmp_path):
    """Here they may arrive elsewhere, too: a robot that waits at the border of a zone stands on its lane."""
    one = instance(seed)
    fleet, wrong = run(one, tmp_path, has_zones=True)
    assert not wrong
    assert is_solved(fleet) or not is_solvable(one)


def test_the_search_knows_that_two_robots_cannot_pass_each_other_in_a_corridor():
    corridor = Instance({'A': (0, 0), 'J': (1, 0), 'B': (2, 0)}, [('A', 'J'), ('J', 'B')],
                        {'r0': ('A', 'B'), 'r1': ('B', 'A')}, False)
    siding = corridor._replace(nodes={**corridor.nodes, 'S': (1, 1)}, edges=[*corridor.edges, ('J', 'S')])
    assert not is_solvable(corridor)
    assert is_solvable(siding)
    assert not is_solvable(siding._replace(robots={**siding.robots, 'r2': ('S', 'S')}))


@pytest.mark.parametrize('goal, texts', [
    ('J', ['r0 and r1 are both in J']),
    ('B', ["r0 and r1 are both in ('J', 'B')", 'r1 and r0 pass one another between B and J'])])
def test_robots_that_pass_through_one_another_are_found(goal, texts, tmp_path):
    """Nothing counts the robots here, so they drive through one another: the positions show it, the rows do not."""
    nodes, edges = {'A': (0, 0), 'J': (1, 0), 'B': (3, 0)}, [('A', 'J'), ('J', 'B')]
    one = Instance(nodes, edges, {'r0': ('A', goal), 'r1': ('B', 'A')}, False)
    (tmp_path / 'net.yaml').write_text(yaml.safe_dump(
        {**one.net(), 'edges': [{'from': begin, 'to': end} for begin, end in edges]}))
    fleet = Fleet(make_scenario(one.scenario(tmp_path / 'net.yaml', has_zones=False)))
    for name, (_, end) in one.robots.items():
        fleet.robot(name).send(APART * nodes[end][0], 0.0)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    assert not counted_wrongly(tmp_path / 'run.jsonl')
    found, _ = met(tmp_path / 'run.jsonl', {'r0': (0.0, 0.0), 'r1': (30.0, 0.0)},
                   {name: (APART * x, 0.0) for name, (x, _) in nodes.items()}, edges, ZONE)
    for text in texts:
        assert any(text in one for one in found), found


def test_a_place_that_holds_too_many_by_the_rows_is_found(tmp_path):
    rows = [('r0', 'places', 'zone gate', 1), ('r0', 'entered', 'zone gate'), ('r1', 'entered', 'zone gate')]
    (tmp_path / 'run.jsonl').write_text('\n'.join(json.dumps(
        {'time_ns': 1, 'robot': robot, 'kind': kind, 'values': values}) for robot, kind, *values in rows))
    assert counted_wrongly(tmp_path / 'run.jsonl') == ["1: ['r0', 'r1'] hold places in zone gate"]


def _by_cbs(one, folder):
    """Return [{robot: (x, y)}, ...], step by step, by cbs of libMultiRobotPlanning; None: it found nothing in time."""
    cells = {cell: name for name, cell in one.nodes.items()}
    size = [1 + max(cell[axis] for cell in cells) for axis in (0, 1)]
    (folder / 'in.yaml').write_text(yaml.safe_dump({
        'map': {'dimensions': size, 'obstacles': [[x, y] for x in range(size[0]) for y in range(size[1])
                                                  if (x, y) not in cells]},
        'agents': [{'name': name, 'start': list(one.nodes[start]), 'goal': list(one.nodes[goal])}
                   for name, (start, goal) in one.robots.items()]}))
    try:
        subprocess.run([_CBS, '-i', folder / 'in.yaml', '-o', folder / 'out.yaml'], timeout=2.0, check=False,
                       stdout=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return None
    if not os.path.exists(folder / 'out.yaml'):
        return None
    schedule = yaml.safe_load((folder / 'out.yaml').read_text())['schedule']
    steps = 1 + max(stop['t'] for stops in schedule.values() for stop in stops)
    return [{name: next((stop['x'], stop['y']) for stop in reversed(stops) if stop['t'] <= step)
             for name, stops in schedule.items()} for step in range(steps)]


def _go_round(before, after):
    """Return whether robots all move at once round a circle of nodes that is full of them."""
    moved = {before[name]: after[name] for name in before if before[name] != after[name]}
    return any(cell in moved and _comes_back(cell, moved) for cell in moved)


def _comes_back(begin, moved):
    cell = moved[begin]
    while cell in moved and cell != begin:
        cell = moved[cell]
    return cell == begin


@pytest.mark.skipif(_CBS is None, reason='cbs of libMultiRobotPlanning is not on the PATH')
@pytest.mark.parametrize('seed', range(0, times(50, 400), 2))
def test_what_cbs_solves_the_search_solves_too(seed, tmp_path):
    """Cbs lets one robot into the node that another one leaves in the same step, so full circles may go round."""
    one = instance(seed)
    steps = _by_cbs(one, tmp_path)
    if steps is None:
        pytest.skip('cbs found nothing in 2 s; it does not end where there is no way')
    assert is_solvable(one, stays=False) or any(map(_go_round, steps, steps[1:]))
