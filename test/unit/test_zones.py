"""Zones of a scenario: what may be said of them, and what is wrong with it, in one line."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.scenario import make_scenario

GATE = {'name': 'gate', 'rectangle': [4, -1, 6, 1], 'capacity': 1}


def zones_of(*zones):
    return make_scenario({'zones': list(zones)}, 's.yaml').zones


def test_zones_keep_their_order_names_outlines_and_capacities():
    gate, yard = zones_of(GATE, {'name': 'yard', 'polygon': [[0, 0], [20, 0], [20, 10]]})
    assert (gate.name, gate.capacity, gate.outline.box) == ('gate', 1, (4.0, -1.0, 6.0, 1.0))
    assert (yard.name, yard.capacity, yard.outline.points) == ('yard', None, ((0.0, 0.0), (20.0, 0.0), (20.0, 10.0)))
    assert gate.contains(5.0, 0.0) and not gate.contains(5.0, 1.0)
    assert zones_of(dict(GATE, capacity=None))[0].capacity is None and make_scenario({'zones': None}).zones == ()


@pytest.mark.parametrize(('zone', 'words'), [
    ([1], ['zones[0]', '[1]', 'a mapping']),
    (dict(GATE, capasity=1), ['capasity', "did you mean 'capacity'?"]),
    (dict(GATE, capacity=0), ['capacity', 'a whole number >= 1']),
    (dict(GATE, capacity=1.5), ['capacity', '1.5']),
    (dict(GATE, capacity=True), ['capacity', 'True']),
    (dict(GATE, name='a gate'), ['name', 'a gate', 'letters']),
    ({'rectangle': [0, 0, 1, 1]}, ['name', 'is missing']),
    ({'name': 'gate'}, ['neither rectangle and polygon']),
    (dict(GATE, polygon=[[0, 0], [1, 0], [0, 1]]), ['both rectangle and polygon']),
    (dict(GATE, rectangle=[6, -1, 4, 1]), ['rectangle', 'x_min < x_max']),
    (dict(GATE, rectangle=[4, -1, 6]), ['rectangle', 'x_min < x_max']),
    (dict(GATE, rectangle=[4, -1, 6, float('nan')]), ['rectangle', 'x_min < x_max']),
    (dict(GATE, rectangle=[4, -1, 6, 1e300]), ['rectangle', '1e9']),
    (dict(GATE, rectangle='gate'), ['rectangle', "'gate'"]),
    ({'name': 'x', 'polygon': [[0, 0], [1, 1], [1, 0], [0, 1]]}, ['polygon', 'crosses or touches itself']),
    ({'name': 'x', 'polygon': [[0, 0], [1, 1]]}, ['polygon', '2 different points', '3 to 200']),
    ({'name': 'x', 'polygon': [[0, 0, 0], [1, 1], [1, 0]]}, ['polygon', 'points [x, y]']),
    ({'name': 'x', 'polygon': 3}, ['polygon', 'got 3']),
])
def test_a_zone_that_cannot_be_is_refused_in_words(zone, words):
    with pytest.raises(ConfigurationError) as error:
        zones_of(zone)
    for word in ('s.yaml', 'zones[0]', *words):
        assert word in str(error.value)


def test_two_zones_have_two_names_and_zones_are_a_list():
    with pytest.raises(ConfigurationError, match=r"zones\[1\]: the name 'gate' is that of zones\[0\] too"):
        zones_of(GATE, GATE)
    with pytest.raises(ConfigurationError, match='zones: got'):
        make_scenario({'zones': {'gate': GATE}})
