"""What a replay finds in an event log: events, legs and places, states."""
import json
import math

import numpy as np
import pytest

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.calibration import calibration_file
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.runs.event_log import EventLogError
from move_base_abstract.runs.states import NAMES
from move_base_abstract.scenario import make_scenario
from move_base_abstract_replay.motions import Motions
from move_base_abstract_replay.page_data import story_of
from move_base_abstract_replay.recording import ReplayError, read_recording
from move_base_abstract_replay.timelines import find_timelines

S = 1_000_000_000
GONE = {'max_speed': 2.0, 'acceleration': 0.5, 'turn_rate': 1.0, 'log_motion': True}


def log_text(entries, end=True):
    lines = ['{"event_log":1,"start_ns":1000000000}']
    lines += [json.dumps(dict(zip(('time_ns', 'robot', 'kind', 'values'), (*entry[:3], list(entry[3])))))
              for entry in entries]
    if end:
        lines.append(json.dumps({'end': {'events': len(entries), 'not_repeatable_because': [],
                                         'degraded_because': []}}))
    return '\n'.join(lines) + '\n'


@pytest.fixture
def read(tmp_path):
    """Return what reads entries as a log."""
    def reader(entries, **options):
        path = tmp_path / 'run.jsonl'
        path.write_text(log_text(entries, options.pop('end', True)))
        return read_recording(path, **options)
    return reader


def make_fleet(**settings):
    return Fleet(make_scenario({'robots': [dict(GONE, name='r_0', start_x=1.0, **settings), dict(GONE, name='r_1')]}))


def pose_drawn(motions, name, time_ns):
    """Return the pose that the page draws of a robot."""
    end_ns, motion = [one for one in motions.tracks[name].driven if one.motion.depart_ns <= time_ns][-1]
    return motion.pose_at(min(time_ns, end_ns))


