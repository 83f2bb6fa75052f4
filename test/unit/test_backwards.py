"""Goals of the tail that drive backwards or spin: they arrive when they would, and every pose between follows."""
import copy
import math
import os

import pytest
from night import times

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.motion.calibration import make_calibration
from move_base_abstract.motion.durations import GoalDurations
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.pieces import acceleration_of
from move_base_abstract.motion.route import CornerLaw

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
RAW = load_yaml_file(os.path.join(ROOT, 'config', 'calibrated', 'move_base_dwa_stage.yaml'))
S = 1_000_000_000
MOTION = {'reverse_speed': 0.2, 'spin_speed': 0.25}


def calibrated(**changes):
    return make_calibration({**copy.deepcopy(RAW), **changes}, 'x')


def route(corners=(), goal=Pose2D(20.0, 0.0, 1.0), yaw=2.8, law=CornerLaw.KEEP):
    found = calibrated()
    return PhasedRoute(Pose2D(0.0, 0.0, yaw), goal, corners, found.limits, found.phases, found.tolerances, 0, law)


@pytest.mark.parametrize('extra', [0.5, 3.0, 10.0, 40.0])
@pytest.mark.parametrize('corners', [(), ((1.0, 0.0), (2.0, 1.5), (8.0, 1.5))])
@pytest.mark.parametrize('law', list(CornerLaw))
def test_a_route_that_begins_backwards_takes_so_much_longer_and_leaps_nowhere(extra, corners, law):
    plain = route(corners, law=law)
    found = plain.going_backwards(extra, 0.2)
    longest = (plain.going_backwards(1e6, 0.2).duration_ns - plain.duration_ns) / S
    assert (found.duration_ns - plain.duration_ns) / S == pytest.approx(min(extra, longest), abs=1e-6)
    assert found.end == plain.end
    assert found.distance_at(found.arrive_ns) == plain.distance
    instants = range(0, found.arrive_ns, S // 100)
    poses = [found.pose_at(instant) for instant in instants]
    assert poses[0].distance_to(plain.start) < 1e-9 and math.cos(poses[0].yaw - plain.start.yaw) > 1.0 - 1e-9
    assert max(one.distance_to(other) for one, other in zip(poses, poses[1:])) < 0.011
    assert max(abs(found.distance_at(instant) - plain.distance_at(plain.guess_ns(found.distance_at(instant))))
               for instant in instants) < 1e-6
    for instant in list(instants)[::50]:  # on the way, wherever it is
        at = plain.pose_at(plain.guess_ns(found.distance_at(instant)))
        assert found.pose_at(instant).distance_to(at) < 1e-6


@pytest.mark.parametrize('corners', [(), ((1.0, 0.0), (2.0, 1.5), (8.0, 1.5))])
def test_times_of_even_motion_are_what_encounters_take_them_for(corners):
    found = route(corners).going_backwards(16.0, 0.2)
    for piece, end_ns in found.spans():
        begin_ns, most = piece.begin_ns, acceleration_of(piece)
        begin, middle, end = (found.pose_at(instant) for instant in (begin_ns, (begin_ns + end_ns) // 2, end_ns - 1))
        length = 0.5 * begin.distance_to(end)
        bound = most * ((end_ns - begin_ns) / S) ** 2 / 8.0  # how far a motion may be off the even one, amid
        assert abs(begin.distance_to(middle) - length) <= bound + 1e-6
        assert begin.distance_to(middle) + middle.distance_to(end) == pytest.approx(begin.distance_to(end), abs=1e-6)


def test_backwards_is_backwards():
    found = route().going_backwards(16.0, 0.2)  # for about 20 s
    for at in (1.0, 10.0, 18.0):
        one, other = found.pose_at(int(at * S)), found.pose_at(int((at + 0.1) * S))
        assert other.x - one.x == pytest.approx(0.02)
        assert math.cos(one.yaw) < -0.9  # it looks away from where it goes
        assert found.velocity_at(int(at * S))[0] == -0.2
    assert abs(found.pose_at(19 * S).yaw) > abs(found.pose_at(1 * S).yaw)  # and turns its back to it


def test_a_robot_that_spins_is_at_its_goal_and_ends_as_it_would():
    plain = route(yaw=0.3)
    found = plain.spinning(12.0, 0.25)
    assert (found.duration_ns - plain.duration_ns) / S == pytest.approx(12.0, abs=1e-6)
    assert found.end == plain.end
    turns = [found.velocity_at(instant)[2] for instant in range(0, found.arrive_ns, S // 10)]
    assert sum(abs(turn - 0.25) < 1e-9 for turn in turns) == pytest.approx(60, abs=1)
    assert sum(abs(turn + 0.25) < 1e-9 for turn in turns) == pytest.approx(60, abs=1)


def goals(seed, count, yaw, has_motion=True):
    """Return the legs that are travelled for ``count`` goals with that turn at the start."""
    raw = {name: value for name, value in RAW.items() if name != 'tail_motion'}
    raw.update({'tail_motion': MOTION} if has_motion else {})
    durations = GoalDurations(make_calibration(raw, 'x').durations, seed, 'bot')
    found = []
    for _ in range(count):
        durations.next_goal()
        found.append(durations.paced(route(yaw=yaw)))
    return found


def goes_backwards(leg):
    return any(leg.velocity_at(instant)[0] < 0.0 for instant in range(0, leg.arrive_ns, S // 5))


@pytest.mark.parametrize('yaw', [0.2, 2.3, 3.1])
def test_goals_arrive_to_the_nanosecond_when_they_did_and_go_backwards_as_often_as_the_law_says(yaw):
    count = times(100, 200)
    with_motion, without = goals(7, count, yaw), goals(7, count, yaw, has_motion=False)
    assert [leg.arrive_ns for leg in with_motion] == [leg.arrive_ns for leg in without]
    assert not any(goes_backwards(leg) for leg in without)
    back = sum(goes_backwards(leg) for leg in with_motion)
    expected = count * calibrated().durations.tail_chance(0.0, yaw)
    assert back == pytest.approx(expected, abs=4.0 * math.sqrt(expected) + 1.0)
    assert [leg.arrive_ns for leg in goals(7, count, yaw)] == [
        leg.arrive_ns for leg in with_motion]


def test_which_goals_go_backwards_follows_from_seed_robot_and_goal():
    assert [goes_backwards(leg) for leg in goals(7, 40, 2.4)] != [goes_backwards(leg) for leg in goals(8, 40, 2.4)]
