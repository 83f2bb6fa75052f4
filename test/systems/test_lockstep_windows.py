"""Runs with a lookahead: the times that calls and messages take, and that each run is the same on any machine."""
import itertools
import os
import unittest

import warm
from own_folder import GUARD, OwnPackage, events_of
from own_nodes import NODES
from scenarios import Condition, repeated
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

SYSTEM = os.path.join(NODES, 'foreign', 'system.launch')
NS, AHEAD = 1000000000, 50000000
# Programs as people write them. A C++ node repeats the messages of the first; the last asks for its parameters.
SCRIPTS = {
    'tells.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
rospy.init_node('tells')
ticks = rospy.Publisher('/ticks', String, queue_size=5)
rospy.sleep(0.5)
rate = rospy.Rate(40)
for number in range(100):
    ticks.publish(str(rospy.Time.now().to_nsec()))
    rospy.set_param('/told', number)
    rate.sleep()
""", 'hears.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
rospy.init_node('hears')
lines = []
for topic in ('/ticks', '/heard', '/answers'):
    rospy.Subscriber(topic, String, lambda message, topic=topic: lines.append(
        '{} {} {}\\n'.format(rospy.Time.now().to_nsec(), topic, message.data)))
rospy.sleep(8)
with open(rospy.get_param('~path'), 'w') as stream:
    stream.writelines(lines)
""", 'asks.py': """#!/usr/bin/env python3
import rospy
rospy.init_node('asks')
lines = []
for number in range(60):
    rospy.sleep(0.033)
    topics = [name for name, _ in rospy.get_published_topics()] if number % 20 == 0 else ''
    lines.append('{} {} {}\\n'.format(rospy.Time.now().to_nsec(), rospy.get_param('/told', -1), topics))
with open(rospy.get_param('~path'), 'w') as stream:
    stream.writelines(lines)
"""}
LAUNCH = """<launch>
  <arg name="path"/>
  <node pkg="study_of_others" type="tells.py" name="tells"/>
  <node pkg="study_of_others" type="asks.py" name="asks"><param name="path" value="$(arg path).asks"/></node>
  <node pkg="study_of_others" type="hears.py" name="hears" required="true">
    <param name="path" value="$(arg path).hears"/>
  </node>
  <node pkg="move_base_abstract" type="shim_listener" name="relay"/>
  <node pkg="move_base_abstract" type="shim_calls" name="server"><param name="work" value="0.02"/></node>
  <node pkg="move_base_abstract" type="shim_calls" name="client"><param name="client" value="true"/></node>
</launch>
"""


class WindowsTest(OwnPackage, unittest.TestCase):
    FILES = {'all.launch': LAUNCH, **SCRIPTS}

    def run_ahead(self, name, *words, prefix=()):
        """Run a launch file with a lookahead; return (its events, the end of its log)."""
        done = warm.run([*prefix, find_executable('lockstep_launch'), '--lookahead', '0.05', '--log-messages',
                         '--event-log', self.path(name + '.jsonl'), *words], self.environment, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        log, events = events_of(self.path(name + '.jsonl'))
        self.assertEqual(log.end['not_repeatable_because'] + log.end['degraded_because'], [])
        return events, log.end

    def lines(self, name):
        with open(self.path(name)) as stream:
            return stream.read().splitlines()

    def test_everything_takes_exactly_the_lookahead_and_every_run_is_the_same(self):
        names = itertools.count()

        def run(condition, prefix=()):
            name = str(next(names))
            with condition.around():
                events, end = self.run_ahead(name, *condition.options, self.path('all.launch'),
                                             'path:=' + self.path(name), prefix=prefix)
            self.assertEqual((end['ended_by'], end['node'], end['at_ns']), ('departure', '/hears', 9 * 10 ** 9))
            return events, end, self.lines(name + '.hears'), self.lines(name + '.asks')
        runs = repeated('with a lookahead', run, lambda one: repr(one).encode())
        for other in (*runs[1:], run(Condition(), ('taskset', '-c', '0'))):
            self.assertEqual(other, runs[0])
        heard = [line.split(' ', 2) for line in runs[0][2]]
        ticks = [(int(now), int(text)) for now, topic, text in heard if topic == '/ticks']
        self.assertEqual(ticks, [(sent + AHEAD, sent) for sent in range(3 * NS // 2, 4 * NS, NS // 40)])
        relayed = [(int(now), text) for now, topic, text in heard if topic == '/heard']
        self.assertEqual(relayed, [(sent + 2 * AHEAD, '{} heard {}'.format(sent + AHEAD, sent)) for _, sent in ticks])
        # The request takes 0.05 s, the server 0.02 s, the answer 0.05 s, and the message about it 0.05 s.
        answers = [(int(now), text) for now, topic, text in heard if topic == '/answers']
        self.assertEqual(answers, [(3 * NS + AHEAD, '{} not found'.format(3 * NS)),
                                   (3 * NS + 2 * AHEAD, '{} found'.format(3 * NS + AHEAD))] + [
            (called + 170000000, '{} at {}'.format(called + 120000000, called + 70000000))
            for called in range(3 * NS + AHEAD, 9 * NS, NS)])
        # A value is not seen before it is set, and it is seen one lookahead later at the latest.
        for line in runs[0][3]:
            now, told, _ = line.split(' ', 2)
            since = int(now) - 3 * NS // 2
            self.assertLessEqual(int(told), max(since // (NS // 40), -1))
            self.assertGreaterEqual(int(told), min((since - AHEAD) // (NS // 40), 99))

    def test_a_whole_system_with_actions_and_a_bag_is_the_same_on_one_core(self):
        runs = [self.run_ahead(name, SYSTEM, 'bag:=' + self.path(name), 'tasks:=6', prefix=prefix)
                for name, prefix in (('a', ()), ('b', ('taskset', '-c', '0')))]
        self.assertGreater(len(runs[0][0]), 100)
        self.assertEqual(runs[0][0], runs[1][0])
        self.assertEqual(*[end['bags'][0]['sha256'] for _, end in runs])

    def test_a_lookahead_is_refused_where_no_node_waits_for_another(self):
        with Loopback() as ros:
            self.environment = ros.environment
            code, said = self.run_it('time_master', '_mode:=scaled', '_lookahead:=0.05')
        self.assertEqual(code, 1, said)
        self.assertIn('lookahead must be 0 in mode scaled', said)

    def test_a_lookahead_that_cannot_be_is_refused_before_anything_starts(self):
        for value, got in (('-1', '-1.0'), ('nan', "'nan'"), ('1e-9', '1e-09'), ('5000', '5000.0'), ('abc', "'abc'")):
            code, said = self.run_it('lockstep_launch', '--lookahead=' + value, 'any.launch')
            self.assertEqual(code, 2)
            self.assertIn('--lookahead: got {}; allowed: a number in 1e-6..1000 [s, simulated], or 0, or network\n'
                          .format(got), said)
