"""The table of what is replaced in rospy and Python's library: what has no row is refused, unknown sources are told."""
import re

import pytest

from move_base_abstract_ros.replacing import replaced


@pytest.fixture
def fresh(monkeypatch):
    """A table of which nothing has been replaced."""
    monkeypatch.setattr(replaced, '_done', [])
    monkeypatch.setattr(replaced, '_unknown', [])


def test_what_has_no_row_cannot_be_replaced(fresh):
    with pytest.raises(KeyError):
        replaced.replace('time.get_clock_info', lambda clock: clock)
    assert replaced.done() == ()


def test_a_replacement_gets_the_original_and_is_noted(fresh, monkeypatch):
    import time
    monkeypatch.setattr(time, 'perf_counter', time.perf_counter)  # puts it back afterwards
    original = time.perf_counter
    seen = []
    assert replaced.replace('time.perf_counter', lambda clock: seen.append(clock) or 'stand-in') is original
    assert (time.perf_counter, seen, replaced.done()) == ('stand-in', [original], ('time.perf_counter',))


def test_a_replacement_for_a_while_is_taken_back(fresh, monkeypatch):
    import time
    original = time.perf_counter
    with replaced.replaced('time.perf_counter', lambda _clock: 'stand-in'):
        assert time.perf_counter == 'stand-in'
    assert time.perf_counter is original


def other(a):
    return a + 1


def test_a_source_that_is_not_known_is_named(fresh, monkeypatch):
    monkeypatch.setattr(replaced, 'ROWS', {'rospy.client.spin': replaced.Row('rospy.client.spin', '', '', ('0' * 12,))})
    assert replaced.unknown() == ''
    replaced.note('rospy.client.spin', other)
    assert replaced.unknown().startswith('rospy.client.spin is not known to this version of move_base_abstract')


def test_a_source_that_is_known_is_not(fresh, monkeypatch):
    row = replaced.Row('rospy.client.spin', '', '', ('0' * 12, replaced.digest(other)))
    monkeypatch.setattr(replaced, 'ROWS', {row.name: row})
    replaced.note(row.name, other)
    assert (replaced.unknown(), replaced.done()) == ('', (row.name,))


def test_another_python_is_named(fresh, monkeypatch):
    monkeypatch.setattr(replaced, 'PYTHON', ((2, 7), (3, 0)))
    assert re.match(r'Python 3\.\d+ is not known', replaced.unknown())


def written(tmp_path, name, text):
    """Return the function ``f`` of a module with this text."""
    path = tmp_path / (name + '.py')
    path.write_text(text)
    module = {'__name__': name}
    exec(compile(text, str(path), 'exec'), module)
    return module['f']


def test_a_digest_is_of_what_a_function_does_not_of_its_comments(tmp_path):
    plain = written(tmp_path, 'a', 'def f(x):\n    return x + 1\n')
    told = written(tmp_path, 'b', 'def f(x):\n    """Say more."""\n\n    # one more\n    return x + 1\n')
    another = written(tmp_path, 'c', 'def f(x):\n    return x + 2\n')
    assert replaced.digest(plain) == replaced.digest(told) != replaced.digest(another)
    assert replaced.digest(len) == ''  # made in C


def test_what_is_imported_is_looked_up_beforehand(monkeypatch):
    row = replaced.Row('textwrap.dedent', '', '', ('0' * 12,))
    absent = replaced.Row('no_such_module.function', '', '', ('0' * 12,))
    monkeypatch.setattr(replaced, '_ROWS', (row, absent))
    replaced.digest.cache_clear()
    replaced.look_up()
    assert replaced.digest.cache_info().currsize == 1
