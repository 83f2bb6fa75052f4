"""Places and what arrives at them: random instants that follow from the seed, files, and what is wrong with either."""
import itertools
import math
from statistics import NormalDist, mean

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.units import LAST_NS
from move_base_abstract.scenario import make_scenario, read_scenario

S = 1_000_000_000
DOCK = {'name': 'dock', 'x': 12.0, 'y': 3.0, 'yaw': 1.5, 'capacity': 2, 'duration': 40.0, 'power': 120.0}
FIELD = {'name': 'field', 'area': [0.0, 10.0, 40.0, 30.0], 'rate': 0.5, 'duration': 8.0,
         'duration_distribution': 'gamma', 'duration_cv': 1.0}


def tasks_of(*arrivals, seed=7, count=None, places=(DOCK,)):
    scenario = make_scenario({'seed': seed, 'places': list(places), 'arrivals': list(arrivals)})
    return list(itertools.islice(scenario.tasks(), count))


def test_tasks_at_a_place_are_what_the_place_says_but_for_what_the_arrivals_say():
    one, = tasks_of({'place': 'dock', 'rate_per_hour': 20.0, 'count': 1})
    assert (one.task_id, one.place, one.pose.x, one.pose.y, one.pose.yaw) == ('dock_1', 'dock', 12.0, 3.0, 1.5)
    assert (one.duration_ns, one.power, one.energy) == (40 * S, 120.0, 0.0)
    other, = tasks_of({'name': 'fast', 'place': 'dock', 'rate': 1.0, 'count': 1, 'duration': 2.0, 'energy': 5.0})
    assert (other.task_id, other.duration_ns, other.power, other.energy) == ('fast_1', 2 * S, 120.0, 5.0)


def test_gaps_are_exponential_durations_as_they_are_said_and_places_even_in_the_area():
    tasks = tasks_of({**FIELD, 'count': 4000})
    gaps = [(b.arrival_ns - a.arrival_ns) / S for a, b in zip(tasks, tasks[1:])]
    durations = [task.duration_ns / S for task in tasks]
    limit = NormalDist().inv_cdf(0.999) / math.sqrt(4000)
    for values, expected in ((gaps, 2.0), (durations, 8.0)):
        assert abs(mean(values) / expected - 1.0) < limit  # both have a coefficient of variation of 1
        assert abs(mean(value > expected for value in values) - math.exp(-1.0)) < 0.5 * limit
    for values, low, high in (([task.pose.x for task in tasks], 0.0, 40.0),
                              ([task.pose.y for task in tasks], 10.0, 30.0)):
        assert low <= min(values)
        assert max(values) <= high
        assert abs(mean(values) - (low + high) / 2) < limit * (high - low) / math.sqrt(12.0)


def test_what_arrives_follows_from_seed_name_and_number_alone():
    field, dock = {**FIELD, 'count': 20}, {'place': 'dock', 'rate': 0.1, 'count': 5}
    together = tasks_of(dock, field)
    assert [task.arrival_ns for task in together] == sorted(task.arrival_ns for task in together)
    assert [task for task in together if task.task_id.startswith('field')] == tasks_of(field)
    assert tasks_of({**FIELD, 'count': 30})[:20] == tasks_of(field)
    assert tasks_of(field, seed=8) != tasks_of(field)
    assert [task.arrival_ns for task in tasks_of({**field, 'name': 'other'})] != [
        task.arrival_ns for task in tasks_of(field)]


def test_tasks_end_with_their_count_an_instant_or_time_itself():
    assert len(tasks_of(FIELD, count=1000)) == 1000
    early = tasks_of({**FIELD, 'until': 100.0})
    assert 20 < len(early) < 90
    assert early[-1].arrival_ns <= 100 * S
    late = tasks_of({**FIELD, 'rate': 1e-8})
    assert len(late) < 90
    assert all(task.arrival_ns <= LAST_NS for task in late)


def test_a_file_says_when_and_where(tmp_path):
    (tmp_path / 'orders.csv').write_text('time,place,x,y,duration,energy\n5.5,,1,2,3,7\n2,dock,,,,\n5.5,,8,9,1,\n')
    (tmp_path / 'list.yaml').write_text('tasks:\n- {time: 5.5, x: 1.0, y: 2.0, yaw: 0.5, duration: 3.0}\n')
    (tmp_path / 's.yaml').write_text(
        'places: [{name: dock, x: 12.0, duration: 40.0, duration_distribution: lognormal, duration_cv: 0.5}]\n'
        'arrivals: [{name: a, file: orders.csv}, {name: b, file: list.yaml}]\n')
    scenario = read_scenario(str(tmp_path / 's.yaml'))
    found = [(task.task_id, task.arrival_ns, task.place, task.pose.x, task.pose.yaw, task.energy)
             for task in scenario.tasks()]
    assert found == [('a_2', 2 * S, 'dock', 12.0, 0.0, 0.0), ('a_1', 5_500_000_000, '', 1.0, 0.0, 7.0),
                     ('a_3', 5_500_000_000, '', 8.0, 0.0, 0.0), ('b_1', 5_500_000_000, '', 1.0, 0.5, 0.0)]
    durations = [next(scenario.tasks(seed)).duration_ns for seed in (1, 1, 2)]
    assert durations[0] == durations[1] != durations[2]
    assert [task.duration_ns for task in scenario.tasks()][1:] == [3 * S, 1 * S, 3 * S]


