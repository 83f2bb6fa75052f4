"""The original package's profile: how long its legs take, where its robots are meanwhile, how often it tries."""
import math

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import read_settings
from move_base_abstract.fleet import Fleet
from move_base_abstract.motion.attempts import Attempts, GoalAttempts
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits
from move_base_abstract.motion.original import MAIN, RASBERRY, OriginalLaw
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
SLOW = MotionLimits(2.0, 0.1)


def make_fleet(profile, **options):
    """Return a fleet of one robot, r, at 2 m/s with 0.1 m/s^2, at the origin."""
    return Fleet(make_scenario({'robots': [{'name': 'r', 'max_speed': 2.0, 'acceleration': 0.1,
                                            'compatible_with': profile, **options}]}))


def endings(fleet):
    """Return (time, state, text) of the goals that have ended."""
    return [(entry.time_ns, *entry.values[1:]) for entry in fleet.trace if entry.kind == 'ended']


@pytest.mark.parametrize('profile, limits, distance, seconds', [
    (MAIN, SLOW, 40.0, 30.0), (MAIN, SLOW, 1.0, 10.5), (MAIN, SLOW, 0.0, 0.0), (MAIN, MotionLimits(2.0), 40.0, 20.0),
    (MAIN, MotionLimits(0.5, 0.5), 3.0, 6.5), (RASBERRY, SLOW, 40.0, 20.0), (RASBERRY, SLOW, 1.0, 0.5)])
def test_a_leg_takes_as_long_as_there(profile, limits, distance, seconds):
    assert OriginalLaw(profile).seconds(distance, limits) == seconds
    leg = OriginalLaw(profile).leg(Pose2D(1.0, 2.0), Pose2D(1.0 + distance, 2.0), limits, 5 * S)
    assert (leg.depart_ns, leg.arrive_ns) == (5 * S, 5 * S + round(seconds * S))


def test_without_pose_updates_a_leg_of_main_takes_whole_seconds():
    law = OriginalLaw(MAIN, 0.0)
    assert [law.seconds(distance, SLOW) for distance in (40.0, 40.1, 1.0)] == [30.0, 31.0, 11.0]
    assert OriginalLaw(RASBERRY, 0.0).seconds(1.0, SLOW) == 0.5


def test_the_robot_is_where_it_would_be_had_it_stood_first():
    leg = OriginalLaw(MAIN).leg(Pose2D(), Pose2D(0.0, 40.0, 1.0), SLOW, 0)
    assert [leg.pose_at(at * S).y for at in (0, 10, 15, 29)] == pytest.approx([0.0, 0.0, 10.0, 38.0])
    assert leg.pose_at(15 * S).yaw == pytest.approx(math.pi / 2)
    assert leg.pose_at(30 * S) == Pose2D(0.0, 40.0, 1.0)


def test_the_branch_shows_the_robot_half_way():
    leg = OriginalLaw(RASBERRY).leg(Pose2D(2.0, 0.0, 0.5), Pose2D(4.0, 6.0, 1.0), SLOW, S)
    assert leg.pose_at(S - 1) == Pose2D(2.0, 0.0, 0.5)
    assert {leg.pose_at(at_ns) for at_ns in (S, leg.arrive_ns - 1)} == {Pose2D(3.0, 3.0)}
    assert leg.pose_at(leg.arrive_ns) == Pose2D(4.0, 6.0, 1.0)


def test_a_robot_of_the_branch_is_half_way_in_its_fleet_and_after_its_pauses_only():
    fleet = make_fleet(RASBERRY, log_motion=True)
    fleet.robot('r').send(8.0, 0.0, 1.0)
    fleet.run_for(1.0)
    assert (fleet.robot('r').pose, fleet.robot('r').distance) == (Pose2D(4.0, 0.0), 2.0)
    [pieces] = [entry.values for entry in fleet.trace if entry.kind == 'pieces']
    assert [(piece.begin_ns, piece.x, piece.v) for piece in pieces] == [(S, 4.0, 0.0), (5 * S, 8.0, 0.0)]
    attempts = GoalAttempts(Attempts(chance=1.0, retries=1, pause=3.0))
    leg = attempts.paced(OriginalLaw(RASBERRY).leg(Pose2D(), Pose2D(4.0, 6.0, 1.0), SLOW, S))
    assert [leg.pose_at(at_ns) for at_ns in (S, 4 * S - 1, 4 * S)] == [Pose2D(), Pose2D(), Pose2D(2.0, 3.0)]


