"""Travel matrices: legs that take as long as a table says, and what is wrong with a table, in one line."""
import json

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.travel_matrix import make_travel_matrix, read_travel_matrix
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import read_scenario

S = 1_000_000_000
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'
PLACES = [{'name': name, 'x': x, 'y': 0.0} for name, x in (('a', 0.0), ('b', 10.0), ('c', 40.0))]
TIMES = [{'from': one, 'to': other, 'seconds': seconds} for one, other, seconds in (
    ('a', 'b', 7.5), ('b', 'a', 20.0), ('b', 'c', 3.0), ('a', 'c', 8.0), ('c', 'c', 2.0))]
CSV = 'from,from_x,from_y,to,to_x,to_y,seconds\na,0,0,b,10,0,7.5\nb,10,0,a,0,0,20\n'


@pytest.fixture
def fleet_on(tmp_path):
    """Return a function that makes a Fleet of one robot, 'bot', at a."""
    def make(**settings):
        (tmp_path / 'matrix.yaml').write_text(json.dumps({'places': PLACES, 'times': TIMES}))
        (tmp_path / 'scenario.yaml').write_text(json.dumps({
            'travel_matrix': 'matrix.yaml', 'defaults': {'routes': 'matrix', **settings}, 'robots': [{'name': 'bot'}]}))
        return Fleet(read_scenario(tmp_path / 'scenario.yaml'), start_ns=0)
    return make


def go(fleet, x):
    """Return how long [s] the robot takes to ``x`` [m], and the text of the ending."""
    begin_ns = fleet.now_ns
    fleet.robot('bot').send(x, 0.0)
    fleet.run()
    return (fleet.now_ns - begin_ns) / S, fleet.trace[-1].values[2]


def test_legs_take_what_the_matrix_says_and_the_robot_is_on_the_straight_line(fleet_on):
    fleet = fleet_on(turn_rate=0.1)
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run(3 * S)
    assert (fleet.robot('bot').pose.x, fleet.robot('bot').pose.y) == pytest.approx((4.0, 0.0))
    fleet.run()
    assert fleet.now_ns == 7.5 * S and fleet.robot('bot').pose == Pose2D(10.0)
    assert [go(fleet, x)[0] for x in (40.0, 40.0)] == [3.0, 2.0]
    fleet.robot('bot').place(Pose2D(10.0, 0.05))  # near enough to b
    assert [go(fleet, x)[0] for x in (10.0, 0.0, 40.0)] == [0.0, 20.0, 8.0]


def test_a_pair_that_is_missing_and_a_goal_at_no_place_have_no_way(fleet_on):
    fleet = fleet_on()
    assert go(fleet, 40.0) == (8.0, 'Goal reached.')
    assert go(fleet, 0.0) == (0.0, NO_PLAN) and go(fleet, 20.0) == (0.0, NO_PLAN)


def test_who_was_stopped_between_two_places_has_the_rest_left(fleet_on):
    fleet = fleet_on()
    fleet.robot('bot').send(10.0, 0.0)
    fleet.run(3 * S)
    fleet.robot('bot').hold('test')
    fleet.run(10 * S)
    fleet.robot('bot').release('test')
    fleet.run()
    assert fleet.now_ns == pytest.approx(14.5 * S, abs=2)
    fleet.robot('bot').place(Pose2D(8.0, 5.0))  # off all lines: as from the nearest place, b
    assert go(fleet, 40.0)[0] == 3.0
    fleet.robot('bot').place(Pose2D(8.0, 5.0))
    assert go(fleet, 10.0)[0] == 7.5  # b is where it goes


def test_factors_of_durations_are_on_top(fleet_on):
    assert go(fleet_on(goal_overhead=1.0, duration_factor=2.0), 10.0)[0] == 16.0


def test_a_table_is_read_too(tmp_path):
    path = tmp_path / 'matrix.csv'
    path.write_text(CSV)
    matrix = read_travel_matrix(str(path), 'bot')
    assert matrix.places == {'a': (0.0, 0.0), 'b': (10.0, 0.0)} and matrix.seconds['b', 'a'] == 20.0


@pytest.mark.parametrize(('text', 'words'), [
    ('from,to,seconds\na,b,3\n', 'columns'), (CSV + 'a,0,0,c,5,x,1\n', 'line 4'), (CSV + 'a,1,0,c,5,5,1\n', "'a' is"),
    (CSV + 'a,0,0,b,10,0,1\n', 'there twice'), (CSV + 'a,0,0,c,5\n', 'line 4'), (CSV + 'a,0,0,c,5,5,nan\n', 'seconds')])
def test_a_table_that_cannot_be_is_refused_in_words(tmp_path, text, words):
    path = tmp_path / 'matrix.csv'
    path.write_text(text)
    with pytest.raises(ConfigurationError) as error:
        read_travel_matrix(str(path), 'bot')
    assert words in str(error.value) and str(path) in str(error.value)


@pytest.mark.parametrize(('raw', 'words'), [
    ([], 'places and times'), ({'places': PLACES, 'times': [], 'time': 1}, "did you mean 'times'?"),
    ({'places': [*PLACES, PLACES[0]], 'times': []}, 'places[3]'),
    ({'places': [*PLACES, {'name': 'd', 'x': 10.0, 'y': 0.1}], 'times': []}, "'b' and 'd' are 0.1 m apart"),
    ({'places': PLACES, 'times': [{'from': 'a', 'to': 'x', 'seconds': 1}]}, "to: got 'x'"),
    ({'places': PLACES, 'times': [{'from': 'a', 'to': 'b'}]}, 'seconds is missing; allowed: a number in 0'),
    ({'places': PLACES, 'times': [{'from': 'a', 'to': 'b', 'seconds': -1}]}, 'seconds: got -1')])
def test_a_matrix_that_cannot_be_is_refused_in_words(raw, words):
    with pytest.raises(ConfigurationError) as error:
        make_travel_matrix(raw, 'matrix.yaml')
    assert words in str(error.value) and 'matrix.yaml' in str(error.value)


def test_a_calibration_does_not_go_with_it(fleet_on):
    with pytest.raises(ConfigurationError, match='routes: matrix'):
        fleet_on(calibration='move_base_dwa_stage')
