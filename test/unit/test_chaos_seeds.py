"""The seeds that a test's marker asks for."""
import itertools

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_testing.settings import chaos_seeds


@pytest.mark.parametrize('given, seeds', [
    (1, [0]), (4, [0, 1, 2, 3]), (range(7, 9), [7, 8]), ([5, 2], [5, 2]), ((0, 2147483647), [0, 2147483647])])
def test_a_number_counts_from_nought_and_a_row_is_taken_as_it_is(given, seeds):
    assert chaos_seeds(given) == seeds


@pytest.mark.parametrize('given', [
    0, -1, 100_001, 1 << 70, True, 2.0, '4', [], range(0), [1.0], [True], ['a'], [-1], [1 << 31], range(100_001),
    range(1 << 70), itertools.count(), {1, 2}, None, {}])
def test_what_names_no_seed_is_refused(given):
    with pytest.raises(ConfigurationError, match='lockstep: chaos_seeds: must be a number of seeds, or the seeds'):
        chaos_seeds(given)
