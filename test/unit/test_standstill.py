"""A fleet that becomes quiet with an open goal: each reason for which a robot waits is known, and each circle is named.

The cases are small nets that once stood still without a row or a warning; the others are drawn (small_worlds).
"""
import json

import pytest
from night import times

from move_base_abstract.fleet import Fleet
from move_base_abstract.properties import Run, judge
from move_base_abstract.scenario import make_scenario
from move_base_abstract.traffic.circles import Circles
from move_base_abstract.traffic.control import Traffic
from move_base_abstract.traffic.traveller import Traveller
from move_base_abstract.traffic.waiting import WaitingGraph, reasons_of
from move_base_abstract.traffic.ways_out import WaysOut
from small_worlds import LargeWorld, SmallWorld
from traces import rows


def run(folder, nodes, edges, robots, goals, until=None, **raw):
    """Run robots ({name: (node, further settings)}) from goal to goal ({name: [node, ...]}); return the Fleet."""
    (folder / 'net.yaml').write_text(json.dumps({
        'nodes': [{'name': name, 'x': x, 'y': y} for name, (x, y) in nodes.items()],
        'edges': [{'from': one, 'to': other, **more} for one, other, more in edges]}))
    left = {name: list(own) for name, own in goals.items()}

    def send(name, *_):
        if left[name]:
            fleet.robot(name).send(*nodes[left[name].pop(0)])
    fleet = Fleet(make_scenario({
        'defaults': {'routes': 'lanes'}, 'lanes': str(folder / 'net.yaml'), **raw,
        'robots': [{'name': name, 'start_x': nodes[node][0], 'start_y': nodes[node][1], **more}
                   for name, (node, more) in robots.items()]}), on_end=send)
    for name in goals:
        send(name)
    fleet.run(until=until)
    return fleet


def test_a_careful_robot_that_is_kept_out_of_a_free_lane_is_no_standstill(tmp_path):
    one = {'capacity': 1}
    nodes = {'n0': (10.0, 0.0), 'n1': (3.1, 9.5), 'n2': (-8.1, 5.9), 'n3': (-8.1, -5.9), 'n4': (3.1, -9.5),
             'c': (0.0, 0.0)}
    edges = [('n0', 'n1', {**one, 'group': 'g0'}), ('n1', 'n2', one), ('n2', 'n3', {}),
             ('n4', 'n0', {**one, 'group': 'g0'}), ('c', 'n2', {})]
    robots = {name: (node, {'max_speed': 1.0}) for name, node in (
        ('r_1', 'n3'), ('r_2', 'n4'), ('r_4', 'n1'), ('r_5', 'n2'), ('r_6', 'n4'))}
    goals = {'r_1': ['n1', 'n4', 'n2'], 'r_2': ['c', 'n0'], 'r_4': ['n4'], 'r_5': ['n0', 'n4'], 'r_6': ['n3']}
    fleet = run(tmp_path, nodes, edges, robots, goals, deadlock='retreat', groups={'g0': 2})
    assert [row[4] for row in rows(fleet, 'ended')] == ['SUCCEEDED'] * 9
    assert len(rows(fleet, 'deadlock')) == len(rows(fleet, 'gave_way')) > 0


def test_a_refusal_because_others_would_be_cut_off_is_a_reason_that_these_end(tmp_path):
    nodes = {str(number): (10.0 * number, 0.0) for number in range(4)}
    edges = [(str(number), str(number + 1), {'capacity': 1}) for number in range(3)]
    robots = {'a': ('0', {'max_speed': 1.0}), 'b': ('3', {'max_speed': 1.0})}
    fleet = run(tmp_path, nodes, edges, robots, {'a': ['3'], 'b': ['0']}, until=5.0, deadlock='avoid')
    against = fleet.traffic.against
    request, = [one.request for one in fleet.traffic.travellers() if one.request is not None]
    reason, = reasons_of(request, against)
    assert (request.traveller.name, reason.area.name, reason.needed, reason.is_unsafe) == ('b', 'lane 2 - 3', 1, True)
    assert [one.name for one in reason.robots] == ['a']
    assert not WaitingGraph((request,), against).stuck


