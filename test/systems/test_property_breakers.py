"""Each built-in property alone is broken by each node that breaks it: in a run, a test, an experiment."""
import csv
import subprocess
import sys
import unittest

import pytest
from night import times
from own_folder import GUARD, OwnPackage

from move_base_abstract.runs.built_in import BUILT_IN

NODES = """#!/usr/bin/env python3
import os
import sys
import threading
import rospy
from concurrent.futures import ThreadPoolExecutor
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import String
def main_thread():
    rospy.sleep(2.0)
    raise RuntimeError('main')
def callback():
    rospy.Timer(rospy.Duration(1.0), lambda event: {}['k'])
    rospy.sleep(3.0)
def thread():
    one = threading.Thread(target=lambda: {}['k'])
    one.start()
    one.join()
    rospy.sleep(3.0)
def unasked():
    job = ThreadPoolExecutor(1).submit(lambda: {}['k'])
    rospy.sleep(3.0)
def exit_two():
    rospy.sleep(2.0)
    sys.exit(2)
def killed():
    rospy.sleep(2.0)
    os.kill(os.getpid(), 11)
def deadlock():
    lock = threading.Lock()
    lock.acquire()
    rospy.sleep(1.0)
    lock.acquire()
def loop():
    said = rospy.Publisher('/a', String, queue_size=1)
    rospy.Subscriber('/a', String, said.publish)
    rospy.sleep(1.0)
    said.publish('x')
    rospy.spin()
def goal():
    sent = rospy.Publisher('/b/move_base_simple/goal', PoseStamped, queue_size=1)
    rospy.sleep(1.0)
    target = PoseStamped()
    target.header.frame_id = 'map'
    target.pose.position.x = 10.0
    target.pose.orientation.w = 1.0
    sent.publish(target)
def nothing():
    rospy.sleep(3.0)
rospy.init_node('x')
globals()[rospy.get_param('~how')]()
"""
LAUNCH = """<launch>
  <arg name="how"/>
  <arg name="robots" default="[]"/>
  <group unless="$(eval robots == '[]')">
    <node pkg="move_base_abstract" type="fleet" name="fleet"><rosparam subst_value="true">
      zones: [{name: gate, rectangle: [4.0, -1.0, 6.0, 1.0], capacity: 1}]
      robots: $(arg robots)
    </rosparam></node>
  </group>
  <node pkg="study_of_others" type="nodes" name="node"><param name="how" value="$(arg how)"/></node>
</launch>
"""
#: what each node breaks; some have robots beside them
BREAKS = {'main_thread': 'no_crash no_exception', 'callback': 'no_crash no_exception',
          'thread': 'no_crash no_exception', 'unasked': 'no_crash no_exception', 'exit_two': 'no_crash',
          'killed': 'no_crash', 'deadlock': 'no_standstill', 'loop': 'no_zero_delay_loop',
          'goal': 'every_goal_ends', 'full': 'capacities_kept', 'empty': 'charged', 'nothing': ''}
ROBOTS = {'goal': '[{name: a, start_x: 5.0}, {name: b}]',
          'full': '[{name: a, start_x: 5.0}, {name: b, start_x: 5.5}]',
          'empty': '[{name: b, battery_capacity: 0.001, battery_start: 0.01}]'}
TESTS = """
import pytest
@pytest.mark.parametrize('how, robots, name, is_broken', {table!r})
def test(lockstep, how, robots, name, is_broken):
    lockstep.start(launch='one.launch', args={{'how': how, 'robots': robots}}, properties=[name], until='idle',
                   time_master={{'max_microsteps': 1000}})  # soon, on a busy machine, too
    found = {{one.property for one in lockstep.finish()}}
    lockstep.allow(name)
    assert found == ({{name}} if is_broken else set())
@pytest.mark.parametrize('how', ['main_thread', 'callback'])
def test_what_was_told_once_is_told_by_the_other_name_if_one_is_allowed(lockstep, how):
    lockstep.start(launch='one.launch', args={{'how': how}}, until='idle')
    assert [one.property for one in lockstep.not_allowed] == ['no_exception']
    lockstep.allow('no_exception')
    assert [one.property for one in lockstep.not_allowed] == ['no_crash']
    lockstep.allow('no_crash')
    assert lockstep.not_allowed == []
"""
EXPERIMENT = """
experiment: breakers
launch: one.launch
args: {{how: '{{how}}', robots: "{{robots}}"}}
factors: {{how: [{how}], robots: ["{robots}"]}}
until: {{idle: true}}
crashes: allow
properties: [{name}]
"""
TABLE = [(how, ROBOTS.get(how, '[]'), name, name in BREAKS[how].split()) for how in BREAKS for name in BUILT_IN]
BROKEN = [(how, robots, name) for how, robots, name, is_broken in TABLE if is_broken]


def named(how):
    """Return the function of nodes that runs: robots alone break something, too."""
    return how if f'def {how}()' in NODES else 'nothing'


class PropertyBreakersTest(OwnPackage, unittest.TestCase):
    FILES = {'nodes': NODES, 'one.launch': LAUNCH}

    def test_the_table_has_all_properties(self):
        self.assertEqual({name for _, _, name in BROKEN}, set(BUILT_IN))

    def test_a_run_breaks_each_alone(self):
        for how, robots, name in BROKEN:
            code, said = self.run_it('lockstep_launch', '--end-when-idle', '--crashes', 'allow', '--property', name,
                                     self.path('one.launch'), f'how:={named(how)}', f'robots:={robots}')
            told = [line.split()[2] for line in said.splitlines() if line.startswith('lockstep_launch: broken: ')]
            self.assertEqual((code, set(told)), (4, {name + ':'}), how + said)

    def test_a_test_breaks_each_alone_and_no_other(self):
        those = times(('main_thread', 'empty', 'goal', 'nothing'), tuple(BREAKS))
        table = [(named(how), *rest) for how, *rest in TABLE if how in those and (rest[-1] or how in those[-1:])]
        file = self.write('test_breakers.py', TESTS.format(table=table))
        done = subprocess.run([sys.executable, '-m', 'pytest', '-q', '-p', 'move_base_abstract_testing', file],
                              env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=GUARD,
                              cwd=self.folder, check=False)
        self.assertEqual(done.returncode, 0, done.stdout.decode())
        self.assertIn(f'{len(table) + 2} passed', done.stdout.decode())

    def break_in_experiment(self, name):
        """Run an experiment of all that break a property, for each set of robots."""
        for robots in dict.fromkeys(robots for _, robots, broken in BROKEN if broken == name):
            those = [how for how, other, broken in BROKEN if (other, broken) == (robots, name)]
            out = f'{name}_{len(those)}'
            file = self.write(out + '.yaml', EXPERIMENT.format(
                how=', '.join(map(named, those)), robots=robots, name=name))
            said = self.run_it('experiment', 'run', file, '-o', self.path(out), '--workers', '1')[1]
            self.assertIn(f'broken in {len(those)} of {len(those)} runs', said)
            with open(self.path(out + '/trials.csv'), newline='') as stream:
                self.assertEqual([row['broken_properties'] for row in csv.DictReader(stream)], ['1'] * len(those), said)

    def test_an_experiment_breaks_a_crash_alone(self):
        self.break_in_experiment('no_crash')

    @pytest.mark.night
    def test_an_experiment_breaks_each_alone(self):
        for name in BUILT_IN:
            self.break_in_experiment(name)


if __name__ == '__main__':
    unittest.main()