@pytest.mark.parametrize('places, arrivals, words', [
    ('dock', [], ('places', 'a list of at most')),
    (['dock'], [], ('places[0]', 'a mapping')),
    ([{'x': 1.0}], [], ('places[0]', 'name', 'is missing', 'a letter first')),
    ([{'name': 'dock', 'capasity': 1}], [], ("places[0]: capasity: unknown key; did you mean 'capacity'?",)),
    ([DOCK, DOCK], [], ('places[1]', "'dock' is given to more than one place")),
    ([{**DOCK, 'capacity': 0}], [], ('capacity', 'got 0', 'a whole number >= 1')),
    ([{**DOCK, 'duration': 0.0}], [], ('duration', 'got 0.0', 'a number in 1e-9..2147483647')),
    ([{**DOCK, 'duration_cv': 0.5}], [], ('duration_cv', '> 0 with lognormal and gamma')),
    ([DOCK], {}, ('arrivals', 'a list of at most')),
    ([DOCK], [{'rate': 1.0}], ('arrivals[0]', 'none of place, area and file')),
    ([DOCK], [{'place': 'dock', 'area': [0, 0, 1, 1], 'rate': 1.0}], ('place and area', 'one of')),
    ([DOCK], [{'place': 'dok', 'rate': 1.0}], ('place', "got 'dok'", 'allowed: dock')),
    ([DOCK], [{'place': 'dock'}], ('neither rate and rate_per_hour',)),
    ([DOCK], [{'place': 'dock', 'rate': 1.0, 'rate_per_hour': 1.0}], ('both rate and rate_per_hour',)),
    ([DOCK], [{'area': [0, 0, 1, 1], 'rate': 1.0, 'duration': 1.0}], ('name', 'got None')),
    ([DOCK], [{'name': 'a', 'area': [0, 0, 1, 1], 'rate': 1.0}], ('duration', 'given neither here')),
    ([DOCK], [{'name': 'a', 'area': [2, 0, 1, 1], 'rate': 1.0, 'duration': 1.0}], ('area', 'x_min <= x_max')),
    ([DOCK], [{'place': 'dock', 'rate': 1.0}] * 2, ('arrivals[1]', "'dock' is given to more than one entry",
                                                           'it is the name of the place')),
    ([DOCK], [{'name': 'a', 'file': 'x.csv', 'rate': 1.0}], ('rate', 'with a file, which determines it')),
    ([DOCK], [{'name': 'a', 'file': 'x.csv', 'until': 0}], ('until', 'got 0.0 with a file')),
    ([DOCK], [{'name': 'a', 'file': 'x.csv', 'duration_distribution': 'gamma'}], ("got 'gamma' with a file",)),
    ([DOCK], [{'name': 'a', 'file': 'x.txt'}], ('file', 'x.txt', '.csv, .yaml or .yml')),
    ([DOCK], [{'name': 'a', 'file': '/nowhere/x.csv'}], ('/nowhere/x.csv', 'cannot be read')),
])
def test_what_is_wrong_is_said_with_place_and_what_is_allowed(places, arrivals, words):
    with pytest.raises(ConfigurationError) as error:
        make_scenario({'places': places, 'arrivals': arrivals}, 's.yaml')
    for word in words:
        assert word in str(error.value)


@pytest.mark.parametrize('text, words', [
    ('time,place\nsoon,dock\n', ('line 2', 'time', "'soon'")),
    ('time,place\n1,dok\n', ('line 2', "'dok'", 'allowed: dock')),
    ('time,place\n1,nan\n', ('line 2', "'nan'", 'allowed: dock')),
    ('time,x\n1,nan\n', ('line 2', 'x', 'nan')),
    ('time,place,x\n1,dock,2\n', ('line 2', 'either a place or x, y and yaw')),
    ('place\ndock\n', ('line 2', 'time is missing; allowed: a number in 0..')),
    ('time,x\n1,2\n', ('line 2', 'duration', 'given neither here')),
    ('time,where\n1,dock\n', ('line 2', 'where: unknown key')),
    ('time,place\n1,dock,3\n', ('line 2', '3 cells; allowed: 2')),
])
def test_what_is_wrong_in_a_file_is_said_with_its_line(tmp_path, text, words):
    path = tmp_path / 'orders.csv'
    path.write_text(text)
    with pytest.raises(ConfigurationError) as error:
        make_scenario({'places': [DOCK], 'arrivals': [{'name': 'a', 'file': str(path)}]})
    for word in (str(path), *words):
        assert word in str(error.value)
