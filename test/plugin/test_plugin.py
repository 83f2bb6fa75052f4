"""The plugin for pytest, as users have it: tests that pass, tests that must fail, and the tests of the examples."""
import importlib.util
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GUARD = 300.0  # s, wall; only ends a program that would never end
SCENARIO = 'robots:\n  - {name: robot, count: 2, start_y: 1.0, step_x: 5.0}\n'
LAUNCH = """<launch>
  <arg name="x"/>
  <param name="asked" value="$(arg x)"/>
  <node pkg="move_base_abstract" type="lockstep" name="recorder"
        args="--own move_base_abstract_ros.nodes.message_recorder_node"/>
</launch>
"""
TESTS = """
import os
import time

import pytest
import rospy

from move_base_abstract.properties import always, sometimes

two = pytest.mark.lockstep(scenario='two.yaml')


@two
def test_goals_end_and_runs_are_identical(lockstep):
    assert lockstep.time == 1.0
    goal = lockstep.send_goal('robot_0', 3.0, 1.0)
    assert (goal.wait(), goal.ended_at, lockstep.time > 1.0) == ('SUCCEEDED', lockstep.time, True)
    began = time.monotonic()
    lockstep.run_for(3600.0)
    lockstep.run_until(40000.0)
    assert lockstep.time == 40000.0 and time.monotonic() - began < 60.0
    other = lockstep.send_goal('robot_1', 900.0, 1.0)
    lockstep.run_for(5.0)
    other.cancel()
    assert other.wait() == 'PREEMPTED'
    sometimes(False, 'this never holds')
    assert lockstep.never_held() == [('/test', 'this never holds')]
    ends = lockstep.log.of('ended')
    assert [(one.robot, one.values[1]) for one in ends] == [('robot_0', 'SUCCEEDED'), ('robot_1', 'PREEMPTED')]
    assert ends[0].time == goal.ended_at and lockstep.log.labels == []
    lockstep.assert_identical()


@pytest.mark.lockstep(scenario='two.yaml', chaos_seeds=range(2))
def test_of_seeds(lockstep):
    lockstep.finish()
    with open(lockstep.log.path) as stream:
        assert ('chaos' in stream.readline()) == (lockstep.chaos_seed > 0)


def test_what_is_broken_may_be_allowed(lockstep):
    lockstep.start(scenario='two.yaml', param={'/asked': 7})
    assert rospy.get_param('/asked') == 7
    always(False, 'no is yes')
    lockstep.allow('no is yes')


@two
def test_what_is_broken_fails(lockstep):
    lockstep.run_for(2.0)
    always(False, 'no is yes', number=7)


@two
def test_what_differs_fails(lockstep):
    lockstep.run_for(1.0 + int.from_bytes(os.urandom(4), 'big') * 1e-9)
    lockstep.send_goal('robot_0', 3.0, 1.0).wait()
    lockstep.assert_identical()


@two
def test_what_never_comes_fails(lockstep):
    lockstep.run_until(lambda: False, limit=100.0, what='the impossible')


@two
def test_who_is_not_there_is_named(lockstep):
    lockstep.send_goal('robot_7', 3.0, 1.0)


@pytest.mark.lockstep(launch='bad.launch', args={'x': 7})
def test_a_node_that_ends_too_soon_is_named(lockstep):
    pass


@pytest.mark.lockstep(scenario='two.yaml', time_master={'end_at': -7.0})
def test_a_time_master_that_ends_too_soon_is_named(lockstep):
    pass


@pytest.mark.lockstep(scenario='three.yaml')
def test_a_file_that_is_not_there_is_named(lockstep):
    pass


@pytest.mark.lockstep(robot='two.yaml')
def test_a_word_that_is_not_known_is_named(lockstep):
    pass


@pytest.mark.lockstep(scenario='two.yaml', wall_limit=3.0)
def test_a_test_that_hangs_is_ended(lockstep):
    time.sleep(1000.0)


def test_without_the_fixture_nothing_is_different():
    assert os.environ.get('ROS_MASTER_URI') == 'http://127.0.0.1:1/'
"""
FAILS = {
    'test_what_is_broken_fails': 'always: at 3.000000000 s, /test: no is yes (number=7)',
    'test_what_differs_fails': 'a second run is different:',
    'test_what_never_comes_fails': 'the impossible is not true 100 s later, at 101.000000000 s',
    'test_who_is_not_there_is_named': "there is no robot 'robot_7': no node serves /robot_7/move_base",
    'test_a_node_that_ends_too_soon_is_named': '/recorder ended (exit code 1) before time started; it printed last:',
    'test_a_time_master_that_ends_too_soon_is_named': '/time_master ended (exit code 1) before time started; it',
    'test_a_file_that_is_not_there_is_named': 'three.yaml is not there',
    'test_a_word_that_is_not_known_is_named': "lockstep: the key 'robot' is unknown",
    'test_a_test_that_hangs_is_ended': 'the test was not over after 3 s of wall time (wall_limit)'}


def results_of(folder, *words):
    """Run pytest with the plugin in a folder; return ({test: its problem, or ''}, output of pytest)."""
    done = subprocess.run(  # noqa: PLW1510 - some tests must fail
        [sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '-p', 'move_base_abstract_testing', '--junitxml',
         'results.xml', *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
        timeout=GUARD, env=dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:1/'))
    assert os.path.exists(folder / 'results.xml'), done.stdout
    cases = ElementTree.parse(folder / 'results.xml').iter('testcase')
    told = {}
    for case in cases:
        told[case.get('name')] = told.get(case.get('name'), '') + ''.join(
            (one.text or '') for one in case if one.tag in ('failure', 'error'))
    return told, done.stdout


@pytest.fixture(scope='module')
def session(tmp_path_factory):
    folder = tmp_path_factory.mktemp('session')
    for name, text in (('two.yaml', SCENARIO), ('bad.launch', LAUNCH), ('test_of_a_user.py', TESTS)):
        (folder / name).write_text(text)
    return results_of(folder)


def test_tests_that_are_right_pass(session):
    told, said = session
    right = {name: problem for name, problem in told.items() if name not in FAILS}
    assert len(right) == 5 and set(right.values()) == {''}, said


@pytest.mark.parametrize('name', FAILS)
def test_tests_that_are_wrong_say_why(session, name):
    assert FAILS[name] in session[0][name], session[1]


@pytest.mark.parametrize('name, count', [
    ('test_coordinator.py', 3), ('experiments/test_systems.py', 2), ('test_own_simulator.py', 1),
    ('test_thousand_robots.py', 1)])
def test_the_examples_tests_pass(tmp_path, name, count):
    side_by_side = ['-n', '2'] if importlib.util.find_spec('xdist') and count > 1 else []
    told, said = results_of(tmp_path, *side_by_side, str(ROOT / 'examples' / name))
    assert len(told) == count and set(told.values()) == {''}, said
