"""Which loops of a program may wait by looking at variables, and what their turns say."""
import ast
import builtins

import pytest

from move_base_abstract.lockstep.instrument import ACT, CALLS, COMPUTES, LOOK, TIMES, WAITS, instrument, kind_of


def loop(text):
    return ast.parse(text).body[0]


@pytest.mark.parametrize('text', [
    'while len(frontiers) < 1: pass',
    'while not self.map: continue',
    'while True:\n  if flag:\n    break',
    'while True:\n  with lock:\n    word = last\n  if word == 1:\n    break',
    'while True:\n  if tasks:\n    task = tasks.pop()\n    execute(task)',
    'while True:\n  if goal:\n    self.x = goal\n    del goal\n    n += 1',
    'while True:\n  try:\n    job = jobs.get_nowait()\n  except Empty:\n    continue\n  handle(job)',
    'while True:\n  for robot in robots:\n    if robot.done:\n      found = robot\n  if found: break',
    'while True:\n  if done: return self.compute()',
    'while True:\n  self.step()',  # it says in each turn that it may compute
])
def test_loops_that_may_do_nothing_but_look(text):
    assert kind_of(loop(text)) == WAITS


def test_loops_that_look_at_the_time():
    assert kind_of(loop('while rospy.Time.now() < end: pass')) == TIMES


def test_loops_of_which_each_turn_calls_something_unknown():
    assert kind_of(loop('while not self.ready(): pass')) == CALLS


@pytest.mark.parametrize('text', [
    'while not self.stop: n += 1', 'while not stop: self.n += 1', 'while self.running: self.total += self.read()',
    'while True:\n  if done: break\n  self.n += 1', 'while not self.ready(): seen[0] += 1',
    'while True:\n  x = x * a % m\n  if self.end: return'])
def test_loops_that_compute_but_not_what_would_end_them(text):
    assert kind_of(loop(text)) == COMPUTES
    said = ast.unparse(instrument(ast.parse(text)).body[0].body[0]) if hasattr(ast, 'unparse') else None
    assert said in (None, '{}({}, 1)'.format(LOOK, COMPUTES))


@pytest.mark.parametrize('text', [
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
    'while True:\n  def f(): pass',
])
def test_loops_that_compute_in_each_turn(text):
    assert kind_of(loop(text)) is None
    assert ast.dump(instrument(ast.parse(text))) == ast.dump(ast.parse(text))


def run(text, **names):
    """Run a program; return what its loops have said: (kind, line) of a turn, or whether what follows computes."""
    said = []
    setattr(builtins, LOOK, lambda kind, line: said.append((kind, line)))
    setattr(builtins, ACT, said.append)
    try:
        exec(compile(instrument(ast.parse(text)), 'program', 'exec'), names)
    finally:
        delattr(builtins, LOOK)
        delattr(builtins, ACT)
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
    assert [entry for entry in said if entry] == [(WAITS, 5), (WAITS, 6)]


def test_places_in_the_text_stay_as_they_are():
    text = "'''Say it.'''\nfrom __future__ import annotations\nwhile not x:\n  if x is None: 1 / 0\n"
    with pytest.raises(ZeroDivisionError) as error:
        run(text, x=None)
    assert error.traceback[-1].lineno == 3  # counted from 0
