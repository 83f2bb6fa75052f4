"""The built-in metrics, from event logs written by hand."""
import json

import pytest

from move_base_abstract.runs.event_log import EventLogError
from move_base_abstract_experiments.trials import functions, metrics, termination

SECOND = 10**9


def written(path, events, labels=()):
    lines = [{'event_log': 1, 'start_ns': SECOND}]
    lines += [{'time_ns': int(time * SECOND), 'robot': robot, 'kind': kind, 'values': values}
              for time, robot, kind, values in events]
    lines.append({'end': {'events': len(events), 'repeatable': not labels, 'not_repeatable_because': list(labels),
                          'degraded_because': [], 'reason': '', 'at_ns': 20_500_000_000}})
    path.write_text(''.join(json.dumps(line) + '\n' for line in lines))
    return str(path)


def test_a_robot_moves_waits_and_is_idle(tmp_path):
    path = written(tmp_path / 'log', [
        (2, 'r', 'departed', [3, 4, 0]), (7, 'r', 'stands', [3, 4, 0]), (9, 'r', 'ended', ['g', 'SUCCEEDED', '']),
        (10, 'r', 'departed', [3, 5, 0]), (11, 'r', 'stands', [3, 5, 0]), (11, 'r', 'ended', ['h', 'ABORTED', ''])])
    found = metrics.summarise(path, {'r': (0.0, 0.0)})
    assert found.robots == {'r': {'goals': 1, 'distance_m': 6.0, 'moving_s': 6.0, 'idle_s': 11.5, 'waiting_s': 2.0}}
    assert found.metrics == {'goals': 1, 'goals_failed': 1, 'makespan': 10.0, 'distance': 6.0, 'moving': 6.0,
                             'idle': 11.5, 'waiting': 2.0, 'throughput': 3600.0 / 19.5}
    assert (found.simulated_seconds, found.events, found.repeatable) == (19.5, 6, True)
    assert found.open_goals == 0


def test_encounters_are_counted_where_robots_meet_and_only_there(tmp_path):
    meets = [(1, 'r', 'meets', [3.0]), (1, 's', 'meets', [3.0])]
    found = metrics.summarise(written(tmp_path / 'log', meets)).metrics
    assert (found['encounters'], found['encounter_time']) == (0, 0.0)
    met = [(5, 'r', 'encounter', ['s', 'crossing', 0.5, 4.25]), (5, 's', 'encounter', ['r', 'crossing', 0.5, 0.0]),
           (9, 'r', 'encounter', ['s', 'crossing', 0.5, 1.0]), (9, 's', 'encounter', ['r', 'crossing', 0.5, 2.0])]
    found = metrics.summarise(written(tmp_path / 'log', meets + met)).metrics
    assert (found['encounters'], found['encounter_time']) == (2, 7.25)
    assert 'encounters' not in metrics.summarise(written(tmp_path / 'log', [])).metrics


def test_the_first_leg_needs_a_start_and_a_leg_that_is_cut_off_adds_nothing(tmp_path):
    path = written(tmp_path / 'log', [(2, 'r', 'departed', [3, 4, 0]), (7, 'r', 'stands', [3, 4, 0]),
                                      (7, 'r', 'departed', [9, 9, 0])])
    found = metrics.summarise(path)
    assert found.metrics['distance'] == 0.0
    assert found.robots['r']['moving_s'] == 5.0 + 13.5
    assert found.metrics['makespan'] is None
    assert found.open_goals == 1


def test_where_a_robot_is_first_and_how_it_drives_is_in_the_log(tmp_path):
    back = [[9 * SECOND, 3, 4, 0, 0, 1, -1, 0, 0, 0], [13 * SECOND, 3, 0, 0, 1, 0, -1, 0, 0, 0],
            [16 * SECOND, 0, 0, 0, 1, 0, 0, 0, 0, 0]]
    on = [[11 * SECOND, 3, 2, 0, 0, 1, 1, 0, 0, 0], [19 * SECOND, 3, 10, 0, 0, 1, 0, 0, 0, 0]]
    path = written(tmp_path / 'log', [
        (1, 'r', 'motion', [0, 0, 0, 1, 0, 0, 0, 0]), (1, 'idle', 'motion', [5, 5, 0, 1, 0, 0, 0, 0]),
        (2, 'r', 'departed', [3, 4, 0]), (9, 'r', 'stands', [3, 4, 0]),
        (9, 'r', 'departed', [0, 0, 0]), (9, 'r', 'pieces', back), (11, 'r', 'stands', [3, 2, 0]),
        (11, 'r', 'departed', [3, 10, 0]), (11, 'r', 'pieces', on), (12, 'r', 'motion', [3, 3, 0, 2, 0, 0, 0, 0]),
        (12, 'r', 'departed', [3, 4, 0]), (13, 'r', 'stands', [3, 4, 0])])
    found = metrics.summarise(path)
    assert {name: one['distance_m'] for name, one in found.robots.items()} == {
        'r': 5.0 + 2.0 + 1.0 + 1.0, 'idle': 0.0}
    assert found.robots['idle']['idle_s'] == 19.5


