"""The table of what is replaced in rospy and Python's library: all of it, shown, and what is not known is told."""
import ast
import os
import re

import pytest

from move_base_abstract_ros.replacing import replaced  # noqa: TID251 (knows no ROS)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
SOURCES = os.path.join(ROOT, 'src')
FOREIGN = re.compile(r'(rospy|actionlib|rosgraph|roslib|threading|time|queue|uuid|logging|sys|os|socket|random)(\.|$)')
#: what a program is started with is set, not replaced, and so is the hook of a trial's own process; the rospy ones are
#: what it reads of that when it is imported
VALUES = ('sys.argv', 'sys.stdout', 'sys.__stdout__', 'sys.stderr', 'sys.__stderr__',
          'threading.excepthook', 'rospy.names._mappings', 'rospy.names._caller_namespace', 'rospy.names._caller_id')


@pytest.fixture
def fresh(monkeypatch):
    """A table of which nothing has been replaced."""
    monkeypatch.setattr(replaced, '_done', [])
    monkeypatch.setattr(replaced, '_unknown', [])


def python_files():
    for folder, _, names in sorted(os.walk(SOURCES)):
        yield from (os.path.join(folder, name) for name in sorted(names) if name.endswith('.py'))


def imports_of(tree):
    """Return {name in the file: dotted name} of what it imports."""
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update((one.asname or one.name.split('.')[0], one.name if one.asname else one.name.split('.')[0])
                         for one in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.update((one.asname or one.name, '{}.{}'.format(node.module, one.name)) for one in node.names)
    return found


def dotted(node, imports):
    """Return the dotted name that an expression stands for, '' if it is something else."""
    if isinstance(node, ast.Name):
        return imports.get(node.id, '')
    if isinstance(node, ast.Attribute):
        owner = dotted(node.value, imports)
        return owner and '{}.{}'.format(owner, node.attr)
    return ''


def set_in(tree):
    """Yield the dotted names that are assigned to."""
    imports = imports_of(tree)
    for node in ast.walk(tree):
        targets = getattr(node, 'targets', [node.target] if isinstance(node, ast.AugAssign) else [])
        for target in targets:
            yield from (dotted(one, imports) for one in getattr(target, 'elts', [target])
                        if isinstance(one, ast.Attribute))
        if isinstance(node, ast.Call) and dotted(node.func, {'setattr': 'setattr'}) == 'setattr':
            yield dotted(node.args[0], imports) + '.'


def test_nothing_is_replaced_past_the_table():
    found = []
    for path in python_files():
        with open(path, encoding='utf-8') as stream:
            names = set_in(ast.parse(stream.read()))
        found += [(os.path.relpath(path, SOURCES), name) for name in names
                  if FOREIGN.match(name) and name not in VALUES and not name.startswith('rospy.rostime._rostime')]
    assert found == []


def test_the_page_shows_the_table():
    with open(os.path.join(ROOT, 'docs', 'replaced_names.md'), encoding='utf-8') as stream:
        page = stream.read()
    python = 'Python {}.{} to {}.{}'.format(*replaced.PYTHON[0], *replaced.PYTHON[1])
    shown = [line for line in page.splitlines() if line.startswith('| `')]
    places = re.findall(r'^## In (.*)$|^\| `(.*?)` ', page, re.MULTILINE)
    where, at = {}, None
    for heading, name in places:
        at = heading or at
        where[name] = at
    assert {name: at for name, at in where.items() if name} == {row.name: row.where for row in replaced.ROWS.values()}
    assert sorted(shown) == sorted('| `{}` | {} | {} |'.format(row.name, row.why, ', '.join(row.digests) or python)
                                   for row in replaced.ROWS.values())
    assert replaced.SOURCES in page


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
