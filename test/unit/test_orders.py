"""Orders as a scenario says them: templates, files, what is drawn, and what is refused."""
import itertools

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.orders.policies import POLICIES
from move_base_abstract.scenario import make_scenario, read_scenario

S = 1_000_000_000
PLACES = [{'name': 'bay_1', 'x': 1.0, 'duration': 5.0}, {'name': 'bay_2', 'x': 2.0, 'yaw': 1.0},
          {'name': 'dock', 'y': 3.0, 'duration': 8.0, 'power': 4.0, 'energy': 2.0}]
PICK = {'name': 'picks', 'rate_per_hour': 60.0, 'stops': [{'places': ['bay_*'], 'action': 'load'},
                                                         {'place': 'dock', 'action': 'unload'}]}


def scenario_of(*orders, seed=1, **more):
    return make_scenario({'seed': seed, 'places': PLACES, 'orders': list(orders), **more})


def orders_of(*orders, count=50, **more):
    return list(itertools.islice(scenario_of(*orders, **more).orders(), count))


def test_a_template_draws_places_from_a_group_and_takes_what_the_place_says():
    orders = orders_of({**PICK, 'deadline': 600.0, 'priority': 2}, count=400)
    assert {order.stops[0].place for order in orders} == {'bay_1', 'bay_2'}
    assert 150 < sum(order.stops[0].place == 'bay_1' for order in orders) < 250
    for number, order in enumerate(orders, 1):
        first, last = order.stops
        assert (order.order_id, order.deadline_ns, order.priority) == ('picks_{}'.format(number), 600 * S, 2)
        assert (first.action, first.duration_ns) == ('load', 5 * S if first.place == 'bay_1' else 0)
        assert (last.place, last.action, last.duration_ns, last.power, last.energy) == (
            'dock', 'unload', 8 * S, 4.0, 2.0)
        assert (last.pose.x, last.pose.y) == (0.0, 3.0)
    mean = orders[-1].arrival_ns / S / len(orders)
    assert mean == pytest.approx(60.0, rel=0.15)


def test_orders_come_regularly_where_every_says_so_up_to_count_and_until():
    at = [order.arrival_ns / S for order in orders_of({'name': 'r', 'every': 90.0, 'stops': [{'place': 'dock'}],
                                                      'until': 300.0})]
    assert at == [90.0, 180.0, 270.0]
    assert len(orders_of({'name': 'r', 'every': 90.0, 'stops': [{'place': 'dock'}], 'count': 7})) == 7


def test_what_arrives_hangs_on_seed_name_and_number_alone():
    other = {'name': 'others', 'rate': 0.1, 'stops': [{'area': [0, 0, 4, 4], 'duration': 2.0,
                                                       'duration_distribution': 'gamma', 'duration_cv': 0.5}]}
    alone, both = orders_of(PICK), orders_of(other, PICK, count=500)
    assert [order for order in both if order.order_id.startswith('picks')][:20] == alone[:20]
    assert orders_of(PICK, seed=2) != alone
    drawn = [order.stops[0] for order in both if order.order_id.startswith('others')]
    assert all(0.0 <= stop.pose.x <= 4.0 and 0.0 <= stop.pose.y <= 4.0 and stop.duration_ns > 0 for stop in drawn)
    assert len({stop.duration_ns for stop in drawn}) == len(drawn)
    assert [order.arrival_ns for order in both] == sorted(order.arrival_ns for order in both)


def test_a_longer_order_does_not_change_the_stops_before():
    longer = {**PICK, 'stops': [*PICK['stops'], {'places': ['*']}]}
    assert [order.stops[:2] for order in orders_of(longer)] == [order.stops for order in orders_of(PICK)]


def test_files_are_tables_and_yaml_and_say_the_same(tmp_path):
    (tmp_path / 'a.csv').write_text('time,stops,deadline,priority\n20,load bay_1; unload dock,60,1\n10,dock,,\n')
    (tmp_path / 'a.yaml').write_text(
        'orders:\n- {time: 20, deadline: 60, priority: 1, stops: [{place: bay_1, action: load}, {place: dock, action: '
        'unload}]}\n- {time: 10, stops: [{place: dock}]}\n')
    found = {}
    for kind in ('csv', 'yaml'):
        (tmp_path / 'scenario.yaml').write_text(
            'places: [{name: bay_1, x: 1.0, duration: 5.0}, {name: dock, duration: 8.0}]\n'
            'orders: [{name: listed, file: a.%s}]\n' % kind)
        found[kind] = list(read_scenario(tmp_path / 'scenario.yaml').orders())
    assert found['csv'] == found['yaml']
    assert [(order.order_id, order.arrival_ns / S, order.deadline_ns, order.priority, [
        (stop.place, stop.action, stop.duration_ns / S) for stop in order.stops]) for order in found['csv']] == [
        ('listed_2', 10.0, None, 0, [('dock', 'work', 8.0)]),
        ('listed_1', 20.0, 60 * S, 1, [('bay_1', 'load', 5.0), ('dock', 'unload', 8.0)])]


