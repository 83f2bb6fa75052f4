"""Property tests take the same examples each time: a test is not green or red by chance."""

from hypothesis import HealthCheck, given, settings, strategies as st


def test_examples_follow_from_the_tests_alone():
    now = settings()
    assert now.derandomize and now.database is None and now.deadline is None
    assert HealthCheck.too_slow in now.suppress_health_check


def test_a_test_takes_the_same_examples_twice():
    def examples():
        taken = []

        @given(st.floats(), st.lists(st.integers()))
        def look(number, numbers):
            taken.append(repr((number, numbers)))
        look()
        return taken

    assert examples() == examples() != []


def test_exploring_takes_others_each_time():
    explore = settings.get_profile('explore')
    assert not explore.derandomize and explore.deadline is None
    assert explore.max_examples > settings().max_examples
