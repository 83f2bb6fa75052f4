"""Tests of the systems in this folder: ``python3 -m pytest -p move_base_abstract_testing test_systems.py``."""
from collections import Counter

import pytest


@pytest.mark.lockstep(launch='task_allocation.launch', until='idle')
def test_each_of_fifty_tasks_is_done_once(lockstep):
    """The three robots that get tasks do them, and no other robot does."""
    ends = lockstep.log.of('task_ended')
    assert [one.values[1] for one in ends] == 50 * ['SUCCEEDED']
    assert set(Counter(one.values[0] for one in ends).values()) == {1}
    assert {one.robot for one in ends} == {'robot_1', 'robot_2', 'robot_3'}


@pytest.mark.lockstep(launch='patrol.launch', args={'rounds': 2}, until='idle',
                      replace={'move_base/move_base': 'move_base_abstract/move_base'})
def test_who_patrols_comes_to_each_corner(lockstep):
    """Each robot drives round twice, and no goal is lost. A second run is identical."""
    ends = Counter((one.robot, one.values[1]) for one in lockstep.log.of('ended'))
    assert ends == {('robot_1', 'SUCCEEDED'): 8, ('robot_2', 'SUCCEEDED'): 8}
    lockstep.assert_identical()
