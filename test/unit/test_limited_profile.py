"""A drive over pieces with top speeds of their own: as fast as they allow, without ever leaping, in closed form."""
import math
import random

import pytest
from night import times

from move_base_abstract.motion.leg import SpeedProfile
from move_base_abstract.motion.limited_profile import LimitedProfile, profile_over

SLOW_MIDDLE = LimitedProfile(((10.0, 2.0), (4.0, 1.0), (10.0, 2.0)), 1.0)


def some_profiles():
    generator = random.Random(5)
    for _ in range(times(15, 40)):
        pieces = tuple((generator.choice((0.01, 0.3, 2.0, 9.0)), generator.choice((0.2, 0.5, 1.0, 3.0)))
                       for _ in range(generator.randint(1, 6)))
        yield LimitedProfile(pieces, generator.choice((0.1, 1.0, 7.0, math.inf)))


def test_a_slow_piece_is_braked_for_in_time_and_left_at_its_own_speed():
    # 2 s up over 2 m, braking from 2 to 1 m/s over 1.5 m in 1 s, the slow piece 4 s, and the same backwards
    assert SLOW_MIDDLE.seconds == pytest.approx(2.0 * (2.0 + 6.5 / 2.0 + 1.0) + 4.0)
    assert SLOW_MIDDLE.speed(SLOW_MIDDLE.elapsed(12.0)) == pytest.approx(1.0)
    assert SLOW_MIDDLE.speed(SLOW_MIDDLE.elapsed(10.0)) == pytest.approx(1.0)
    assert SLOW_MIDDLE.speed(SLOW_MIDDLE.elapsed(8.5)) == pytest.approx(2.0)


@pytest.mark.parametrize('profile', some_profiles())
def test_no_limit_is_passed_and_the_speed_adds_up_to_the_distance(profile):
    steps, driven, before = 4000, 0.0, 0.0
    ends = [sum(length for length, _ in profile.pieces[:count + 1]) for count in range(len(profile.pieces))]
    for number in range(steps):
        elapsed = (number + 0.5) * profile.seconds / steps
        speed, covered = profile.speed(elapsed), profile.covered(elapsed)
        limit = next((limit for (_, limit), end in zip(profile.pieces, ends) if covered < end), math.inf)
        assert speed <= limit + 1e-9
        assert speed - before <= profile.acceleration * profile.seconds / steps + 1e-9
        assert before - speed <= profile.acceleration * profile.seconds / steps + 1e-9
        driven, before = driven + speed * profile.seconds / steps, speed
        assert profile.elapsed(covered) == pytest.approx(elapsed, abs=1e-6)
    assert driven == pytest.approx(profile.distance, rel=2e-3)
    assert profile.covered(profile.seconds) == profile.distance == pytest.approx(ends[-1])


@pytest.mark.parametrize('profile', some_profiles())
def test_times_of_changing_speed_are_parted_in_order(profile):
    changes = profile.changes(4)
    assert sorted(changes) == pytest.approx(changes) and changes[-1] == pytest.approx(profile.seconds)


def test_pieces_of_one_limit_are_one_drive():
    assert profile_over([(3.0, 1.0), (4.0, 1.0)], 0.5) == SpeedProfile(7.0, 1.0, 0.5)
    both = LimitedProfile(((3.0, 1.0), (4.0, 1.0)), 0.5)
    for elapsed in (0.0, 1.0, 3.3, 8.0, 20.0):
        assert both.covered(elapsed) == pytest.approx(SpeedProfile(7.0, 1.0, 0.5).covered(elapsed))


def test_without_a_limit_of_acceleration_each_piece_takes_its_own_time():
    profile = LimitedProfile(((10.0, 2.0), (4.0, 1.0)))
    assert (profile.seconds, profile.speed(2.0), profile.speed(6.0)) == (9.0, 2.0, 1.0)
    assert (profile.covered(6.0), profile.elapsed(11.0)) == (11.0, 6.0)
