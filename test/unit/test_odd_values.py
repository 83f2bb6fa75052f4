"""An oracle: each key of each documented table with odd values is refused with words, or the robots drive with it."""
import copy
import dataclasses
import itertools
import json
import logging
import math
import sys
from pathlib import Path

import pytest
import yaml
from night import times

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.options import options_of
from move_base_abstract.common.parameter_table import read_table
from move_base_abstract.fleet import Dispatch
from move_base_abstract.maps import lane_map, travel_matrix
from move_base_abstract.orders import order_arrivals
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks import arrivals
from move_base_abstract_experiments.description import spec
from move_base_abstract_experiments.description.experiment import Experiment

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'tools'))

import write_node_pages  # noqa: E402
import write_scenario_keys  # noqa: E402

SECONDS = 200.0  # simulated
MOST_ROWS = times(300, 3000)  # of a run: what comes a thousand times a second is odd, too
ODD = [None, True, False, 0, -0.0, 1, -1, 2, 3, 0.5, -0.5, 5e-324, 1e-320, 1e-12, 1e-9, 1e-3, 1e3, 1e6, 1e9, -1e9,
       1.000001e9, 1e12, 1e18, 1e300, 1e308, -1e308, math.inf, -math.inf, math.nan, 2 ** 31 - 1, 2147483647.0, 2 ** 31,
       -2 ** 31, 2 ** 63, 10 ** 400, '', ' ', 'x', 'p', '1', '1_0', '\u0661', '1e3', 'nan', '\u202ex', '\0', 'a b', '/',
       '~', '../x', 'none', 'a' * 5000, [], [[]], [None], [0, 0, 0, 0], [-1e308, -1e308, 1e308, 1e308],
       [1e9, 2e9, 1e9, 2e9],
       ['p'], ['*'], {}, {'a': 1}, [{}], [{'name': 'p'}], [[0, 0], [1e308, 0], [0, 1e308]], [0.5, math.nan], [1e308, 1]]
DAY = [1e308, -1e308, math.nan, 2147483647.0, 1e-12, '1_0', '\u0661', [], [-1e308, -1e308, 1e308, 1e308], None]
BASE = {
    'defaults': {'battery_capacity': 10.0, 'max_speed': 1.0}, 'robots': [{'name': 'a'}, {'name': 'b', 'start_y': 2.0}],
    'zones': [{'name': 'z', 'rectangle': [-5.0, -5.0, -2.0, -2.0], 'charger': True, 'capacity': 1}],
    'places': [{'name': 'p', 'x': 3.0, 'duration': 3.0}],
    'arrivals': [{'place': 'p', 'rate': 0.1, 'duration': 2.0}],
    'orders': [{'name': 'one', 'every': 20.0, 'stops': [{'x': 3.0, 'y': 4.0}]}, {
        'name': 'two', 'every': 15.0, 'stops': [{'place': 'p'}, {'x': 1.0, 'y': 1.0}]}], 'dispatcher': {}}
#: {section of docs/scenario_keys.md: where its keys stand in BASE}
WHERE = {'Top level': (), 'A robot': ('robots', 0), 'Settings: of `defaults` or of a robot': ('robots', 0),
         'A zone': ('zones', 0), 'A place': ('places', 0), 'Arrivals': ('arrivals', 0), 'Orders': ('orders', 0),
         'A stop of an order': ('orders', 0, 'stops', 0), 'The dispatcher': ('dispatcher',)}
#: keys in whose place another must not stand
INSTEAD = {'file': ('rate', 'every', 'stops', 'duration', 'place'), 'area': ('place', 'x', 'y'),
           'polygon': ('rectangle',), 'places': ('x', 'y'), 'place': ('x', 'y'), 'rate': ('every',),
           'rate_per_hour': ('rate', 'every')}
KEYS = [(heading, parameter.name) for heading, parameters, _ in write_scenario_keys.sections() if heading in WHERE
        for parameter in parameters]
#: {a file's kind: its content}
FILES = {
    'lanes': {'nodes': [{'name': 'm', 'x': 0.0, 'y': 0.0}, {'name': 'n', 'x': 5.0, 'y': 5.0}],
              'edges': [{'from': 'm', 'to': 'n'}]},
    'travel_matrix': {'places': [{'name': 'm', 'x': 0.0, 'y': 0.0}, {'name': 'n', 'x': 5.0, 'y': 5.0}],
                      'times': [{'from': 'm', 'to': 'n', 'seconds': 7.0}, {'from': 'n', 'to': 'm', 'seconds': 7.0}]},
    'tasks': {'tasks': [{'time': 1.0, 'place': 'p'}]}, 'orders': {'orders': [{'time': 1.0, 'stops': [{'place': 'p'}]}]}}