@pytest.mark.parametrize('seed', [10, 34, 37, 52])
def test_no_robot_gives_way_for_ever_because_a_free_place_was_counted_that_its_queue_keeps_it_out_of(tmp_path, seed):
    world = LargeWorld(seed, tmp_path)
    fleet = world.run(until=20_000.0)
    assert len(rows(fleet, 'ended')) == 6 * len(world.robots)  # to some goals there is no way


def test_who_may_overtake_is_asked_when_an_area_ahead_of_the_first_in_the_queue_fills(tmp_path):
    one, way, group = {'capacity': 1}, {'one_way': True}, {'group': 'g0'}
    nodes = {'n0': (10.0, 0.0), 'n1': (5.0, 8.7), 'n2': (-5.0, 8.7), 'n3': (-10.0, 0.0), 'n4': (-5.0, -8.7),
             'n5': (5.0, -8.7), 'c': (0.0, 0.0)}
    edges = [('n0', 'n1', way), ('n1', 'n2', group), ('n2', 'n3', {**one, **way, **group}), ('n3', 'n4', one),
             ('n5', 'n0', group), ('c', 'n0', one), ('c', 'n3', {**way, **group}), ('c', 'n4', group)]
    robots = {'r_0': ('n2', {'max_speed': 2.0, 'priority': 1}), 'r_1': ('n1', {'max_speed': 0.5}),
              'r_3': ('n5', {'max_speed': 0.5}), 'r_4': ('n1', {'max_speed': 1.0}), 'r_5': ('n2', {'max_speed': 1.0}),
              'r_6': ('n0', {'max_speed': 0.5, 'priority': 1})}
    goals = {'r_0': ['n2', 'n3', 'n2'], 'r_1': ['n3'], 'r_3': ['n3'], 'r_4': ['n0'], 'r_5': ['c'], 'r_6': ['c', 'n3']}
    fleet = run(tmp_path, nodes, edges, robots, goals, blocks=3, groups={'g0': 2})
    assert [row[4] for row in rows(fleet, 'ended')] == ['SUCCEEDED'] * 9


CROSSING = [{'name': 'west', 'rectangle': [2.0, -1.0, 4.0, 1.0], 'capacity': 1},
            {'name': 'east', 'rectangle': [4.0, -1.0, 6.0, 1.0], 'capacity': 1}]


def meet(folder, policy):
    """Let a robot from the west and one from the east meet; return (their Fleet, how often no_standstill is broken)."""
    fleet = Fleet(make_scenario({'zones': CROSSING, 'deadlock': policy, 'robots': [
        {'name': 'a', 'max_speed': 1.0}, {'name': 'b', 'start_x': 8.0, 'max_speed': 1.0}]}), start_ns=0)
    fleet.robot('a').send(8.0, 0.0)
    fleet.robot('b').send(0.0, 0.0)
    fleet.run()
    fleet.write_log(folder / 'run.jsonl')
    broken = [one.property for one in judge(Run(str(folder / 'run.jsonl')))]
    return fleet, broken.count('no_standstill')


@pytest.mark.parametrize('policy', ['wait', 'abort', 'avoid', 'retreat'])
def test_a_circle_that_nobody_has_seen_to_close_is_named_when_the_fleet_becomes_quiet(tmp_path, monkeypatch, policy):
    monkeypatch.setattr(Circles, 'look', lambda *_: None)
    monkeypatch.setattr(Traveller, 'is_careful', property(lambda _: False, lambda *_: None), raising=False)
    fleet, broken = meet(tmp_path, policy)
    circle = (4.0, 'b', 'deadlock', 'a', 'zone east', 'b', 'zone west')
    assert rows(fleet, 'deadlock')[:1] == [circle]
    assert len(fleet.warnings) == len(rows(fleet, 'deadlock'))
    assert broken == (policy in ('wait', 'avoid'))
    ends = {'abort': ['ABORTED'], 'retreat': ['SUCCEEDED', 'SUCCEEDED']}
    assert [row[4] for row in rows(fleet, 'ended')] == ends.get(policy, [])


