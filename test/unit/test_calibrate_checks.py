"""What calibrate finds wrong with recordings: each kind is made on purpose, is named with a count, and left out."""
from pathlib import Path

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_calibration import checks
from move_base_abstract_calibration.csv_files import read_legs
from move_base_abstract_calibration.legs import RecordedLeg, Way

ROOT = Path(__file__).resolve().parents[2]
SMALL = ROOT / 'examples' / 'calibration' / 'move_base_stage_legs.csv'


@pytest.fixture(name='good')
def good_legs():
    """Return 40 legs of one robot, to and fro, each with its stamps, nothing wrong with any."""
    legs, at, now = [], Pose2D(0.0, 0.0, 0.0), 10.0
    for number in range(1, 41):
        goal = Pose2D(10.0 + number if number % 2 else 0.0, 3.0 if number % 4 < 2 else 0.0, 0.5)
        length = at.distance_to(goal)
        end = Pose2D(goal.x - 0.1 if number % 2 else goal.x + 0.1, goal.y, goal.yaw)
        legs.append(RecordedLeg('day', 'bot', number, at, goal, length + 4.0 + 0.01 * number, True, False,
                                Way(length, 0.0, 0.5), end, sent=now, by_stamps=length + 4.0 + 0.01 * number))
        at, now = end, now + length + 10.0
    return legs


def without(legs, notes):
    """Return which numbers are not among ``legs``, and the notes as one text."""
    return sorted(set(range(1, 41)) - {leg.number for leg in legs}), '; '.join(notes)


def test_nothing_is_wrong_with_what_is_well_recorded(good):
    assert checks.examine(good) == (good, [])
    shipped = read_legs(SMALL)
    kept, notes = checks.examine(shipped)
    assert len(kept) == len(shipped)
    assert notes == ['6 legs were moved, stuck from the start or cut off, and do not count']


def moved(pose, x, y=0.0):
    return Pose2D(pose.x + x, pose.y + y, pose.yaw)


@pytest.mark.parametrize(('change', 'words'), [
    (lambda leg: {'by_stamps': leg.duration + 3600.0}, 'the clock leapt'),
    (lambda leg: {'by_stamps': leg.duration - 0.3}, 'the clock leapt'),
    (lambda leg: {'duration': 2.0, 'by_stamps': 2.0}, 'poses that jump'),
    (lambda leg: {'end': moved(leg.end, 0.0, 0.7)}, 'ended far from their goal'),
    (lambda leg: {'way': Way(leg.way.length - 3.0, 0.0, 0.0)}, 'shorter than the straight line'),
    (lambda leg: {'doubt': 'rare'}, 'too rare'),
    (lambda leg: {'doubt': 'clock_back'}, 'showed twice'),
])
def test_a_bad_leg_is_named_and_left_out(good, change, words):
    good[7] = good[7]._replace(**change(good[7]))
    good[20] = good[20]._replace(**change(good[20]))
    kept, notes = checks.examine(good)
    numbers, said = without(kept, notes)
    assert numbers == [8, 21]
    assert said.startswith('2 legs ') and words in said


def test_the_same_leg_twice_counts_once(good):
    kept, notes = checks.examine([*good, good[3]._replace(recording='copy'), good[4]._replace(recording='copy')])
    assert kept == good
    assert notes == ['2 legs are there twice, and are left out']


def test_a_clock_that_started_anew_spoils_the_legs_in_the_times_that_it_showed_twice(good):
    back = good[30].sent - good[25].sent
    legs = good[:30] + [leg._replace(sent=leg.sent - back) for leg in good[30:]]
    kept, notes = checks.examine(legs)
    numbers, said = without(kept, notes)
    latest = good[29].sent + good[29].duration
    new = [leg.number for leg in legs[30:] if leg.sent < latest]
    assert numbers == [*range(26, 31), *new]  # of the old times and of the new ones
    assert said == '{} legs lie in times that the clock showed twice, and are left out'.format(5 + len(new))


def test_one_robot_that_drives_two_legs_at_once_is_two_robots(good):
    legs = good[:10] + [good[10]._replace(sent=good[9].sent + 2.0)] + good[11:]
    numbers, said = without(*checks.examine(legs))
    assert numbers == [10, 11]
    assert 'two robots under one name' in said
    both = good + [leg._replace(start=moved(leg.start, 50.0), goal=moved(leg.goal, 50.0), end=moved(leg.end, 50.0))
                   for leg in good]
    with pytest.raises(ConfigurationError, match='80 of 80 legs began before .* two robots'):
        checks.examine(both)
    without_stamps = [leg._replace(sent=None, by_stamps=None) for leg in both]
    with pytest.raises(ConfigurationError, match='begin further than 1 m .* two robots under one name'):
        checks.examine(without_stamps)


def test_a_robot_that_was_carried_between_legs_is_told_and_counts(good):
    good[5] = good[5]._replace(start=moved(good[5].start, 2.0), way=None)
    kept, notes = checks.examine(good)
    assert kept == good
    assert len(notes) == 1 and notes[0].startswith('1 of 39 legs begin further than 1 m from where')


@pytest.mark.parametrize('frame', [
    lambda pose: moved(pose, 30.0, -12.0),  # another origin
    lambda pose: moved(pose, 0.4),  # a map that lies a little beside
    lambda pose: Pose2D(-pose.y, pose.x, pose.yaw + 1.57),  # turned
])
def test_poses_of_another_frame_are_refused(good, frame):
    wrong = [leg._replace(start=frame(leg.start), end=frame(leg.end), way=None) for leg in good]
    with pytest.raises(ConfigurationError, match='another frame or map'):
        checks.examine(wrong)


def test_a_tolerance_is_no_other_frame(good):
    wide = [leg._replace(end=moved(leg.goal, -0.4 if leg.number % 2 else 0.4)) for leg in good]
    assert checks.examine(wide)[0] == wide


def test_what_is_wrong_with_most_is_refused(good):
    with pytest.raises(ConfigurationError, match='further than 1 m apart: too rare, more than half'):
        checks.examine([leg._replace(doubt='rare') if leg.number <= 30 else leg for leg in good])


def test_legs_that_do_not_count_are_counted(good):
    good[2] = good[2]._replace(counts=False)
    good[3] = good[3]._replace(succeeded=False)
    kept, notes = checks.examine(good)
    assert kept == good
    assert notes == ['1 legs were moved, stuck from the start or cut off, and do not count',
                     '1 legs neither succeeded nor aborted (no result, preempted, cancelled), and do not count']


def test_stamps_and_clearances_of_a_table_are_read(tmp_path):
    path = tmp_path / 'legs.csv'
    path.write_text('start_x,start_y,start_yaw,goal_x,goal_y,goal_yaw,duration_s,state,send_s,result_s,'
                    'plan_clearance_m\n0,0,0,5,0,0,9,3,100,109,0.4\n0,0,0,5,0,0,9,3,,,\n')
    one, other = read_legs(path)
    assert (one.sent, one.by_stamps, one.clearance) == (100.0, 9.0, 0.4)
    assert (other.sent, other.by_stamps, other.clearance) == (None, None, None)
