"""Programs for Python 2 are translated as they are loaded: their words, and what division means in them."""
import os

import pytest

from move_base_abstract_ros.launching import plan
from move_base_abstract_ros.lockstep.code import older
from strangers_package import adopt, package_fixture  # noqa: F401 - a fixture

lib2to3 = pytest.importorskip('lib2to3', reason='Python has no lib2to3 from 3.13 on')
SOURCE = b"""#!/usr/bin/env python
# -*- coding: latin-1 -*-
import Queue
class Vector(object):
    def __init__(self, x): self.x = x
    def __div__(self, other): return Vector(self.x / other)
    def __rdiv__(self, other): return 'r'
    def next(self): return 7
queue = Queue.Queue()
print "half", 7 / 2, 7.0 / 2, -7 / 2
half = 7
half /= 2
table = {'a': 1}
found = [half, (Vector(3.0) / 2).x, 4 / Vector(1), table.keys(), table.has_key('a'), map(str, [1]), range(2),
         unicode('x'), next(Vector(1)), [y for (x, y) in [(1, 2)]], '\xe9']
try:
    raise ValueError, 'what'
except ValueError, error:
    found.append(str(error))
"""


def run(source, path='old.py'):
    names = {}
    exec(compile(older.tree_of(source, path), path, 'exec'), names)  # the tree is what a run would compile
    return names


def test_words_and_divisions_are_those_of_python_2(capsys):
    assert run(SOURCE)['found'] == [
        3, 1.5, 'r', ['a'], True, ['1'], [0, 1], 'x', 7, [2], '\xe9', 'what']
    assert capsys.readouterr().out == 'half 3 3.5 -4\n'


def test_a_file_that_asks_for_true_division_has_it():
    assert run(b'from __future__ import division\nfound = 7 / 2\n')['found'] == 3.5


def test_a_division_in_place_computes_its_target_once_and_changes_what_it_divides():
    names = run(b"""
import numpy
class Old(object):
    def __init__(self): self.by = []
    def __idiv__(self, other):
        self.by.append(other)
        return self
asked, table = [], [9, 8.0]
def index():
    asked.append(1)
    return 0
table[index()] /= 2
floats = numpy.array([7.0, 8.0])
same = floats
floats /= 2
whole = numpy.array([7])
whole /= 2
old = Old()
old.by.append(numpy.array([7, -7]) / 2)
old /= 3
found = [table, len(asked), list(same), list(whole), [list(old.by[0]), old.by[1]], numpy.int64(7) / 2]
""")
    assert names['found'] == [[4, 8.0], 1, [3.5, 4.0], [3], [[3, -4], 3], 3]


@pytest.mark.parametrize(('source', 'expected'), [
    (b'import sys\nprint("x", end="", file=sys.stderr)\nfound = 7 / 2\n', 3.5), (b'found = 7 / 2\nf"{found}"\n', 3.5),
    (b'def f(x: int): return x / 2\nfound = f(7)\n', 3.5), (b'def f(*, x): return x / 2\nfound = f(x=7)\n', 3.5),
    (b'def f(x): return x / 2\nfound = f(7)\n', 3)])
def test_a_module_that_only_python_3_reads_stays_as_it_is(source, expected):
    assert run(source)['found'] == expected


def test_tabs_are_eight_columns_as_in_python_2():
    assert run(b'if 1:\n        found = 1\n\tfound += 1\n')['found'] == 2


@pytest.mark.parametrize('source', [b'\n\n\nx = "\xe9"\n', b'print "a', b'a b\n', b'def f(:\n'])
def test_what_is_neither_is_an_error(source):
    with pytest.raises(SyntaxError, match='neither Python 3 nor Python 2'):
        older.tree_of(source, 'x.py')


def test_only_files_of_the_named_folders_are_older(tmp_path, monkeypatch):
    older._folders.cache_clear()
    monkeypatch.setenv(older.VARIABLE, '{}:{}'.format(tmp_path / 'a', tmp_path / 'b'))
    assert older.is_older(str(tmp_path / 'a' / 'x.py')) and older.is_older(str(tmp_path / 'b' / 'c' / 'x'))
    assert not older.is_older(str(tmp_path / 'ab.py')) and not older.is_older(os.__file__)
    older._folders.cache_clear()


@pytest.mark.parametrize(('name', 'text', 'expected'), [
    ('scripts/a.py', 'import rospy\nprint 1\n', 'scripts/a.py, line 2'),
    ('src/m/b.py', '\nfrom Queue import Queue\n', 'src/m/b.py, line 2'),
    ('nodes/c', '#!/usr/bin/env python\nprint 1\n', 'nodes/c, line 2'), ('nodes/c', 'print 1\n', ''),
    ('scripts/a.py', '#!/usr/bin/env python3\nprint 1\n', ''), ('build/a.py', 'print 1\n', ''),
    ('a.py', 'try:\n    import Queue\nexcept ImportError:\n    import queue\n', ''), ('a.py', 'print(1)\n', ''),
    ('a.py', '"""Text\nfrom commands of others.\n"""\n', ''), ('a.py', 'import os, Queue\n', 'a.py, line 1'),
    ('commands.py', 'import commands\n', ''), ('a.py', 'from .commands import x\n', ''), ('a.py', 'neither nor\n', '')])
def test_what_only_python_2_reads_says_that_a_package_is_older(tmp_path, name, text, expected):
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    assert older.why_older(str(tmp_path)) == expected


def test_an_adopted_package_for_python_2_is_translated_but_not_its_programs_for_python_3(package):
    package('scripts/old.py', '#!/usr/bin/env python\nimport rospy\nprint "old"\n', 0o755)
    package('scripts/new.py', '#!/usr/bin/env python3\nimport rospy\n', 0o755)
    package('scripts/same.py', '#!/usr/bin/env python\nimport rospy\nx = 1 / 2\n', 0o755)
    nodes = ''.join('<node pkg="of_a_stranger" type="{0}.py" name="{0}"/>'.format(name)
                    for name in ('old', 'new', 'same'))
    path = package('one.launch',
                   '<launch><node pkg="move_base" type="move_base" name="move_base"/>{}</launch>'.format(nodes))
    made = adopt(path)
    assert made.options.python2 == ('of_a_stranger',) and made.options.leave_out == ()
    assert any('of_a_stranger is written for Python 2 (scripts/old.py, line 3)' in line for line in made.done)
    planned = plan.plan_of(plan.read([(path, [])], True), made.options)
    folders = {node.name: dict(node.env_args).get(older.VARIABLE, '') for node in planned.config.nodes}
    assert folders['old'] == folders['same'] != '' and folders['new'] == ''
