"""What `scenario make` makes: the same for the same sizes, fit to run, nothing wrong in it but what was asked for."""
import filecmp
import itertools
import os

import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import read_scenario
from move_base_abstract_worlds import command
from move_base_abstract_worlds.check import findings_of
from move_base_abstract_worlds.world import read_world

SMALL = {'warehouse': ['--aisles', 3, '--bays', 4, '--stations', 2, '--chargers', 1, '--robots', 6],
         'field': ['--rows', 4, '--length', 20, '--robots', 3], 'ward': ['--rooms', 5, '--robots', 3]}


def make(folder, kind, *words):
    with pytest.raises(SystemExit) as end:
        command.main(['make', kind, '--out', str(folder), *map(str, words)])
    return end.value.code


def test_the_warehouse_of_the_default_sizes(tmp_path):
    assert make(tmp_path, 'warehouse') == 0
    world = read_world(tmp_path / 'scenario.yaml')
    net, = world.nets.values()
    assert (len(world.starts), len(net.nodes)) == (50, 84)
    assert [sum(name.startswith(kind) for name in net.nodes) for kind in ('station', 'charger')] == [4, 7]
    assert all(edge.one_way for edge in net.edges if edge.begin != 'gate')
    orders = list(world.scenario.orders())
    assert len(orders) == 200
    for order in orders:
        assert [stop.action for stop in order.stops] == ['load', 'unload'] and order.deadline_ns == 600 * 10 ** 9
        assert order.stops[0].place.startswith('bay') and order.stops[1].place.startswith('station')
    assert world.occupancy is not None and findings_of(world) == []


@pytest.mark.parametrize('kind, words', [
    ('warehouse', ['--aisles', 2, '--bays', 3, '--stations', 1, '--chargers', 1, '--robots', 1]),
    ('warehouse', ['--aisles', 5, '--bays', 3, '--stations', 4, '--chargers', 4, '--robots', 25, '--orders', 0]),
    ('warehouse', SMALL['warehouse']), ('field', ['--rows', 2, '--length', 10, '--chargers', 5, '--robots', 4]),
    ('field', SMALL['field']), ('ward', ['--rooms', 2, '--robots', 1]), ('ward', SMALL['ward'])])
def test_nothing_is_wrong_with_what_is_made(tmp_path, kind, words):
    assert make(tmp_path, kind, *words) == 0
    assert findings_of(read_world(tmp_path / 'scenario.yaml')) == []


def test_lanes_with_a_capacity_can_lock_without_avoid(tmp_path):
    assert make(tmp_path, 'warehouse', *SMALL['warehouse'], '--lane-capacity', 1) == 0
    assert [one.kind for one in findings_of(read_world(tmp_path / 'scenario.yaml'))] == []  # 6 robots are too few
    more = [*SMALL['warehouse'][:-1], 17, '--lane-capacity', 1]
    assert make(tmp_path, 'warehouse', *more) == 0  # in the place of its own
    path = tmp_path / 'scenario.yaml'
    assert findings_of(read_world(path)) == []
    path.write_text(path.read_text().replace('deadlock: avoid\n', ''))
    lock, = findings_of(read_world(tmp_path / 'scenario.yaml'))
    assert lock.kind == 'can_lock' and lock.what.startswith('8 robots')  # 3 up, 1 east, 3 down, 1 west


@pytest.mark.parametrize('kind', SMALL)
def test_the_same_sizes_are_the_same_files_and_robots_get_everywhere(tmp_path, kind):
    for name in 'ab':
        assert make(tmp_path / name, kind, *SMALL[kind]) == 0
    files = [name for name in os.listdir(tmp_path / 'a') if not name.startswith('.')]
    assert sorted(files) == ['lanes.yaml', 'map.pgm', 'map.yaml', 'orders.csv', 'scenario.yaml']
    assert filecmp.cmpfiles(tmp_path / 'a', tmp_path / 'b', files, shallow=False)[0] == files
    scenario = read_scenario(tmp_path / 'a' / 'scenario.yaml', {'use_map': True})
    ended = []
    goals = {spec.name: itertools.cycle(list(scenario.places.values())) for spec in scenario.robots}

    def send(robot):
        pose = next(goals[robot]).pose
        fleet.robot(robot).send(pose.x, pose.y)

    def on_end(robot, _goal_id, state, _text, _now_ns):
        ended.append(state)
        if len(ended) < 3 * len(scenario.places):
            send(robot)
    fleet = Fleet(scenario, on_end=on_end, occupancy=load_map(read_description(tmp_path / 'a' / 'map.yaml')))
    for robot in fleet.names[:2]:  # not so many that they wait for one another at the ends of rooms
        send(robot)
    fleet.run()
    assert len(ended) >= 3 * len(scenario.places) and set(ended) == {GoalState.SUCCEEDED}


def test_what_is_not_allowed_is_said_and_nothing_is_replaced(tmp_path, capsys):
    (tmp_path / 'mine').mkdir()
    (tmp_path / 'mine' / 'scenario.yaml').write_text('mine')
    assert make(tmp_path / 'mine', 'ward') == 2
    assert (tmp_path / 'mine' / 'scenario.yaml').read_text() == 'mine'
    for words in (['--robots', 1000], ['--robots', 'x'], ['--rooms', 0], ['--rooms', '9' * 5000], ['--rooms', '-1']):
        assert make(tmp_path / 'new', 'ward', *words) == 2
        assert 'allowed' in capsys.readouterr().err
    assert make(tmp_path / 'new', 'warehouse', '--aisles', 4) == 2  # 4 stations, 7 chargers
    assert not (tmp_path / 'new').exists()
    assert make(tmp_path / 'new', 'castle') == 2
