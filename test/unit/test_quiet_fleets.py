"""A fleet with a dispatcher that becomes quiet: each goal and each order that is open then is named, and why it is."""
import json
import random

import pytest
from night import times

from dispatches import dispatch_of, order
from move_base_abstract.fleet import Dispatch, Fleet
from move_base_abstract.scenario import make_scenario
from move_base_abstract.traffic.traveller import Traveller
from small_worlds import SmallWorld
from traces import rows

S = 1_000_000_000


def last_text(dispatch):
    dispatch.run()
    return dispatch.fleet.warnings[-1].text


def of_all_kinds(seed, folder):
    """Return a Dispatch in a small world with nodes, places, chargers, batteries, failures and holds."""
    world, dice, path = SmallWorld(seed, folder), random.Random(seed), folder / 'net.yaml'
    net = json.loads(path.read_text())
    points = [(node['x'], node['y']) for node in net['nodes']]
    path.write_text(json.dumps({**net, **dice.choice([{}, {'node_capacity': dice.randint(1, 3)}])}))
    defaults = dice.choice([{}, {'battery_capacity': dice.choice([0.02, 0.2]), 'charging_current': 10.0}])
    failures = dice.choice([{}, {'failure_kind': dice.choice(['abort', 'stall', 'silent', 'stuck']),
                                 'failures_per_hour': 30.0}])  # nobody repairs them
    dispatch = Dispatch(make_scenario({
        **world.raw, 'seed': seed, 'robots': world.robots, 'defaults': {'routes': 'lanes', **defaults, **failures},
        'zones': [*world.raw.get('zones', ()), *(
            {'name': 'dock_{}'.format(number), 'rectangle': [x - 1.0, y - 1.0, x + 1.0, y + 1.0],
             'charger': True, 'capacity': dice.randint(1, 2)}
            for number, (x, y) in enumerate(dice.sample(points, dice.randint(0, 2))))],
        'places': [{'name': name, 'x': x, 'y': y, 'duration': 5.0, 'capacity': dice.randint(1, 2),
                    'preemption': dice.random() < 0.5, 'parking': dice.random() < 0.5}
                   for name, (x, y) in zip('pqr', dice.sample(points, 3))],
        'orders': [{'name': 'o', 'every': dice.choice([1.0, 7.0]), 'count': 12, 'stops': [
            {'place': dice.choice('pqr')} for _ in range(dice.randint(1, 3))]}],
        'dispatcher': {'policy': dice.choice(['nearest', 'earliest_deadline', 'auction']),
                       'park_when_idle': dice.random() < 0.5, **dice.choice([{}, {'charge_reserve': 0.1}])}}))
    for _ in range(dice.choice([0, 6])):
        name, at_s = dice.choice(dispatch.fleet.names), dice.randint(1, 60)
        dispatch.fleet.at(at_s * S, lambda fleet, name=name: fleet.robot(name).hold('break'))
        dispatch.fleet.at((at_s + 30) * S, lambda fleet, name=name: fleet.robot(name).release('break'))
    return dispatch


@pytest.mark.parametrize('part', range(4))
def test_each_open_goal_and_order_is_named_with_its_reason(tmp_path, part):
    count = times(24, 1_200) // 4
    for seed in range(part * count, (part + 1) * count):
        dispatch = of_all_kinds(seed, tmp_path)
        dispatch.run()
        fleet, texts = dispatch.fleet, list(dispatch.core.undone(dispatch._what_holds))
        assert not any('which waits' in text or 'error of move_base_abstract' in text for text in texts), seed
        assert not texts or texts[0] in fleet.warnings[-1].text, seed
        assert not [one for one in fleet.robots if one._tasks.ledger.active is not None], seed
        for robot in fleet.robots:
            if robot.navigator.is_active and not robot.condition.is_out_of_order:
                named = [text for text in texts if robot.name in text.split(', ')[0]]
                assert len(named) == 1 and ', held for ' in named[0], seed


def test_it_is_said_why_nobody_does_an_order(tmp_path):
    (tmp_path / 'net.yaml').write_text(json.dumps({
        'nodes': [{'name': str(x), 'x': float(x), 'y': 0.0} for x in range(4)],
        'edges': [{'from': '0', 'to': '1', 'one_way': True}, {'from': '2', 'to': '3', 'one_way': True}]}))

    class OfNone:
        def choose(self, question):
            return []
    lanes = {'routes': 'lanes', 'lanes': str(tmp_path / 'net.yaml')}
    docks = [{'name': 'dock_{}'.format(x), 'rectangle': [x - 1.0, -1.0, x + 1.0, 1.0], 'charger': True}
             for x in (0, 400)]  # only from the far one the charge is enough
    for dispatch, point, why in (
            (dispatch_of(robots=1, **lanes), (3.0, 0.0), 'no free robot has a way to its stops'),
            (dispatch_of(robots=1, policy=OfNone()), (3.0, 0.0), 'the policy chose no robot'),
            (dispatch_of(robots=0), (3.0, 0.0), 'no robot is free'),
            (dispatch_of(robots=1, zones=docks, dispatcher={'charge_reserve': 0.05}, friction_coefficient=0.5,
                         battery_capacity=3.1), (250.0, 0.0), 'no free robot has the charge for it')):
        dispatch.order(order('o', point))
        assert last_text(dispatch) == 'Nothing is left to happen, but this is not done: o with nobody, ' + why


def test_a_robot_that_cannot_get_to_its_parking_place_is_named_and_who_stands_in_its_way():
    gate = {'name': 'gate', 'rectangle': [4.0, -1.0, 6.0, 1.0], 'capacity': 1}
    dispatch = dispatch_of(robots=1, zones=[gate], places=[{'name': 'lot', 'x': 9.0, 'parking': True}],
                           dispatcher={'park_when_idle': True})
    dispatch.fleet.add('guest', start_x=5.0)
    assert last_text(dispatch) == ('Nothing is left to happen, but this is not done: r_0 on its way to park at lot, '
                                   'held for zone gate because of guest (has no goal)')
    dispatch.fleet.close_zone('gate')
    dispatch.fleet.remove('guest')
    assert last_text(dispatch).endswith('r_0 on its way to park at lot, held for zone gate, which is closed')


def test_a_robot_with_a_goal_that_asks_for_nothing_and_does_not_go_on_is_named(monkeypatch):
    monkeypatch.setattr(Traveller, '_end_hold', lambda *_: None)
    fleet = Fleet(make_scenario({
        'zones': [{'name': 'gate', 'rectangle': [4.0, -1.0, 6.0, 1.0], 'capacity': 1}], 'robots': [
            {'name': 'a', 'max_speed': 1.0}, {'name': 'b', 'max_speed': 1.0, 'start_x': -1.0}]}), start_ns=0)
    for name in 'ab':
        fleet.robot(name).send(8.0, 0.0)
    fleet.run()
    fleet.run()
    assert rows(fleet, 'deadlock') == [(8.0, 'b', 'deadlock', 'b', 'nothing')]
    assert [one.text for one in fleet.warnings] == [
        'b waits for nothing for ever, although nothing keeps it out. This is an error of move_base_abstract; please '
        'report it.']
