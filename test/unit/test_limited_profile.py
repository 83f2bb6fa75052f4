"""A drive over pieces with top speeds of their own: as fast as they allow, without ever leaping, in closed form."""
import math
import random

import pytest
from night import times

from move_base_abstract.motion.leg import speed_profile
from move_base_abstract.motion.limited_profile import profile_over
from profiles import covered, elapsed_at, speed

SLOW_MIDDLE = profile_over(((10.0, 2.0), (4.0, 1.0), (10.0, 2.0)), 1.0)


def some_drives():
    """Yield (pieces, acceleration)."""
    generator = random.Random(5)
    for _ in range(times(15, 40)):
        pieces = tuple((generator.choice((0.01, 0.3, 2.0, 9.0)), generator.choice((0.2, 0.5, 1.0, 3.0)))
                       for _ in range(generator.randint(1, 6)))
        yield pieces, generator.choice((0.1, 1.0, 7.0, math.inf))


def test_a_slow_piece_is_braked_for_in_time_and_left_at_its_own_speed():
    # 2 s up over 2 m, braking from 2 to 1 m/s over 1.5 m in 1 s, the slow piece 4 s, and the same backwards
    assert SLOW_MIDDLE.seconds == pytest.approx(2.0 * (2.0 + 6.5 / 2.0 + 1.0) + 4.0)
    assert [speed(SLOW_MIDDLE, elapsed_at(SLOW_MIDDLE, way)) for way in (12.0, 10.0, 8.5)] == pytest.approx(
        [1.0, 1.0, 2.0])


@pytest.mark.parametrize(('pieces', 'acceleration'), some_drives())
def test_no_limit_is_passed_and_the_speed_adds_up_to_the_distance(pieces, acceleration):
    profile = profile_over(pieces, acceleration)
    steps, driven, before = 4000, 0.0, 0.0
    ends = [sum(length for length, _ in pieces[:count + 1]) for count in range(len(pieces))]
    for number in range(steps):
        elapsed = (number + 0.5) * profile.seconds / steps
        now, way = speed(profile, elapsed), covered(profile, elapsed)
        limit = next((limit for (_, limit), end in zip(pieces, ends) if way < end - 1e-12), math.inf)
        assert now <= limit + 1e-9
        assert now - before <= acceleration * profile.seconds / steps + 1e-9
        assert before - now <= acceleration * profile.seconds / steps + 1e-9
        driven, before = driven + now * profile.seconds / steps, now
        assert elapsed_at(profile, way) == pytest.approx(elapsed, abs=1e-6)
    assert driven == pytest.approx(profile.distance, rel=2e-3)
    assert covered(profile, profile.seconds) == profile.distance == pytest.approx(ends[-1])


def test_pieces_of_one_limit_are_one_drive():
    assert profile_over([(3.0, 1.0), (4.0, 1.0)], 0.5) == speed_profile(7.0, 1.0, 0.5)


def test_without_a_limit_of_acceleration_each_piece_takes_its_own_time():
    profile = profile_over(((10.0, 2.0), (4.0, 1.0)), math.inf)
    assert (profile.seconds, speed(profile, 2.0), speed(profile, 6.0)) == (9.0, 2.0, 1.0)
    assert (covered(profile, 6.0), elapsed_at(profile, 11.0)) == (11.0, 6.0)
