"""Tests of coordinator.py, a model for tests of your own coordinator.

    python3 -m pytest -p move_base_abstract_testing test_coordinator.py

A test also fails if something is broken at the end of its run: goals that never end, robots that wait for each other,
or crashes.
"""
from collections import Counter

import pytest

FIVE = {'scenario': '$(find move_base_abstract)/examples/mission_scenario.yaml',
        'robots': '[robot_0, robot_1, robot_2, robot_3, robot_4]', 'seed': 5}
HOUR = 3600.0


@pytest.mark.lockstep(launch='coordinator.launch', until='idle')
def test_each_task_is_done_once(lockstep):
    """No robot does a task that another robot has done."""
    done = Counter(event.values[0] for event in lockstep.log.of('task_ended'))
    assert len(done) == 20 and set(done.values()) == {1}


@pytest.mark.lockstep(launch='coordinator.launch')
def test_who_drives_elsewhere_meanwhile_leaves_the_task_to_the_other(lockstep):
    """Another client sends a robot away, and the coordinator goes on. A second run is identical."""
    goal = lockstep.send_goal('robot_0', 30.0, 30.0)
    assert goal.wait() in ('SUCCEEDED', 'PREEMPTED')
    lockstep.assert_identical()


@pytest.mark.lockstep(launch='coordinator.launch', args=FIVE, until='idle', log_messages=False)
def test_five_robots_do_the_work_of_eight_hours(lockstep):
    """Five robots do 480 tasks, in a few seconds of wall time."""
    log = lockstep.log
    ends = [event.values[1] for event in log.of('task_ended')]
    assert ends == 480 * ['SUCCEEDED']
    assert log.events[-1].time > 7 * HOUR