def test_labels_are_told(tmp_path):
    found = metrics.summarise(written(tmp_path / 'log', [], labels=['a clock']))
    assert (found.repeatable, found.labels, found.metrics['moving']) == (False, ['a clock'], None)


def test_a_run_without_an_end_is_an_error(tmp_path):
    path = tmp_path / 'log'
    path.write_text('{"event_log":1,"start_ns":0}\n')
    with pytest.raises(EventLogError, match='did not end properly'):
        metrics.summarise(str(path))


def test_what_a_function_may_return():
    assert functions.checked({'a': 1, 'b': True, 'c': float('nan'), 'd': None}, [], []) == {
        'a': 1, 'b': 1, 'c': None, 'd': None}
    for bad in ([], {'a': 'x'}, {'a b': 1}, {'goals': 1}, {'robots': 1}, {'a': float('-inf')}):
        with pytest.raises((TypeError, ValueError)):
            functions.checked(bad, ['robots'], ['goals'])


@pytest.mark.parametrize(('end', 'word'), [
    ({'ended_by': 'idle'}, 'idle'), ({'ended_by': 'departure', 'node': '/a/b'}, 'required /a/b'),
    ({'ended_by': 'end_at'}, 'seconds'), ({'ended_by': 'departure', 'node': '/experiment_end'}, 'topic'),
    ({'ended_by': 'idle', 'by_fault': True}, 'fault'), ({'ended_by': 'other', 'reason': 'SIGTERM'}, 'other'),
    ({'reason': 'idle at 12.5 s'}, 'other')])
def test_how_a_run_ended_is_said_in_a_word(end, word):
    assert termination.of_run(end) == word


@pytest.mark.parametrize('values', [[10 ** 400, 0, 0], ['x', 'y', 0], [None, None], [1e309, 0.0, 0.0],
                                    [[], {}, 0], [True, 1]])
def test_a_row_of_others_that_holds_no_place_is_none(tmp_path, values):
    good = [(2, 'r', 'departed', [3, 4, 0]), (7, 'r', 'stands', [3, 4, 0])]
    strange = [(5, 'r', kind, values) for kind in ('stands', 'departed', 'pieces', 'motion')]
    plain, mixed = (metrics.summarise(written(tmp_path / 'log', rows), {'r': (0.0, 0.0)})
                    for rows in (good, [good[0], *strange, good[1]]))
    assert plain.metrics == mixed.metrics


def test_pieces_of_another_instant_than_the_departure_are_of_others(tmp_path):
    way = [[2 * SECOND, 0, 0, 0, 1, 0, 9, 0, 0, 0], [7 * SECOND, 45, 0, 0, 1, 0, 0, 0, 0, 0]]
    strange = [[3 * SECOND, *way[0][1:]], [4 * SECOND, *way[1][1:]]]
    rows = [(2, 'r', 'departed', [3, 4, 0]), (2, 'r', 'pieces', way), (2, 'r', 'pieces', [7]),
            (2, 'r', 'pieces', strange), (3, 'r', 'pieces', strange), (7, 'r', 'stands', [3, 4, 0])]
    assert metrics.summarise(written(tmp_path / 'log', rows), {'r': (0.0, 0.0)}).metrics['distance'] == 45.0


def test_goals_outside_of_what_was_recorded_are_a_share_of_all_that_were_begun(tmp_path):
    path = written(tmp_path / 'log', [
        (1, 'r', 'recorded', ['length', 1.0, 30.0, 'start_turn', 0.0, 2.0]),
        (2, 'r', 'beyond', ['longer', 40.0, 'turn', 3.0]), (2, 'r', 'departed', [3, 4, 0]),
        (3, 'r', 'stands', [1, 1, 0]), (4, 'r', 'departed', [3, 4, 0]),  # it goes on: the same goal
        (7, 'r', 'stands', [3, 4, 0]), (9, 'r', 'ended', ['g', 'SUCCEEDED', '']),
        (10, 'r', 'departed', [3, 5, 0]), (11, 'r', 'ended', ['h', 'PREEMPTED', '']), (11, 'r', 'stands', [3, 5, 0]),
        (11, 'r', 'beyond', ['narrow', 0.2]), (11, 'r', 'departed', [3, 5, 0]),
        (12, 'r', 'stands', [3, 5, 0]), (12, 'r', 'ended', ['i', 'ABORTED', '']),
        (13, 'plain', 'departed', [3, 5, 0]), (13, 'plain', 'beyond', ['longer', 1.0])])
    found = metrics.summarise(path)
    assert found.metrics['goals_beyond'] == pytest.approx(200.0 / 3.0)
    assert {name: value for name, value in found.robots['r'].items() if name.startswith('goals_')} == {
        'goals_begun': 3, 'goals_beyond': 2, 'goals_beyond_longer': 1, 'goals_beyond_shorter': 0,
        'goals_beyond_turn': 1, 'goals_beyond_narrow': 1}
    assert not any(name.startswith('goals_') for name in found.robots['plain'])


def test_a_robot_that_has_said_what_was_recorded_and_done_nothing_has_no_share(tmp_path):
    found = metrics.summarise(written(tmp_path / 'log', [(1, 'r', 'recorded', ['length', 1.0, 30.0])]))
    assert found.metrics['goals_beyond'] is None