def test_a_leg_of_the_branch_that_takes_no_time_has_no_pieces():
    assert OriginalLaw(RASBERRY).leg(Pose2D(), Pose2D(yaw=1.0), SLOW, S).pieces == ()


def test_both_times_are_told_in_words():
    assert OriginalLaw(MAIN).compare(40.0, SLOW) == (
        "40.0 m at 2 m/s with 0.1 m/s^2: 30.0 s by the original's formula, 40.0 s exact")
    assert OriginalLaw(MAIN).compare(1.0, SLOW).endswith("10.5 s by the original's formula, 6.3 s exact")
    assert OriginalLaw(MAIN).compare(40.0, MotionLimits(2.0)) == (
        "40.0 m at 2 m/s: 20.0 s by the original's formula, 20.0 s exact")


def test_a_robot_of_a_fleet_goes_by_it_and_stops_on_its_way_as_ever():
    fleet = make_fleet(MAIN)
    fleet.robot('r').send(40.0, 0.0)
    fleet.run()
    assert endings(fleet) == [(31 * S, 'SUCCEEDED', 'Goal reached.')]
    second = fleet.robot('r').send(0.0, 0.0)
    fleet.run_for(20.0)
    fleet.robot('r').cancel(second)
    assert fleet.robot('r').pose.x == pytest.approx(20.0)


def test_a_goal_is_tried_again_after_pauses_and_given_up_at_last():
    fleet = make_fleet(RASBERRY, seed=3)
    for number in range(600):
        fleet.robot('r').send(float(number % 2), 0.0)
        fleet.run()
    waits = [(entry.time_ns, entry.kind) for entry in fleet.trace if entry.kind in ('departed', 'ended')]
    took = [(end - begin) / S for (begin, _), (end, _) in zip(waits[::2], waits[1::2])]
    assert set(took[1:]) == {0.5, 5.5} and 1 <= took.count(5.5) <= 15


def test_one_that_was_given_up_leaves_no_retry_for_the_next():
    straight = OriginalLaw(RASBERRY)
    goals = GoalAttempts(Attempts(chance=1.0))
    told = []
    for depart_ns in (S, 100 * S):
        goals.next_goal()
        leg = goals.paced(straight.leg(Pose2D(), Pose2D(4.0, 0.0), SLOW, depart_ns))
        told.append((leg.arrive_ns, goals.failure_ns(leg)))
    assert told == [(18 * S, 16 * S), (102 * S, 100 * S)]
    assert goals.failure_text == 'The goal was given up after 3 retries'


@pytest.mark.parametrize('name, value', [('turn_rate', 1.0), ('xy_goal_tolerance', 0.1), ('goal_overhead', 1.0),
                                         ('routes', 'grid'), ('calibration', 'x')])
def test_what_the_original_has_not_is_refused(name, value):
    with pytest.raises(ConfigurationError, match='compatible_with: move_base_abstract, which has no such parameter'):
        read_settings({'compatible_with': MAIN, name: value, **({'use_map': True} if name == 'routes' else {})}, '/r')


def test_another_profile_is_refused():
    with pytest.raises(ConfigurationError, match="allowed: 'move_base_abstract' or 'move_base_abstract_rasberry'"):
        read_settings({'compatible_with': 'move_base'}, '/r')


def test_a_planners_tolerances_do_not_count():
    settings = read_settings({'compatible_with': MAIN, 'TrajectoryPlannerROS': {'xy_goal_tolerance': 0.3}}, '/r')
    assert (settings.tolerances.xy, settings.tolerances.yaw) == (0.0, 0.0)
