"""Which loops of a program may wait by looking at variables, and what their turns say."""
import ast
import contextlib
import types

import pytest

from move_base_abstract.lockstep.instrument import (
    ACT,
    CALLED,
    CALLS,
    COMPUTES,
    LOOK,
    TIMES,
    WAITS,
    hand_over_called,
    instrument,
)


@pytest.mark.parametrize('kind, text', [
    *((WAITS, text) for text in (
        'while len(frontiers) < 1: pass',
        'while not self.map: continue',
        'while True:\n  if flag:\n    break',
        'while True:\n  with lock:\n    word = last\n  if word == 1:\n    break',
        'while True:\n  if tasks:\n    task = tasks.pop()\n    execute(task)',
        'while True:\n  if goal:\n    self.x = goal\n    del goal\n    n += 1',
        'while True:\n  try:\n    job = jobs.get_nowait()\n  except Empty:\n    continue\n  handle(job)',
        'while True:\n  for robot in robots:\n    if robot.done:\n      found = robot\n  if found: break',
        'while True:\n  if done: return self.compute()',
        'while True:\n  self.step()')),  # it says in each turn that it may compute
    (TIMES, 'while rospy.Time.now() < end: pass'),
    (CALLS, 'while not self.ready(): pass'),  # it calls something unknown
    *((COMPUTES, text) for text in (
        'while not self.stop: n += 1', 'while not stop: self.n += 1', 'while self.running: self.total += self.read()',
        'while True:\n  if done: break\n  self.n += 1', 'while not self.ready(): seen[0] += 1',
        'while True:\n  x = x * a % m\n  if self.end: return')),
    *((None, text) for text in (
        'while b: a, b = b, a % b',
        'while abs(x * x - n) > eps: x = (x + n / x) / 2',
        'while node.parent: node = node.parent',
        'while a:\n  b = f(a)\n  a = g(b)',
        'while i < n: i += 1',
        'while heap:\n  node = heappop(heap)\n  cost[node] = 1',
        'while True:\n  if a: self.x = 1\n  else: y[0] = 2',
        'while True:\n  if self.n > 3: break\n  self.n += 1',
        'while self.node.open: self.node = self.next(self.node)',
        'while a.left: a.left -= 1',
        'while self.jobs: n += self.jobs.pop()',
        'while True:\n  x = yield x',
        'while True:\n  def f(): pass'))])
def test_a_loop_says_of_which_kind_it_is(kind, text):
    tree, loop = instrument(ast.parse(text))[0], ast.parse(text)
    if kind is None:
        assert ast.dump(tree) == ast.dump(loop)
    else:
        assert ast.dump(tree.body[0].body[0]) == ast.dump(ast.parse('{}({}, 1)'.format(LOOK, kind)).body[0])


def run(text, **names):
    """Run a program; return what its loops have said.

    That is (kind, line) of a turn, whether what follows computes, or the name of a function that may do more than look.
    """
    said = []
    tree, looking = instrument(ast.parse(text))

    def called(function, is_known):
        code = getattr(getattr(function, '__func__', function), '__code__', None)
        if not looking.get(code and (code.co_name, code.co_firstlineno), is_known):
            said.append(function.__name__)
        return function
    names.update({'said': said, LOOK: lambda kind, line: said.append((kind, line)), ACT: said.append, CALLED: called})
    exec(compile(hand_over_called(tree), 'program', 'exec'), names)
    return said


def test_a_turn_says_what_it_does_before_it_does_it():
    left = [1, 2, 3]
    assert run('while left:\n  if left[0] == 2:\n    n[0] = 1\n  left.pop()', left=left, n=[0]) == [
        (WAITS, 1), False, (WAITS, 1), False, (WAITS, 1), False]
    assert run('\n\nwhile not n:\n  if len(m):\n    n += 1\n  elif not m: m = other', n=0, m=[], other=[1]) == [
        (WAITS, 3), (WAITS, 3), True]


