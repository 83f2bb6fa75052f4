"""What is tested by day and what by night: the night is where the environment variable NIGHT is a number of 1 or more.

A test that takes long is marked with ``@pytest.mark.night``: by day it is left out, and pytest says how many are. A
test that only needs fewer examples, seeds or repetitions by day asks ``times(day, night)``. test/conftest.py hands the
hook to all folders of tests.
"""
import os

NAME = 'NIGHT'


def is_night():
    """Return whether NIGHT asks for the long tests, too; raise ValueError if it is no number."""
    text = os.environ.get(NAME) or '0'
    try:
        return float(text) >= 1.0
    except ValueError:
        raise ValueError(f'tests: the environment variable {NAME} must be a number (1 or more for the tests of the '
                         f'night, 0 or nothing for those of the day), got {text!r}') from None


def times(day, night):
    """Return how many times something is done, or how large it is: by day, or by night."""
    return night if is_night() else day


def runs_of_a_scenario():
    """Return how many times a system runs whose results must be equal: once by day, NIGHT times by night."""
    return int(float(os.environ[NAME])) if is_night() else 1


def pytest_collection_modifyitems(config, items):
    """Leave out the tests of the night by day, unless ``-m`` chooses among all."""
    if is_night() or config.option.markexpr:
        return
    nightly = [item for item in items if item.get_closest_marker('night')]
    if nightly:
        config.hook.pytest_deselected(items=nightly)
        items[:] = [item for item in items if not item.get_closest_marker('night')]
        config.pluginmanager.register(_Saying(len(nightly)))


class _Saying:
    """Says at the end of a run what was left out, and how to take it in."""

    def __init__(self, count):
        self._count = count

    def pytest_terminal_summary(self, terminalreporter):
        terminalreporter.write_line(f'{self._count} of the night left out; {NAME}=1 takes them in, -m night only them')
