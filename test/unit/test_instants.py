"""The first instant at which something is so: the same with a guess and without, and sooner found."""
import pytest

from move_base_abstract.engine.instants import first_ns


def asked(begin_ns, end_ns, answer_ns, guess_ns=None):
    """Return what is found, and how often it was asked."""
    calls = []

    def is_so(at_ns):
        assert begin_ns <= at_ns < end_ns
        calls.append(at_ns)
        return at_ns >= answer_ns
    return first_ns(begin_ns, end_ns, is_so, guess_ns), len(calls)


@pytest.mark.parametrize('end_ns', [0, 1, 2, 17])
def test_whatever_is_guessed_the_answer_is_the_first_instant(end_ns):
    for answer_ns in range(end_ns + 1):
        for guess_ns in (None, *range(-3, end_ns + 4)):
            assert asked(0, end_ns, answer_ns, guess_ns)[0] == answer_ns


def test_a_good_guess_spares_most_of_the_search():
    hour = 3_600_000_000_000
    assert asked(0, hour, 1_234_567_891_011)[1] > 40
    for off in (-3, -1, 0, 1, 3):
        assert asked(0, hour, 1_234_567_891_011, 1_234_567_891_011 + off)[1] <= 6