def test_loops_in_loops_and_in_functions_say_so_too():
    assert run('def f():\n  while a < 2:\n    while b < 1:\n      grow()\nf()', a=2, b=0, grow=None) == []
    names = {'a': 0, 'b': 0}
    text = 'def grow():\n  global a, b\n  a += 1\n  b += 1\nwhile a < 1:\n  while b < 1:\n    grow()'
    said = run(text, **names)
    assert [entry for entry in said if entry] == [(WAITS, 5), (WAITS, 6), 'grow']


def test_places_in_the_text_stay_as_they_are():
    text = "'''Say it.'''\nfrom __future__ import annotations\nwhile not x:\n  if x is None: 1 / 0\n"
    with pytest.raises(ZeroDivisionError) as error:
        run(text, x=None)
    assert error.traceback[-1].lineno == 3  # counted from 0


@pytest.mark.parametrize('loop, functions', [
    ('while not ready(): pass', 'def ready(): return len(said) > 2'),
    ('while not a.ready(): pass',
     'class A:\n  def ready(self):\n    with lock:\n      n = len(said)\n    return n > 2\na = A()'),
    ('while not ready(): step()',
     'def ready(): return enough()\ndef enough(): return len(said) > 2\ndef step(): pass'),
    ('while step() is None: pass', 'def step():\n  if len(said) < 3: return None\n  return 1')])
def test_a_function_that_only_looks_is_no_computation(loop, functions):
    said = run('def main():\n  {}\n{}\nmain()'.format(loop, functions), lock=contextlib.nullcontext())
    assert said == [(WAITS, 2)] * 3


@pytest.mark.parametrize('function, said_first', [
    ('  n[0] = 1', 'step'),  # it computes whenever it is called
    ('  if len(said) > 3: return\n  n[0] = 1', True),
    ('  global m\n  if len(said) > 3: return\n  m = 1', True),
    ('  if len(said) > 3: return\n  other()', False),
    ('  return n[0] or other()', False),
    ('  return (yield)', 'step'),
    ('  if len(said) > 3: return\n  for k in range(2): n[k] = 1', True),
    ('  return package.module()', False)])
def test_a_function_says_so_before_it_does_more_than_look(function, said_first):
    text = 'def step():\n{}\nwhile not n[0]:\n  step()\n  break'.format(function)
    said = run(text, n=[0, 0], m=0, other=lambda: None, package=types.SimpleNamespace(module=lambda: None))
    assert said[0][0] == WAITS
    assert said[1] == said_first


@pytest.mark.parametrize('text', [
    'step = unknown\nwhile not n: step()\ndef never():\n  def step(): pass',
    'class A:\n  def step(self): pass\nclass B:\n  def step(self): n.append(1)\nb = B()\nwhile not n: b.step()',
    'import functools\n@functools.lru_cache()\ndef step(): pass\nwhile not n:\n  step()\n  break'])
def test_what_is_called_decides_and_not_its_name(text):
    n = []
    said = run(text, n=n, unknown=lambda: n.append(1))
    assert [word for word in said if not isinstance(word, tuple)] in (['<lambda>'], [False])


@pytest.mark.parametrize('done, says', [
    ('self.n.append(1)\n    return len(self.n) > 2', [False] * 2), ('self.n[0] = 9\n    return True', ['done'])])
def test_an_own_function_with_the_name_of_one_that_looks_may_compute(done, says):
    text = 'class A:\n  n = [0]\n  def done(self):\n    {}\na = A()\nwhile not a.done(): other.done()'.format(done)
    said = run(text, other=types.SimpleNamespace(done=dict))
    assert [word for word in said if not isinstance(word, tuple)] == says


def test_a_loop_looks_at_the_time_if_a_function_of_it_does():
    text = 'while not over(): pass\ndef over(): return late()\ndef late(): return rospy.Time.now() > end'
    tree, looking = instrument(ast.parse(text))
    assert tree.body[0].body[0].value.args[0].value == TIMES
    assert looking == {('over', 2): True, ('late', 3): True}


def test_functions_that_no_waiting_loop_calls_stay_as_they_are():
    text = 'def f(a):\n  if a: return 1\n  b[0] = 1\nfor k in x: f(k)'
    tree, looking = instrument(ast.parse(text))
    assert ast.dump(tree) == ast.dump(ast.parse(text))
    assert not looking
