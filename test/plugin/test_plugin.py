"""The plugin for pytest, as users have it: tests that pass, tests that must fail, and the tests of the examples."""
import importlib.util
import json
import os
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from types import SimpleNamespace

import pytest

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract_ros.loopback import find_executable
from move_base_abstract_testing.system import System

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
NODES = {'study/package.xml': '<package><name>study</name></package>', 'study/late.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
rospy.init_node('late')
seen = {}
def two(message):
    if 'one' not in seen:
        raise KeyError('%s came before one' % message.data)
rospy.Subscriber('/one', String, lambda message: seen.update(one=message))
rospy.Subscriber('/two', String, two)
rospy.sleep(4.0)
for number in range(9):
    print('goes on', number)
rospy.spin()
""", 'study/talks.py': """#!/usr/bin/env python3
import rospy
print('it has begun')
rospy.init_node('talks')
rospy.spin()
""", 'study/says.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
rospy.init_node('says')
one, two = (rospy.Publisher(name, String, queue_size=5) for name in ('/one', '/two'))
rospy.sleep(1.0)
one.publish('1')
rospy.sleep(0.05)
two.publish('2')
rospy.spin()
"""}
TESTS = """
import os
import time

import pytest
import rospy

from move_base_abstract.properties import always, sometimes
from move_base_abstract_testing import system

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


@pytest.mark.lockstep(scenario='two.yaml', until='idle', time_master={'speed_limit': 900.0})
def test_a_run_that_ends_by_itself_is_waited_for(lockstep, monkeypatch):
    monkeypatch.setattr(system, '_OVER_S', 0.0)  # how long one that ends with its test may take
    lockstep.send_goal('robot_1', 900.0, 1.0)
    lockstep.finish()
    assert [one.values[1] for one in lockstep.log.of('ended')] == ['SUCCEEDED']


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


@pytest.mark.xfail
@two
def test_what_is_expected_to_break_is_no_failure(lockstep):
    always(False, 'no is yes')


@pytest.mark.lockstep(nodes=['study/late.py', 'study/says.py'], chaos_seeds=[2], chaos_delay=0.2)
def test_late(lockstep):
    lockstep.run_for(10.0)


@pytest.mark.lockstep(scenario='faulty.yaml', chaos_seeds=[2])
def test_on_purpose(lockstep):
    assert lockstep.send_goal('robot_0', 3.0, 1.0).wait() == 'SUCCEEDED'


@pytest.mark.lockstep(nodes=['study/late.py'])
def test_what_a_user_s_node_says_last_is_shown(lockstep):
    lockstep.run_for(10.0)
    assert lockstep.time < 0


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


@pytest.mark.lockstep(nodes=['study/talks.py'], wall_limit=10.0)
def test_a_test_that_hangs_is_ended(lockstep):
    time.sleep(1000.0)


def test_without_the_fixture_nothing_is_different():
    assert os.environ.get('ROS_MASTER_URI') == 'http://127.0.0.1:1/'
"""
FAILS = {
    'test_what_is_broken_fails': 'always: at 3.000000000 s, /test: no is yes (number=7)',
    'test_late[chaos_2]': 'no_exception: at 2.101057043 s, /late: KeyError in a callback of /two, late.py, line 8',
    'test_on_purpose[chaos_2]': "assert 'ABORTED' == 'SUCCEEDED'",
    'test_what_a_user_s_node_says_last_is_shown': 'assert 11.0 < 0',
    'test_what_differs_fails': 'a second run is different:',
    'test_what_never_comes_fails': 'the impossible is not true 100 s later, at 101.000000000 s',
    'test_who_is_not_there_is_named': "there is no robot 'robot_7': no node serves /robot_7/move_base",
    'test_a_node_that_ends_too_soon_is_named': '/recorder ended (exit code 1) before time started; it printed last:',
    'test_a_time_master_that_ends_too_soon_is_named': '/time_master ended (exit code 1) before time started; it',
    'test_a_file_that_is_not_there_is_named': 'three.yaml is not there',
    'test_a_word_that_is_not_known_is_named': "lockstep: the key 'robot' is unknown",
    'test_a_test_that_hangs_is_ended': 'the test was not over after 10 s of wall time (wall_limit)'}


def environment(folder):
    """Return the environment of programs that find the packages in a folder, and no ROS master."""
    return dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:1/',
                ROS_PACKAGE_PATH=os.pathsep.join([str(folder), os.environ['ROS_PACKAGE_PATH']]))