def test_a_robot_that_waits_for_nothing_is_named_when_the_fleet_becomes_quiet(tmp_path, monkeypatch):
    monkeypatch.setattr(Traffic, 'freed', lambda *_: None)
    fleet = Fleet(make_scenario({'zones': CROSSING[:1], 'robots': [
        {'name': 'a', 'max_speed': 1.0}, {'name': 'b', 'max_speed': 1.0, 'start_x': -1.0}]}), start_ns=0)
    for name in 'ab':
        fleet.robot(name).send(8.0, 0.0)
    fleet.run(until=100.0)
    assert rows(fleet, 'deadlock') == [(8.0, 'b', 'deadlock', 'b', 'zone west')]
    assert 'although nothing keeps it out' in fleet.warnings[-1].text
    fleet.write_log(tmp_path / 'run.jsonl')
    assert [one.property for one in judge(Run(str(tmp_path / 'run.jsonl')))] == ['no_standstill', 'every_goal_ends']


def test_a_robot_that_no_way_out_of_a_jam_lets_go_on_is_no_error_of_ours(monkeypatch):
    monkeypatch.setattr(WaysOut, 'allows', lambda *_: False)
    fleet = Fleet(make_scenario({'zones': CROSSING, 'deadlock': 'avoid', 'robots': [
        {'name': 'a', 'start_x': 3.0, 'max_speed': 1.0}]}), start_ns=0)
    fleet.robot('a').send(8.0, 0.0)
    fleet.run()
    assert rows(fleet, 'deadlock') == [(1.0, 'a', 'deadlock', 'a', 'zone east')]
    assert [one.text for one in fleet.warnings] == [
        'Robots wait for one another in a circle: a for zone east, which would cut a off.']


def test_a_robot_that_waits_for_one_that_stands_without_a_goal_is_no_standstill():
    fleet = Fleet(make_scenario({'zones': CROSSING, 'robots': [
        {'name': 'a', 'max_speed': 1.0}, {'name': 'b', 'start_x': 5.0}]}), start_ns=0)
    fleet.robot('a').send(8.0, 0.0)
    fleet.run()
    assert rows(fleet, 'held') and not rows(fleet, 'deadlock') and not fleet.warnings


@pytest.mark.parametrize('part', range(10))
def test_whoever_stands_in_a_quiet_fleet_waits_in_a_named_circle_or_for_a_robot_without_a_goal(tmp_path, part):
    count = times(500, 20_000) // 10
    also = times([7654, 18906], []) if part == 0 else []  # ways lead into another zone after they left all
    for seed in [*range(part * count, (part + 1) * count), *also]:
        fleet = SmallWorld(seed, tmp_path).run(until=20_000.0)
        assert not fleet.simulation.queue.is_busy(), seed
        assert fleet.traffic.ways_out._moves is None, seed  # moves that nobody can begin with any more have ended
        waiting = [one.request for one in fleet.traffic._travellers if one.request is not None]
        names = [one.traveller.name for one in waiting]
        assert names == [robot.name for robot in fleet.robots if robot.navigator.is_active], seed
        if not waiting:
            continue
        against = fleet.traffic.against
        assert all(list(reasons_of(request, against)) for request in waiting), seed  # nobody was forgotten
        fleet.write_log(tmp_path / 'run.jsonl')
        named = [one for one in judge(Run(str(tmp_path / 'run.jsonl'))) if one.property == 'no_standstill']
        stuck = WaitingGraph(waiting, against).stuck
        holders = {name for area in fleet.zones if area.robots for name in area.robots if name not in names}
        assert bool(named) == bool(stuck) and (named or holders), seed
