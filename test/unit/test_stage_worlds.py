"""World files are read as Stage reads them: units, files within files, robots within models, names, numbers."""
import math

import pytest

from move_base_abstract_ros.adopting import worlds
from strangers_package import adopt, package_fixture, write_map, write_stage  # noqa: F401 - a fixture

QUARTER = math.pi / 2
# The format of Stage's own tests of macros: properties with an index, and one that is there twice.
INDEXED = """define sonar_p2dx sonar ( scount 2 spose[0] [0 0 0] polygon[0].point[1] [ 0.15 0.15 ] )
define robot_x position ( name "x" port 6665 player () sonar_p2dx () laser (pose [0.05 0 0]) )
robot_x (name "one" name "two" pose [1 2 0])
robot_x (name "three" port 6666 pose [1 3 0])
"""


@pytest.fixture(name='robots')
def robots_fixture(tmp_path):
    """Return robots(text, {name: text}): those of a world file, with other files in folders around it."""
    def robots(text, files=None):
        (tmp_path / 'worlds').mkdir()
        for name, content in {'worlds/a.world': text, **(files or {})}.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(content)
        return worlds.read(str(tmp_path / 'worlds' / 'a.world')).robots
    return robots


@pytest.mark.parametrize(('text', 'expected'), [
    ('unit_angle "radians" position ( pose [ 1 2 0 0.5 ] )', [('', 1, 2, 0.5)]),
    ('position ( pose [ 1 2 0 90 ] ) unit_angle "degrees" unit_length "m"', [('', 1, 2, QUARTER)]),
    ('unit_length "cm" position ( pose [ 100 -250 30 90 ] )', [('', 1, -2.5, QUARTER)]),
    ('position ( pose [ 1000 0 0 0 ] ) unit_length "mm"', [('', 1, 0, 0)]),
    ('position ( name "a" pose [ 1 2 0 90 ] position ( name "b" pose [ 1 0 0 90 ] ) ) position ( name "c" )',
     [('a', 1, 2, QUARTER), ('b', 1, 3, 2 * QUARTER), ('c', 0, 0, 0)]),
    ('model ( pose [ 5 5 0 180 ] model ( pose [ 1 0 0 0 ] position ( pose [ 1 1 0 0 ] ) ) )', [('', 3, 4, math.pi)]),
    ('define pair model ( position ( pose [ 1 0 0 0 ] ) position ( pose [ -1 0 0 0 ] ) ) pair ( pose [ 2 0 0 0 ] )',
     [('', 3, 0, 0), ('', 1, 0, 0)]),
    ('define rob position ( pose [ 1 1 0 0 ] ) define rob model ( ) rob ( )', [('', 1, 1, 0)]),
    ('position ( pose [ 3.75.2 -.5 +1 1. ] )', [('', 3.75, -0.5, math.radians(1))]),
    ('position ( pose [ - 2-1 0 0 ] )', [('', 0, 2, 0)]),
    (INDEXED, [('two', 1, 2, 0), ('three', 1, 3, 0)])])
def test_robots_stand_where_stage_puts_them(robots, text, expected):
    assert [(name, *map(pytest.approx, pose)) for name, pose in robots(text)] == expected


@pytest.mark.parametrize('number', ['nan', '1e999', 'inf', '1,5', '9' * 400])
def test_a_number_that_is_none_costs_one_place_and_those_within_it(robots, number):
    text = 'position ( pose [ {} 0 0 0 ] position ( name "in" ) ) position ( pose [ 1 0 0 0 ] )'.format(number)
    assert robots(text) == (('', None), ('in', None), ('', (1.0, 0.0, 0.0)))


def test_files_are_looked_for_from_the_folder_of_the_world_then_in_stages_path(robots, tmp_path, monkeypatch):
    monkeypatch.setenv('STAGEPATH', ':{}'.format(tmp_path / 'far'))
    found = robots('include "../inc/all.inc" rob ( pose [ 1 2 0 0 ] ) cart ( pose [ 0 1 0 0 ] )', {
        'inc/all.inc': 'include "deep/robots.inc"\ninclude "carts.inc"', 'far/carts.inc': 'define cart model ( )',
        'worlds/deep/robots.inc': 'define rob position ( name "right" )',
        'inc/deep/robots.inc': 'define rob position ( name "wrong" )'})
    assert found == (('right', (1.0, 2.0, 0.0)),)


def test_the_image_of_a_floor_plan_is_looked_for_there_too_and_its_size_has_the_units(tmp_path):
    (tmp_path / 'inc').mkdir()
    (tmp_path / 'inc' / 'map.inc').write_text('define floorplan model ( bitmap "walls.png" )')
    path = tmp_path / 'a.world'
    path.write_text('unit_length "cm" unit_angle "radians" include "inc/map.inc"\n'
                    'floorplan ( size [ 400 300 80 ] pose [ 100 0 0 0.5 ] )')
    floor = worlds.read(str(path)).floor
    assert floor == worlds.Floor(1.0, 0.0, 0.5, 4.0, 3.0, str(tmp_path / 'walls.png'))


@pytest.mark.parametrize('text', [
    'define a position ( a ( ) ) a ( )',
    ''.join('define m{} model ( {} )'.format(k, 'm{} ( )'.format(k + 1) * 9) for k in range(9)) + ' m0 ( )'])
def test_models_within_one_another_without_an_end_are_refused(robots, text):
    with pytest.raises(ValueError, match='parts lie within one another'):
        robots(text)


def test_a_robot_whose_place_is_no_number_keeps_its_place_in_the_order(package):
    write_map(package)
    made = adopt(write_stage(package, '0 0 0 0', first='nan 2.0 0 90.0'))
    assert dict(made.options.start) == {'/robot_1/move_base': pytest.approx((1.0, 2.5, math.pi))}
    assert any(line.startswith('/robot_0/move_base starts at (0, 0, 0): ') for line in made.remarks)


def test_stage_names_robots_as_the_world_does_if_asked(package):
    write_map(package)
    made = adopt(write_stage(package, '2.0 1.5 0 0', options='-g -u', names=('bob', 'alice')))
    assert tuple(made.options.start.items()) == (('/bob/move_base', (-1.0, 1.0, math.pi)),
                                  ('/alice/move_base', (1.0, 2.0, math.pi / 2)))
