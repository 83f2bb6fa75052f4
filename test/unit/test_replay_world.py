"""What a replay shows beside robots: who is where and waits for what, charge, orders, and robots that have not left."""
import json
import random

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario, read_scenario
from move_base_abstract.tasks.arrivals import Task
from move_base_abstract_replay.charges import Charges
from move_base_abstract_replay.motions import Motions
from move_base_abstract_replay.page import write_page
from move_base_abstract_replay.page_data import story_of
from move_base_abstract_replay.recording import ReplayError, read_recording
from move_base_abstract_replay.stays import (
    ASSIGNED,
    IS_THERE,
    IS_WAITING,
    OPEN,
    count_orders,
    find_limits,
    find_phases,
    find_stays,
)
from move_base_abstract_replay.world import World, make_world
from move_base_abstract_worlds.command import main as scenario_program
from test_replay_page import unpacked
from test_replay_recording import S, log_text

NODES = [{'name': 'n{}'.format(number), 'x': 10.0 * number, 'y': 0.0} for number in range(4)]
NODES[1] = {**NODES[1], 'spots': [[10.0, 1.0], [10.0, -1.0]]}
EDGES = [{'from': 'n{}'.format(number), 'to': 'n{}'.format(number + 1), 'capacity': 1} for number in range(3)]
#: shares of the charge may differ by rounding only
CLOSE = 1e-9


@pytest.fixture
def run(tmp_path):
    """Return (fleet, log, what the fleet said of areas, work and charges at instants) of a run with all kinds."""
    net = tmp_path / 'lanes.yaml'
    net.write_text(json.dumps({'nodes': NODES, 'edges': EDGES}))
    fleet = Fleet(make_scenario({
        'lanes': str(net), 'deadlock': 'avoid',
        'defaults': {'routes': 'lanes', 'max_speed': 1.0, 'acceleration': 0.4, 'turn_rate': 1.0, 'log_motion': True,
                     'battery_capacity': 0.5, 'battery_start': 0.9, 'battery_thresholds': [0.85, 0.8]},
        'robots': [{'name': 'r', 'count': 4}, {'name': 'late', 'start_x': 30.0}],
        'zones': [{'name': 'dock', 'rectangle': [25.0, -2.0, 35.0, 2.0], 'capacity': 2},
                  {'name': 'plug', 'rectangle': [-1.0, -1.0, 1.0, 1.0], 'charger': True}],
        'places': [{'name': 'bench', 'x': 30.0, 'y': 0.0, 'capacity': 1, 'duration': 20.0},
                   {'name': 'yard', 'x': 10.0, 'y': 0.0, 'duration': 5.0}]}))
    draw, seen = random.Random(2), []
    for number in range(12):
        name, x = 'r_{}'.format(number % 4), draw.choice([0.0, 10.0, 20.0, 30.0])
        fleet.at(S + number * 9 * S, lambda fleet, name=name, x=x: fleet.robot(name).send(
            x, 0.0, draw.uniform(-3.0, 3.0)))
    for number, (name, place, x) in enumerate([('r_0', 'bench', 30.0), ('late', 'bench', 30.0), ('r_1', 'yard', 10.0)]):
        fleet.at(150 * S + number, lambda fleet, name=name, x=x: fleet.robot(name).place(Pose2D(x, 0.0)))
        fleet.at(151 * S, lambda fleet, name=name, place=place, x=x: fleet.robot(name).send_task(
            Task(place + name, 0, place, Pose2D(x, 0.0))))
    for _ in range(150):
        fleet.run_for(1.3)
        seen.append((fleet.now_ns, fleet.zones, {name: fleet.robot(name).state_of_charge for name in fleet.names},
                     {name: fleet.robot(name).activity.split(',')[0] for name in fleet.names}))
    fleet.write_log(tmp_path / 'run.jsonl')
    last_ns = fleet.trace[-1].time_ns  # a log ends with its last event
    return fleet, tmp_path / 'run.jsonl', [row for row in seen if row[0] < last_ns]


def test_who_is_in_an_area_and_who_waits_is_as_the_fleet_says_at_any_instant(run):
    fleet, log, seen = run
    world = make_world(fleet.scenario)
    stays = find_stays(story_of(read_recording(log)), world)
    waited = 0
    for now_ns, areas, _, _ in seen:
        at = [stay for stay in stays if stay.begin_ns <= now_ns < stay.end_ns]
        for area in areas:
            if area.capacity is None:
                continue
            number = world.numbers['{} {}'.format(area.kind, area.name)]
            found = {kind: [stay.robot for stay in at if (stay.thing, stay.kind) == (number, kind)]
                     for kind in (IS_THERE, IS_WAITING)}
            assert sorted(found[IS_THERE]) == sorted(area.robots)
            assert found[IS_WAITING] == list(area.waiting)
            waited += len(area.waiting)
    assert waited > 20