def follow(fleet, read, seconds):
    """Let a fleet run; return the Motions of its log, of which all poses of the first robot are those of the fleet."""
    poses = {}
    for k in range(4 * seconds):
        fleet.at(S + k * S // 4 + 1, lambda fleet: poses.update({fleet.now_ns: fleet.robot('r_0').pose}))
    fleet.run(until=seconds + 1.0)
    motions = Motions(read(fleet.trace))
    assert (motions.even, motions.startless) == (0, 0)
    for time_ns, pose in poses.items():
        if time_ns <= fleet.trace[-1].time_ns:
            assert pose_drawn(motions, 'r_0', time_ns) == pose
    return motions


def test_a_fleet_that_says_its_motion_is_followed_exactly_at_every_instant(read):
    fleet = make_fleet(xy_goal_tolerance=0.25, yaw_goal_tolerance=0.1)
    fleet.robot('r_0').send(8.0, 3.0, 1.0)
    fleet.at(3 * S, lambda fleet: fleet.robot('r_0').send(-4.0, 2.0, -3.0))  # before the first is reached
    fleet.at(40 * S, lambda fleet: fleet.robot('r_0').place(Pose2D(0.5, 0.5, 0.5)))
    fleet.at(41 * S, lambda fleet: fleet.robot('r_0').send(5.0, 0.0))
    fleet.at(43 * S, lambda fleet: fleet.robot('r_0').place(Pose2D(0.5, 0.5, 0.5)))  # on the way
    motions = follow(fleet, read, 60)
    assert [len(one.motion.pieces) > 0 for one in motions.tracks['r_0'].driven] == [
        False, True, True, False, True, False, True]


@pytest.mark.parametrize('corners', ['keep', 'stop'])
def test_a_way_with_corners_is_followed_also_where_it_is_cut_short(read, corners):
    cells = np.zeros((12, 12), np.int8)
    cells[2:, 5] = 100
    scenario = make_scenario({'robots': [dict(GONE, name='r_0', start_x=2.5, start_y=5.5, use_map=True, routes='grid',
                                              robot_radius=0.0, corners=corners)]})
    fleet = Fleet(scenario, occupancy=OccupancyMap(cells, 1.0))
    fleet.at(S, lambda fleet: fleet.robot('r_0').send(8.5, 5.5, 1.0))
    fleet.at(40 * S, lambda fleet: fleet.robot('r_0').send(2.5, 5.5, 1.0))
    fleet.at(43 * S, lambda fleet: fleet.robot('r_0').cancel())  # on the way
    driven = follow(fleet, read, 45).tracks['r_0'].driven
    assert driven[-1].end_ns < driven[-1].motion.arrive_ns


def of_tail(law):
    """Return the path of a calibration whose goals are all of the tail: backwards, or else spinning."""
    raw = load_yaml_file(calibration_file('move_base_dwa_stage', 'here'))
    chance = 1.0 if law == 'backwards' else 0.0
    return dict(raw, tail_rate=1.0, tail_chance_by_turn=[[0.0, chance], [3.14, chance]])


@pytest.mark.parametrize('law', ['backwards', 'spins'])
def test_a_calibrated_robot_is_followed_while_it_spins_and_drives_backwards(read, tmp_path, law):
    path = tmp_path / 'tail.yaml'
    path.write_text(json.dumps(of_tail(law)))
    places = ((0.0, 0.0, 1.0), (9.0, 3.0, -2.0), (4.0, -6.0, 3.0))
    fleet = Fleet(make_scenario({'robots': [{'name': 'r_0', 'calibration': str(path), 'log_motion': True, 'seed': 5}]}),
                  on_end=lambda *_: fleet.robot('r_0').send(*places[fleet.now_ns % 3]))
    fleet.robot('r_0').send(*places[1])
    pieces = [piece for one in follow(fleet, read, 300).tracks['r_0'].driven for piece in one.motion.pieces]
    assert any(piece.v < 0.0 for piece in pieces) == (law == 'backwards')
    assert any(piece.k for piece in pieces)


def test_nothing_is_said_of_motion_unless_it_is_asked_for():
    fleet = Fleet(make_scenario({'robots': [{'name': 'quiet'}, {'name': 'told', 'log_motion': True}]}))
    assert [entry.robot for entry in fleet.trace if entry.kind == 'motion'] == ['told']


def test_without_pieces_a_leg_is_straight_and_even_and_the_first_one_has_no_beginning(read):
    motions = Motions(read([(S, 'a', 'departed', (4.0, 0.0, 0.0)), (3 * S, 'a', 'stands', (4.0, 0.0, 0.0)),
                            (3 * S, 'a', 'motion', (9.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)),  # it was put there
                            (5 * S, 'a', 'departed', (9.0, 9.0, 0.0)), (6 * S, 'a', 'stands', (8.0, 0.0, 0.5)),
                            (7 * S, 'a', 'departed', (1.0, 1.0, 0.0)), (9 * S, 'a', 'stands', (8.0, 0.0, 1.5)),
                            (9 * S, 'a', 'departed', (1.0, 1.0, 0.0))]))
    assert (motions.startless, motions.even) == (1, 4)
    assert [(one.motion.depart_ns // S, one.end_ns // S) for one in motions.tracks['a'].driven] == [
        (3, 3), (3, 3), (5, 6), (7, 9)]
    half = pose_drawn(motions, 'a', 5 * S + S // 2)
    assert (half.x, half.y, half.yaw) == pytest.approx((8.5, 0.0, math.pi))
    assert pose_drawn(motions, 'a', 6 * S) == Pose2D(8.0, 0.0, 0.5)
    assert pose_drawn(motions, 'a', 8 * S) == Pose2D(8.0, 0.0, 1.0)


@pytest.mark.parametrize('values', [(), ('a', 1.0, 2.0), (1e400, 0.0, 0.0), (True, 0.0, 0.0), (0.0, 0.0),
                                    (10 ** 400, 0, 0), ([2 * S, *[0.0] * 8],)])
def test_lines_of_others_under_the_same_names_are_events_and_nothing_else(read, values):
    rows = [(2 * S, 'a', kind, values) for kind in ('departed', 'stands', 'motion', 'pieces')]
    recording = read(rows)
    assert len(recording) == 4
    assert Motions(recording).tracks == {}
    leg = [(2 * S, 'a', 'stands', (0.0, 0.0, 0.0)), (2 * S, 'a', 'departed', (4.0, 0.0, 0.0)), rows[-1],
           (4 * S, 'a', 'stands', (4.0, 0.0, 0.0))]
    assert pose_drawn(Motions(read(leg)), 'a', 3 * S) == Pose2D(2.0, 0.0)


def lines_of(recording, robots):
    return find_timelines(recording, story_of(recording), robots)


def spans(line):
    return [(span.begin_ns // S, span.end_ns // S, NAMES[span.state]) for span in line.spans]


def test_states_come_from_pairs_of_events_and_driving_hides_work(read):
    recording = read([(S, 'r', 'departed', (1.0, 0.0, 0.0)), (4 * S, 'r', 'stands', (1.0, 0.0, 0.0)),
                      (4 * S, 'r/dig', 'task_began', ('x', 2 * S)), (6 * S, 'r/dig', 'task_ended', ('x', 'ABORTED')),
                      (7 * S, 'r', 'charging_began', ()), (8 * S, 'r', 'task_began', ('y', S)),
                      (9 * S, 'r', 'charging_ended', ()), (9 * S, 'other', 'note', ()),
                      (9 * S, 'r', 'ended', ('g', 'ABORTED', ''))])
    robot, other = lines_of(recording, ['r'])
    assert spans(robot) == [(1, 4, 'driving'), (4, 6, 'working'), (6, 8, 'waiting'), (8, 9, 'working')]
    assert robot.failures == [6 * S, 9 * S]
    assert (other.name, other.is_robot, other.ticks) == ('other', False, [9 * S])


def test_a_robot_that_is_held_waits_if_it_has_a_goal_however_many_reasons_there_were(read):
    recording = read([(S, 'r', 'departed', (1.0, 0.0, 0.0)), (2 * S, 'r', 'held', ('a',)),
                      (2 * S, 'r', 'stands', (1.0, 0.0, 0.0)), (3 * S, 'r', 'held', ('a', 'b')),
                      (4 * S, 'r', 'held', ('b',)), (5 * S, 'r', 'released', ()),
                      (6 * S, 'r', 'departed', (1.0, 0.0, 0.0)), (7 * S, 'r', 'stands', (1.0, 0.0, 0.0)),
                      (7 * S, 'r', 'ended', ('g', 'SUCCEEDED', '')), (8 * S, 'r', 'held', ('a',)),
                      (9 * S, 'r', 'goal', ('h',)), (10 * S, 'r', 'ended', ('h', 'PREEMPTED', ''))])
    (robot,) = lines_of(recording, ['r'])
    assert spans(robot) == [(1, 2, 'driving'), (2, 6, 'waiting'), (6, 7, 'driving'), (9, 10, 'waiting')]


def test_names_of_which_there_are_only_messages_come_last(read):
    recording = read([(S, '/r/move_base/goal', 'message', ('/boss', '/r/move_base', 9, 'ff')),
                      (3 * S, 'z', 'note', ()), (5 * S, '/ask', 'call', ('/boss', '/r/move_base', 9, 'ff'))])
    assert [(line.name, line.ticks) for line in lines_of(recording, [])] == [('z', [3 * S]), ('/boss', [S, 5 * S])]


def test_of_too_many_events_messages_are_left_out(read):
    entries = [(S + k, '/t', 'message', ('/a', '/b', 9, 'ff')) for k in range(5)] + [(9 * S, 'r', 'note', ())]
    recording = read(entries, most=3)
    assert [kind for _, _, kind, _ in recording] == ['message'] * 3 + ['note']
    assert (recording.left_out, recording.events, recording.begin_ns, recording.end_ns) == (2, 6, S, 9 * S)


def test_an_unfinished_run_is_read_and_says_so(read):
    recording = read([(S, 'a', 'note', ())], end=False)
    assert (len(recording), recording.is_repeatable, len(recording.remarks)) == (1, False, 1)


def test_what_is_no_log_is_an_error_that_names_the_file(tmp_path):
    path = tmp_path / 'no.jsonl'
    path.write_text('{}\n')
    with pytest.raises(EventLogError, match='no.jsonl:1: is not the head'):
        read_recording(path)


@pytest.mark.parametrize('times', [(-1,), (2 ** 31 * S,), (2 ** 63 - 1,), (2 * S, S)])
def test_times_that_no_run_has_are_an_error_that_names_the_line(read, times):
    with pytest.raises(ReplayError, match='run.jsonl:{}: got the time {} ns'.format(len(times) + 1, times[-1])):
        read([(time_ns, 'a', 'note', ()) for time_ns in times])