@pytest.mark.parametrize('change, text', [
    ({'stops': None}, 'orders[0]: got neither file and stops; allowed: one of them'),
    ({'file': 'x.csv'}, 'orders[0]: got both file and stops; allowed: one of them'),
    ({'file': 'x.csv', 'stops': None, 'rate_per_hour': None, 'deadline': 0},
     'deadline: got 0.0 with a file, which determines it; allowed: name and file'),
    ({'rate': 1.0}, 'orders[0]: got rate and rate_per_hour; allowed: one of rate, rate_per_hour and every'),
    ({'rate_per_hour': None}, 'got none of rate, rate_per_hour and every'),
    ({'stops': []}, 'orders[0]: stops: got []; allowed: a list of 1 to 100 stops'),
    ({'stops': [{'places': ['moon*']}]}, "places: got 'moon*', which matches no place; allowed: bay_1, bay_2"),
    ({'stops': [{'place': 'moon'}]}, "stops[0]: place: got 'moon'; allowed: bay_1, bay_2, dock"),
    ({'stops': [{'place': 'dock', 'x': 1.0}]}, 'allowed: either a place or x, y and yaw'),
    ({'stops': [{'places': ['dock'], 'area': [0, 0, 1, 1]}]}, 'got places and area; allowed: one of place, places'),
    ({'stops': [{'area': [2, 0, 1, 1]}]}, 'area: got [2, 0, 1, 1]; allowed: a list [x_min'),
    ({'stops': [{'place': 'dock', 'action': 'dance'}]}, "action: got 'dance'; allowed: 'work', 'load' or 'unload'"),
    ({'stops': [{'place': 'dock', 'weight': 1}]}, 'weight'),
    ({'stops': ['dock']}, "stops[0]: got 'dock'; allowed: a mapping"),
    ({'priority': 1.5}, 'priority: got 1.5; allowed: a whole number of 32 bits'),
    ({'deadline': -1.0}, 'deadline: got -1.0; allowed: a number in 0..'),
    ({'name': None}, 'name is missing'),
])
def test_what_is_wrong_is_named_with_its_place(change, text):
    with pytest.raises(ConfigurationError) as error:
        scenario_of({key: value for key, value in {**PICK, **change}.items() if value is not None})
    assert text in str(error.value)


def test_two_entries_of_one_name_are_refused():
    with pytest.raises(ConfigurationError, match=(
            r"orders\[1\]: name: 'picks' is given to more than one entry; each needs a name of its own$")):
        scenario_of(PICK, PICK)


@pytest.mark.parametrize('text, said', [
    ('time,stops\n1,moon\n', "place: got 'moon'; allowed: dock"),
    ('time,stops\n,dock\n', 'time is missing; allowed: a number in 0..2147483647 [s, simulated]'),
    ('time,stops\n1,\n', 'stops: got'),
    ('time,stops\n-1,dock\n', 'time: got -1.0; allowed'),
    ('time,stops\n', 'got no orders; allowed: at least one'),
    ('time,stops,colour\n1,dock,red\n', 'colour'),
])
def test_a_bad_file_is_refused_with_its_line(tmp_path, text, said):
    (tmp_path / 'a.csv').write_text(text)
    (tmp_path / 's.yaml').write_text('places: [{name: dock}]\norders: [{name: l, file: a.csv}]\n')
    with pytest.raises(ConfigurationError) as error:
        read_scenario(tmp_path / 's.yaml')
    assert said in str(error.value)
    assert 'a.csv' in str(error.value)


def test_robots_that_do_orders_work_also_where_no_place_has_a_name():
    assert make_scenario({'orders': [{'name': 'o', 'every': 1.0, 'stops': [{'x': 1.0, 'duration': 2.0}]}]}).places == {}
    assert make_scenario({}).places is None


def test_a_dispatcher_has_robots_tell_of_the_charges_that_it_decides_by():
    def levels(**dispatcher):
        robots = [{'name': 'a', 'battery_capacity': 5.0}, {'name': 'b'},
                  {'name': 'c', 'battery_capacity': 5.0, 'battery_thresholds': [0.5, 0.1]}]
        made = make_scenario({'robots': robots, 'dispatcher': dispatcher}).robots
        return [spec.settings.battery and spec.settings.battery.levels for spec in made]
    assert levels(charge_below=0.3, charge_until=0.9) == [(0.9, 0.3, 0.2, 0.0), None, (0.9, 0.5, 0.3, 0.1, 0.0)]
    assert levels(charge_below=0.5, charge_until=1.0, charge_when_idle=0.7) == [
        (0.7, 0.5, 0.2, 0.0), None, (0.7, 0.5, 0.1, 0.0)]
    same = make_scenario({'robots': [{'name': 'a', 'battery_capacity': 5.0}]}).robots[0].settings.battery.levels
    assert same == (0.2, 0.0)


@pytest.mark.parametrize('raw, text', [
    ({'policy': 'best'}, "policy: got 'best'; allowed: {}, or module:Class".format(', '.join(POLICIES))),
    ({'polciy': 'batch'}, 'polciy'),
    ({'charge_below': 0.9}, 'charge_until: got 0.9 with charge_below: 0.9; allowed: more than that'),
    ({'attempts': 0}, 'attempts: got 0; allowed: a whole number in 1..1000'),
    ([], 'dispatcher: got []; allowed: a mapping'),
])
def test_what_is_wrong_with_a_dispatcher_is_named(raw, text):
    with pytest.raises(ConfigurationError) as error:
        make_scenario({'dispatcher': raw})
    assert text in str(error.value)
