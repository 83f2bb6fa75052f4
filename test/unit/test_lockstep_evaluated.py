"""What is typed at a debugger's prompt and may change the run."""
import pytest

from move_base_abstract.lockstep.evaluated import may_change


@pytest.mark.parametrize('text', [
    'self.goals', 'len(self.goals)', '[one.name for one in robots if one.x > 3]', 'a["b"][1:2]', "f'{x} {len(y)}'", 'x',
    'x == 3 and not y', 'sorted(names, key=str)', '', 'a +', 'p(', '$_frame', '{**a}', '(1, 2)', 'lambda: 3'])
def test_looking_changes_nothing(text):
    assert not may_change(text)


@pytest.mark.parametrize('text', [
    'x = 3', 'self.goals.append(1)', 'rospy.sleep(1)', 'del x', 'import os', '[f(x) for x in y]', '(x := 3)', 'x += 1',
    '$a.pop()', 'len(robots.pop())', 'print(x)', 'await x', 'next(y)'])
def test_calls_and_statements_may_change_the_run(text):
    assert may_change(text)