def results_of(folder, *words):
    """Run pytest with the plugin in a folder; return ({test: its problem, or ''}, output of pytest)."""
    done = subprocess.run(  # noqa: PLW1510 - some tests must fail
        [sys.executable, '-m', 'pytest', '-p', 'no:cacheprovider', '-p', 'move_base_abstract_testing', '--junitxml',
         'results.xml', *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
        timeout=GUARD, env=environment(folder))
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
    (folder / 'study').mkdir()
    faulty = SCENARIO + 'defaults: {buggify: {abort: 1.0}}\n'
    for name, text in (('two.yaml', SCENARIO), ('faulty.yaml', faulty), ('bad.launch', LAUNCH),
                       ('test_of_a_user.py', TESTS), *NODES.items()):
        (folder / name).write_text(text)
        (folder / name).chmod(0o755)
    return (*results_of(folder), folder)


def test_tests_that_are_right_pass(session):
    told, said, _ = session
    right = {name: problem for name, problem in told.items() if name not in FAILS}
    assert len(right) == 7 and set(right.values()) == {''}, said


@pytest.mark.parametrize('name', FAILS)
def test_tests_that_are_wrong_say_why(session, name):
    assert FAILS[name] in session[0][name], session[1]


@pytest.mark.parametrize('name', [name for name in FAILS if name.endswith(('too_soon_is_named', 'known_is_named'))])
def test_a_system_that_cannot_start_shows_no_code_of_ours(session, name):
    assert 'move_base_abstract_testing' not in session[0][name].replace('-p move_base_abstract_testing', '')
    assert session[0][name].lstrip().startswith(FAILS[name])


def test_that_a_node_has_ended_is_told_again_to_who_catches_all_exceptions():
    system = object.__new__(System)
    system._run = SimpleNamespace(gone=lambda: ('/late', 1, ['no such file']) if told else None)
    told = []
    with pytest.raises(SimulatorError, match=r'/late ended \(exit code 1\) before time'), system.watched():
        told.append(True)
        with pytest.raises(SimulatorError):
            signal.raise_signal(signal.SIGCHLD)
        time.sleep(20.0)  # a guard: the signal ends it


def test_a_broken_property_fails_the_test_and_is_no_error_after_it(session):
    said = session[1]
    assert 'ERROR at teardown' not in said
    assert 'FAILED test_of_a_user.py::test_what_is_broken_fails' in said and ' 1 xfailed' in said
    assert ('run it again: python3 -m pytest -p move_base_abstract_testing '
            'test_of_a_user.py::test_what_is_broken_fails\n') in said


def test_why_a_test_failed_is_what_nodes_raised_and_said_last_and_what_was_late(session):
    said = session[1]
    assert re.search(r"""
/late crashed at 2.101057043 s: KeyError in a callback of /two, late.py, line 8
    KeyError: '2 came before one'
(    goes on [345678]\n){6}the chaos of seed 2 made 2 decisions before that:
    /says's message on /one was under way to /late for 0.130486982 s, at 2 s
    /says's message on /two was under way to /late for 0.051057043 s, at 2.05 s
""", said), said
    assert 'the chaos of seed 2 made 1 decision:\n    robot_0 gave its goal up, at 1.8' in said, said
    assert 'talks printed last:\n    it has begun\n' in said
    assert re.search(r'/late printed last:\n(    goes on [345678]\n){6}before that, in ', said), said


def test_a_test_that_fails_is_debugged_from_before_the_fault(session):
    said, folder = session[1:]
    own = said.partition('_ test_late[chaos_2] _')[2].partition('- lockstep -')[0]
    command = re.search(r'before that, in the debugger: rosrun move_base_abstract debug (.*)\n', own).group(1)
    assert re.fullmatch(r'--log \S+/run_1/events.jsonl --at 2.001057043', command), command
    done = subprocess.run([find_executable('debug'), '--json', *command.split()], cwd='/', check=False, timeout=GUARD,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(folder),
                          input='until broken\nback 1\nquit\n')
    start, broken, back = map(json.loads, done.stdout.splitlines())
    assert (start['time_ns'], broken['broken']['instant_ns'], broken['broken']['node']) == (
        2001057043, 2101057043, '/late'), done.stderr
    assert back['rows_so_far'] < broken['rows_so_far'] and back['time_ns'] < 2101057043, done.stderr
    assert done.returncode == 0, done.stderr  # 5: a row differed


def test_the_file_of_a_test_runs_it_again(session):
    said, folder = session[1:]
    path = re.search(r'chaos --replay (\S+/run_1/chaos\.json)\n', said).group(1)

    def replayed():
        done = subprocess.run([find_executable('chaos'), '--replay', path], cwd='/', check=False, timeout=GUARD,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment(folder))
        return done.returncode, done.stdout
    code, again = replayed()
    assert (code, 'chaos: the same bytes as before\n' in again) == (1, True), again
    assert 'chaos: failed: no_exception: at 2.101057043 s, /late: KeyError' in again
    (folder / 'study/late.py').write_text(NODES['study/late.py'].replace('raise KeyError', 'print'))
    code, again = replayed()
    assert (code, 'chaos: it does not fail any more: no_exception: at 2.1' in again) == (3, True), again


@pytest.mark.parametrize('name, count', [
    ('test_coordinator.py', 3), ('experiments/test_systems.py', 2), ('test_own_simulator.py', 1),
    ('test_thousand_robots.py', 1)])
def test_the_examples_tests_pass(tmp_path, name, count):
    side_by_side = ['-n', '2'] if importlib.util.find_spec('xdist') and count > 1 else []
    told, said = results_of(tmp_path, *side_by_side, str(ROOT / 'examples' / name))
    assert len(told) == count and set(told.values()) == {''}, said