#: (kind, list in it, Parameters of an entry)
OF_FILES = [('lanes', 'nodes', lane_map._NODE_TABLE), ('lanes', 'edges', lane_map._EDGE_TABLE),
            ('travel_matrix', 'places', travel_matrix._PLACE_TABLE),
            ('travel_matrix', 'times', travel_matrix._TIME_TABLE), ('tasks', 'tasks', arrivals._ROW),
            ('orders', 'orders', order_arrivals._ROW)]


class Enough(Exception):
    """The run has had as many rows as are looked at."""


def with_value(heading, key, value):
    """Return BASE with a value at a key."""
    document = copy.deepcopy(BASE)
    place = document
    for step in WHERE[heading]:
        place = place[step]
    for other in INSTEAD.get(key, ()):
        place.pop(other, None)
    place[key] = value
    return document


def drive(scenario):
    """Have the robots drive; raise what a user would see."""
    rows = itertools.count()

    def hear(_row):
        if next(rows) > MOST_ROWS:
            raise Enough
    for _task in itertools.takewhile(lambda task: task.arrival_ns < SECONDS * 1e9, itertools.islice(
            scenario.tasks(), MOST_ROWS)):
        pass
    try:
        Dispatch(scenario, on_event=hear).run(until=SECONDS)
    except Enough:
        pass


def check(document, caplog, value):
    try:
        drive(make_scenario(document))
    except ConfigurationError as error:
        assert str(error), value
    assert caplog.records == [], value  # an error that ended a goal


@pytest.mark.parametrize('heading, key', times(KEYS[::10], KEYS))
def test_an_odd_value_is_refused_with_words_or_the_robots_drive_with_it(heading, key, caplog):
    caplog.set_level(logging.ERROR)
    for value in times(DAY, ODD):
        check(with_value(heading, key, value), caplog, value)


@pytest.mark.parametrize('kind, part, key', [(kind, part, one.name) for kind, part, table in OF_FILES for one in table])
def test_an_odd_value_in_a_file_is_refused_with_words_or_the_robots_drive_with_it(kind, part, key, tmp_path, caplog):
    caplog.set_level(logging.ERROR)
    for number, value in enumerate(times(DAY, ODD)):
        content = copy.deepcopy(FILES[kind])
        if key in ('x', 'y', 'yaw'):
            content[part][0].pop('place', None)
        content[part][0][key] = value
        path = tmp_path / '{}.yaml'.format(number)
        path.write_text(yaml.safe_dump(content))
        document = copy.deepcopy(BASE)
        if part in ('tasks', 'orders'):
            document['arrivals' if part == 'tasks' else 'orders'] = [{'name': 'f', 'file': str(path)}]
        else:
            document[kind] = str(path)
            document['orders'] = [{'name': 'o', 'every': 20.0, 'stops': [{'x': 5.0, 'y': 5.0}]}]
            document['defaults'] = {'max_speed': 1.0, 'routes': 'lanes' if kind == 'lanes' else 'matrix'}
        check(document, caplog, value)


OF_NODES = [(node, parameter) for node, tables in write_node_pages.TABLES.items() for _, table in tables
            for parameter in table]


@pytest.mark.parametrize('node, parameter', times(OF_NODES[::10], OF_NODES), ids=lambda one: getattr(one, 'name', one))
def test_an_odd_value_of_a_nodes_parameter_is_taken_or_refused_with_words(node, parameter):
    for value in times(DAY, ODD):
        try:
            read_table({parameter.name: value}, (parameter,), '/' + node)
        except ConfigurationError as error:
            assert parameter.name in str(error), value


EXPERIMENTS = {
    'launch': {'experiment': 'e', 'launch': 'a.launch', 'args': {'a': 1}, 'factors': {'f': [1, 2]}},
    'function': {'experiment': 'e', 'function': 'math:floor', 'factors': {'f': [1, 2]}},
    'command': {'experiment': 'e', 'command': ['true', '{f}'], 'participants': [], 'factors': {'f': [1, 2]}}}


def keys_of(cls):
    """Yield the keys of an experiment's file, those within others, too, as tuples."""
    for key, one in options_of(cls).items():
        yield (key,)
        if dataclasses.is_dataclass(one.initial):
            yield from ((key, *inner) for inner in keys_of(type(one.initial)))


@pytest.mark.parametrize('system', list(EXPERIMENTS))
@pytest.mark.parametrize('keys', times(list(keys_of(Experiment))[::10], list(keys_of(Experiment))), ids='.'.join)
def test_an_odd_value_in_an_experiments_file_is_refused_with_words_or_a_plan_is_made(system, keys, tmp_path):
    (tmp_path / 'a.launch').write_text('<launch><arg name="a"/></launch>')
    for value in times(DAY, ODD):
        document = copy.deepcopy(EXPERIMENTS[system])
        place = document
        for key in keys[:-1]:
            place = place.setdefault(key, {})
        place[keys[-1]] = value
        try:
            path = tmp_path / 'experiment.yaml'
            path.write_text(yaml.safe_dump(document))
            experiment = spec.read(str(path))
            assert json.dumps(spec.configurations(experiment))
        except ConfigurationError as error:
            assert str(error), value
