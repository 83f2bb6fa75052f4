"""Numbers by chance: each follows from seed, robot, goal and purpose alone, and is as evenly distributed as it says."""
import hashlib
import math
from types import SimpleNamespace

import numpy as np
import pytest

from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract.engine.factors import Constant, Gamma, Lognormal, Quantiles, along


def test_a_number_is_the_one_that_numpys_philox_gives_for_key_and_counter():
    digest = hashlib.sha256(b'7/robot_0').digest()
    key = [int.from_bytes(digest[:8], 'little'), int.from_bytes(digest[8:16], 'little')]
    raw = np.random.Philox(key=key, counter=[5, 3, 2, 0]).random_raw()
    assert Chance(7, 'robot_0').uniform(3, Purpose.FAILURE, 5) == ((int(raw) >> 11) + 0.5) / 2.0 ** 53


def test_the_ends_are_never_drawn():
    chance = Chance(1, 'robot_0')
    drawn = []
    for raw in (0, 2 ** 64 - 1):
        chance._generator = SimpleNamespace(random_raw=lambda raw=raw: raw)
        drawn.append(chance.uniform(1, Purpose.FACTOR))
    assert 0.0 < drawn[0] < 1e-15 < drawn[1] < 1.0


def test_a_number_does_not_depend_on_what_was_drawn_before():
    asked = [(goal, purpose, place) for goal in (1, 2, 900) for purpose in Purpose for place in (0, 1)]
    once, again = Chance(1, 'robot_0'), Chance(1, 'robot_0')
    forth = {one: once.uniform(*one) for one in asked}
    assert {one: again.uniform(*one) for one in reversed(asked)} == forth
    assert len(set(forth.values())) == len(asked)


def test_robots_and_seeds_have_numbers_of_their_own():
    drawn = [Chance(seed, name).uniform(1, Purpose.FACTOR) for seed in (0, 1, 10 ** 30) for name in ('a', 'b')]
    assert len(set(drawn)) == len(drawn)


def test_numbers_are_evenly_distributed_and_do_not_follow_one_another():
    chance = Chance(3, 'robot_0')
    drawn = np.array([chance.uniform(goal, Purpose.FACTOR) for goal in range(1, 4001)])
    assert np.abs(np.sort(drawn) - (np.arange(4000) + 0.5) / 4000).max() < 1.63 / math.sqrt(4000)  # Kolmogorov, 99 %
    assert abs(np.corrcoef(drawn[:-1], drawn[1:])[0, 1]) < 2.6 / math.sqrt(4000)


# ---- factors

@pytest.mark.parametrize(('kind', 'cv'), [(Lognormal, 0.05), (Lognormal, 0.4), (Gamma, 0.05), (Gamma, 0.5),
                                          (Gamma, 1.5)])
def test_a_factor_has_its_mean_and_its_coefficient_of_variation(kind, cv):
    chance = Chance(11, 'robot_0')
    drawn = np.array([kind(1.25, cv).draw(lambda place, goal=goal: chance.uniform(goal, Purpose.FACTOR, place))
                      for goal in range(1, 4001)])
    assert drawn.min() > 0.0
    assert abs(drawn.mean() / 1.25 - 1.0) < 2.6 * cv / math.sqrt(4000)
    assert drawn.std() / drawn.mean() == pytest.approx(cv, rel=0.1)


def test_a_constant_factor_draws_nothing():
    assert Constant(1.5).draw(None) == 1.5


def test_a_factor_by_quantiles_lies_straight_between_them():
    quantiles = Quantiles(2.0, ((0.0, 0.5), (0.5, 1.0), (1.0, 3.0)))
    assert [quantiles.draw(lambda _place, share=share: share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)] == [
        1.0, 1.5, 2.0, 4.0, 6.0]


def test_beyond_the_ends_the_ends_count():
    assert [along(((1.0, 0.2), (3.0, 0.4)), at) for at in (0.0, 1.0, 2.0, 3.0, 9.0)] == pytest.approx(
        [0.2, 0.2, 0.3, 0.4, 0.4])
