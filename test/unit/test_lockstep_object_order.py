"""Sets of a program: what is gone through in some order is handed on, and classes ask for their bases."""
import ast

import pytest

from move_base_abstract.lockstep.object_order import BASES, ORDER, follow_order


def seen_in(text, **names):
    """Run a program; return what it has gone through, as far as that may be a set."""
    seen = []
    names.setdefault(BASES, lambda *bases: bases)
    names[ORDER] = lambda value: seen.append(set(value) if isinstance(value, set) else value) or value
    exec(compile(follow_order(ast.parse(text)), 'program', 'exec'), names)
    return seen


SET = {1, 2}


@pytest.mark.parametrize('text', [
    'for a in s: pass', '[a for a in s]', '{a: 1 for a in s}', '(lambda: [b for a in [1] for b in s])()',
    'next(iter(s))', 'list(s)', 'tuple(s)', 'a, b = s', '[*s]', 'print(*s)', 'max(s, key=abs)', 'min(s)', "f'{s}'",
    'str(s)',
    'set(s).pop()', 'list(map(abs, s))', '[].extend(s)', 'import random\nrandom.choice(list(s))', 'next(a for a in s)',
    'for n, a in enumerate(s): pass', 'dict.fromkeys(list(s))', 'dict.fromkeys(s)', 'sorted(s, key=abs)',
    'import heapq\nheapq.nsmallest(1, s)', 'import collections\ncollections.Counter(s)', 'a = []; a += s',
    'def f():\n  yield from s\nlist(f())', 'a = [0]; a[:] = s', "'%s' % s", "'%s %s' % (1, s)", 'sum(s)',
    'sum(a / 3 for a in s)', 'import json\njson.dumps(list(s))', 'a = []; a.extend(s)',
    'import itertools\nitertools.groupby(s)', 'd = []; any(d.append(a) for a in s)',
    'set(divmod(a, 2) for a in s)', 'd = []; {d.append(a) for a in s}', 'all(print(a) for a in s)',
])
def test_whatever_depends_on_the_order_is_handed_on(text):
    assert SET in seen_in(text, s=set(SET))


@pytest.mark.parametrize('text', [
    'len(s)', '1 in s', 'sorted(s)', 'any(a for a in s)', 'any(abs(a) > 5 for a in s)', 'sum(1 for a in s)',
    'sum(a > 1 for a in s)', 'map(str, [1])', 'any(a > 5 for a in s.copy())',
    'all(a for a in s)', '{a for a in s}',
    's | {3}', 's |= {3}', 'sorted(a for a in s)', '7 % 3', 'len(s) % 2',
    'for a in sorted(s): pass', 'for a in range(3): pass', 'for a in {}.items(): pass',
    's.add(3)', 's.remove(1)', 'set(a for a in s)', 'x = s', 'for a in [1, 2]: pass', 'x = [3].pop(0)',
])
def test_whatever_does_not_is_not(text):
    assert seen_in(text, s=set(SET)) == []


def test_bases_are_asked_for_once_in_their_order():
    asked = []
    text = ('import abc\nclass A: pass\nclass B(A, object): x = 1\nclass C(B, metaclass=abc.ABCMeta): pass\n'
            'class M(type): pass\nclass D(metaclass=M): pass\n')
    seen_in(text + 'assert D.__bases__ == (object,)', **{
        BASES: lambda *bases: asked.append(tuple(base.__name__ for base in bases)) or bases})
    assert asked == [(), ('A', 'object'), ('B',), ('type',)]


def test_places_in_the_text_stay_as_they_are():
    with pytest.raises(ZeroDivisionError) as error:
        seen_in('class A(\n    object):\n  def f(self):\n    for a in (1,\n            1 / 0): pass\nA().f()')
    assert [entry.lineno for entry in error.traceback][-2:] == [5, 4]  # counted from 0