def test_who_works_at_a_place_and_who_waits_for_it_is_found_also_where_it_has_no_capacity(run):
    fleet, log, seen = run
    world = make_world(fleet.scenario)
    stays = find_stays(story_of(read_recording(log)), world)
    number = world.numbers
    told = {(stay.robot, stay.thing, stay.kind): (stay.begin_ns, stay.end_ns) for stay in stays
            if world.things[stay.thing]['kind'] == 'place'}
    began, ended = 151 * S, 171 * S
    assert told == {('late', number['place bench'], IS_THERE): (began, ended),  # by name, at one instant
                    ('r_0', number['place bench'], IS_WAITING): (began, ended),
                    ('r_0', number['place bench'], IS_THERE): (ended, 191 * S),
                    ('r_1', number['place yard'], IS_THERE): (began, 156 * S)}
    working = [(now_ns, name) for now_ns, _, _, doing in seen for name, what in doing.items() if what == 'working']
    assert working and all(any(stay.robot == name and stay.kind == IS_THERE and stay.begin_ns <= now_ns < stay.end_ns
                               and world.things[stay.thing]['kind'] == 'place' for stay in stays)
                           for now_ns, name in working)


def test_the_charge_is_that_of_the_fleet_where_legs_are_exact(run):
    fleet, log, seen = run
    world, recording = make_world(fleet.scenario), read_recording(log)
    charges = Charges(world, recording.begin_ns)
    assert Motions(recording, world, charges).even == 0
    compared = 0
    for now_ns, _, shares, doing in seen:
        for name, share in shares.items():
            knots = charges.knots[name]
            times, values = zip(*knots)
            before = max(place for place, time_ns in enumerate(times) if time_ns <= now_ns)
            after = min((place for place, time_ns in enumerate(times) if time_ns >= now_ns), default=before)
            if doing[name] == 'driving':  # in between the page draws a straight line
                assert min(values[before], values[after]) - CLOSE <= share <= max(values[before], values[after]) + CLOSE
            else:
                assert np.interp(now_ns, times, values) == pytest.approx(share, abs=CLOSE)
                compared += 1
    assert compared > 400
    assert any(knots[-1][1] != 0.9 for knots in charges.knots.values())


def test_robots_that_have_not_left_stand_where_they_start(tmp_path):
    fleet = Fleet(make_scenario({'robots': [{'name': 'a', 'start_x': 1.0}, {'name': 'still', 'start_y': 7.0}]}))
    fleet.robot('a').send(9.0, 4.0)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    recording = read_recording(tmp_path / 'run.jsonl')
    assert (Motions(recording).even, Motions(recording).startless) == (1, 1)
    motions = Motions(recording, make_world(fleet.scenario))
    assert (motions.even, motions.startless) == (1, 0)
    assert motions.tracks['still'].driven[0].motion.end == Pose2D(0.0, 7.0)


def test_orders_are_open_assigned_and_over_as_their_rows_say(tmp_path):
    stops = ('bay', 1.0, 2.0, 'pick', 'dock', 5.0, 6.0, 'drop')
    rows = [(S, '/dispatcher', 'order_arrived', ('o1', 0, 0, *stops)),
            (S, '/dispatcher', 'order_arrived', ('o2', 0, 9, *stops)),
            (2 * S, 'r', 'order_assigned', ('o1', 1)), (4 * S, 'r', 'order_stop', ('o1', 2, 'drives')),
            (5 * S, 'r', 'order_returned', ('o1', 'robot failed', 2)), (6 * S, 'q', 'order_assigned', ('o1', 2)),
            (8 * S, 'q', 'order_done', ('o1', 'late', 7 * S)), (8 * S, '/dispatcher', 'order_refused', ('o3', 'why')),
            # of others, who may write anything
            (9 * S, 'x', 'order_arrived', ()), (9 * S, 'x', 'order_arrived', ('o4', 0, 0, 'a', 'far', None, 'b')),
            (9 * S, 'x', 'order_stop', ('o2', 'two')), (9 * S, 'x', 'order_done', ('o9', 'done'))]
    (tmp_path / 'run.jsonl').write_text(log_text(rows))
    orders = story_of(read_recording(tmp_path / 'run.jsonl')).orders
    counts = count_orders(orders)
    assert [(one.begin_ns // S, one.end_ns // S, one.order, one.kind, one.robot, one.x, one.stop, one.stops)
            for one in find_phases(orders)] == [
        (1, 2, 'o1', OPEN, '', 1.0, 1, 2), (1, 9, 'o2', OPEN, '', 1.0, 1, 2), (2, 4, 'o1', ASSIGNED, 'r', 1.0, 1, 2),
        (4, 5, 'o1', ASSIGNED, 'r', 5.0, 2, 2), (5, 6, 'o1', OPEN, '', 5.0, 2, 2),
        (6, 8, 'o1', ASSIGNED, 'q', 5.0, 2, 2)]
    assert counts[0] == (S, 2, 0, 0, 0, 0, 0)
    assert counts[-1][1:] == (1, 0, 0, 1, 0, 1)


def test_a_plain_trace_of_a_warehouse_is_shown_on_its_map_without_being_told_where_that_is(tmp_path, capsys):
    with pytest.raises(SystemExit):
        scenario_program(['make', 'warehouse', '--robots', '50', '--out', str(tmp_path)])
    capsys.readouterr()
    fleet = Fleet(read_scenario(tmp_path / 'scenario.yaml'))
    fleet.robot('robot_0').send(4.0, 3.0)
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html')
    text = (tmp_path / 'page.html').read_text()
    about, columns = unpacked(text.split('data-run>')[1].split('<')[0])
    assert len(about['rows']) == 50 and len(columns['charge_first']) == 4 * 51
    world, _ = unpacked(text.split('id="packed-world">')[1].split('<')[0])
    kinds = [thing['kind'] for thing in world['things']]
    assert [kinds.count(kind) for kind in ('zone', 'lane', 'place')] == [7, 105, 52] and len(world['nodes']) == 84
    assert 'id="packed-map"' in text
    assert '<b>1/2 +3</b>' in text


def test_limits_of_zones_and_levels_of_charge_are_on_the_page_as_they_were(tmp_path):
    fleet = Fleet(make_scenario({
        'robots': [{'name': 'a'}], 'dispatcher': {'charge_below': 0.25, 'charge_when_idle': 0.6},
        'zones': [{'name': 'other', 'rectangle': [0, 5, 1, 6]},
                  {'name': 'slow', 'rectangle': [4, -1, 6, 1], 'max_speed': 0.4}]}))
    changes = [(2 * S, 'other', 0.2), (2 * S, 'slow', None), (3 * S, 'slow', 0.3)]
    for time_ns, zone, speed in changes:
        fleet.at(time_ns, lambda fleet, zone=zone, speed=speed: fleet.set_zone_limit(zone, speed))
    fleet.run()
    fleet.write_log(tmp_path / 'run.jsonl')
    page = [*fleet.trace, (4 * S, 'a', 'zone_limit', ('none', 1.0)), (4 * S, 'a', 'zone_limit', ('slow', 'fast')),
            (4 * S, 'a', 'zone_limit', ())]  # rows of others, which say nothing
    (tmp_path / 'run.jsonl').write_text(log_text(page))
    world = make_world(fleet.scenario)
    assert [thing['max_speed'] for thing in world.things] == [0.0, 0.4]
    assert world.levels == {'critical': 0.25, 'good': 0.6}
    assert find_limits(read_recording(tmp_path / 'run.jsonl'), world) == [
        (time_ns, ['other', 'slow'].index(zone), speed or 0.0) for time_ns, zone, speed in changes]
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=fleet.scenario)
    _, columns = unpacked((tmp_path / 'page.html').read_text().split('data-run>')[1].split('<')[0])
    assert len(columns['limit_speed']) == 8 * 3


def test_the_scenario_of_another_run_is_an_error_if_asked_for_and_left_alone_if_it_lies_there(tmp_path):
    (tmp_path / 'run.jsonl').write_text(log_text([(S, 'a', 'stands', (0.0, 0.0, 0.0))]))
    (tmp_path / 'scenario.yaml').write_text('robots: [{name: b}]\nzones: [{name: z, rectangle: [0, 0, 1, 1]}]\n')
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html')
    world, _ = unpacked((tmp_path / 'page.html').read_text().split('id="packed-world">')[1].split('<')[0])
    assert world == {'things': [], 'nodes': [], 'levels': {}}
    with pytest.raises(ReplayError, match='none of which is in the log'):
        write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=tmp_path / 'scenario.yaml')
    with pytest.raises(ConfigurationError):
        write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=tmp_path / 'missing.yaml')


@pytest.mark.parametrize('kind', ['entered', 'left', 'held', 'released', 'works_at', 'task_began', 'task_ended',
                                  'waiting_began', 'waiting_ended', 'stands', 'charging_began', 'charging_ended',
                                  'battery', 'order_arrived', 'order_assigned', 'order_stop', 'order_returned',
                                  'order_done', 'order_refused'])
@pytest.mark.parametrize('values', [(), (None,), ([1], {}), ('<b>', 1e300, None), (10 ** 400, 'x', True),
                                    ('zone z', 'zone z', -3), (float('inf'),) * 4])
def test_rows_of_others_of_any_values_do_no_harm(tmp_path, kind, values):
    raw = {'robots': [{'name': 'a', 'battery_capacity': 1.0}], 'zones': [{'name': 'z', 'rectangle': [0, 0, 1, 1]}],
           'places': [{'name': 'p', 'x': 0.0, 'y': 0.0}]}
    (tmp_path / 'run.jsonl').write_text(log_text([(S, 'a', kind, values), (2 * S, 'a', kind, values)]))
    write_page([tmp_path / 'run.jsonl'], tmp_path / 'page.html', scenario=make_scenario(raw))


def test_a_log_without_a_scenario_has_no_world(tmp_path):
    (tmp_path / 'run.jsonl').write_text(log_text([(S, 'a', 'entered', ('zone z',))]))
    assert find_stays(story_of(read_recording(tmp_path / 'run.jsonl')), World()) == []
