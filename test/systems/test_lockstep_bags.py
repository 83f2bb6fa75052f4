"""Bags of runs: recorders take part however they are started, write equal bytes, and are in the log or labelled."""
import itertools
import os
import subprocess
import unittest

import rosbag
from own_folder import OwnPackage
from scenarios import Condition, repeated

from move_base_abstract.runs.event_log import EventLog
from move_base_abstract_ros.loopback import find_executable

GUARD = 200.0  # s, wall; only ends a run that would never end
COUNTS = '<node pkg="study_of_others" type="counts.py" name="counts"/>'
SPLIT = '<node pkg="rosbag" type="record" name="split" args="-O split --split --duration=10 /ticks"/>'
RECORDERS = """
<node pkg="rosbag" type="record" name="all" args="-a -o all"/>
<node pkg="rosbag" type="record" name="some" args="-e '/(.*)icks' -x '/o.*' -O some -b 1 --lz4"/>
<node pkg="rosbag" type="record" name="by_name" args="-q -j -O by_name number /other">
  <remap from="number" to="/ticks"/>
</node>
<node pkg="study_of_others" type="records" name="script" args="-O script"/>
"""
FILES = {'records': """#!/bin/sh
exec rosbag record -a "$@"
""", 'counts.py': """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32, String
rospy.init_node('counts')
ticks = rospy.Publisher('ticks', Int32, queue_size=5)
latched = rospy.Publisher('other', String, queue_size=5, latch=True)
latched.publish('begin')
late = None
for number in range(40):
    rospy.sleep(1.0)
    ticks.publish(number)
    rospy.loginfo('said %d', number)
    if number == 20:
        late = rospy.Publisher('late', Int32, queue_size=5)
    if late:
        late.publish(number)
rospy.spin()
"""}
SECOND = 10 ** 9


class BagsTest(OwnPackage, unittest.TestCase):
    FILES = FILES

    def run_it(self, name, *words, nodes, condition=Condition(), may_fail=False):
        """Run nodes in a folder of this name, which gets their bags; return (output, the EventLog)."""
        folder = self.path(name)
        os.mkdir(folder)
        environment = dict(self.environment, ROS_HOME=folder, ROSCONSOLE_STDOUT_LINE_BUFFERED='1')
        log = os.path.join(folder, 'events.jsonl')
        command = [find_executable('lockstep_launch'), '--event-log', log, *words, *condition.options,
                   self.write('system.launch', '<launch>{}</launch>'.format(COUNTS + nodes))]
        with condition.around():
            process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       text=True)
            said, _ = process.communicate(timeout=GUARD)
        if not may_fail:
            self.assertEqual(process.returncode, 0, said)
        with open(log) as stream:
            read = EventLog(stream.readlines(), log)
        list(read)
        return said, read

    def stamps(self, *path):
        with rosbag.Bag(self.path(os.path.join(*path))) as bag:
            found = {}
            for topic, _, at in bag.read_messages(raw=True):
                found.setdefault(topic, []).append(at.to_nsec())
        return found

    def test_recorders_as_people_start_them_leave_equal_bytes_at_any_load_and_speed(self):
        names = itertools.count()

        def run(condition):
            name = 'run_{}'.format(next(names))
            said, log = self.run_it(name, '--until', '45', nodes=RECORDERS + SPLIT, condition=condition)
            self.assertIn('6 of 6 nodes take part', said)
            self.assertEqual(log.end['not_repeatable_because'] + log.end['degraded_because'], [], said)
            found = {node: [(bag['name'], bag['sha256']) for bag in bags] for node, bags in log.bags.items()}
            self.assertEqual([one for one in sorted(os.listdir(self.path(name))) if '.bag' in one],
                             sorted(one for bags in found.values() for one, _ in bags))
            return found
        digests = [run(Condition()), *repeated('recorders', run, lambda found: repr(found).encode())]
        for other in digests[1:]:
            self.assertEqual(other, digests[0])
        self.assertEqual({node: len(bags) for node, bags in digests[0].items()},
                         {'/all': 1, '/by_name': 1, '/some': 1, '/script': 1, '/split': 5})
        ticks = [second * SECOND for second in range(2, 42)]
        self.assertEqual(self.stamps('run_0', 'some.bag'), {'/ticks': ticks})
        self.assertEqual(self.stamps('run_0', 'by_name.bag'), {'number': ticks, '/other': [SECOND]})
        every = self.stamps('run_0', 'script.bag')
        self.assertEqual(sorted(every), ['/late', '/other', '/ticks'])  # topics that go past lockstep are left out
        self.assertEqual(every['/ticks'], ticks)
        done = subprocess.run([find_executable('compare'), *(self.path(os.path.join(name, 'events.jsonl'))
                                                             for name in ('run_0', 'run_1'))],
                              stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (0, 'identical\n0 events each, 9 bags each\n'))

    def test_recorders_alone_are_nothing_to_do(self):
        _, log = self.run_it('a', '--end-when-idle', nodes=RECORDERS)
        self.assertIn('idle', log.end['reason'])
        self.assertEqual(self.stamps('a', 'some.bag')['/ticks'][-1], 41 * SECOND)

    def test_a_bag_that_is_not_covered_labels_the_run(self):
        recorder = '<node pkg="rosbag" type="record" name="recorder" args="-O x {}"/>'
        for name, words, args, why in (
                ('a', ('--onlooker', '/recorder'), '/ticks', 'it looks on: as it was asked for'),
                ('b', (), '/ticks /rosout', 'it records /rosout, which goes past lockstep')):
            said, log = self.run_it(name, '--until', '5', *words, nodes=recorder.format(args))
            self.assertIn("lockstep_launch: the bag of '/recorder' is not covered: " + why, said)
            self.assertIn("the bag of '/recorder' is not covered: " + why, log.end['not_repeatable_because'])
            self.assertFalse(log.end['repeatable'])

    def test_a_recorder_that_is_killed_labels_the_run(self):
        killer = '<node pkg="study_of_others" type="kills.py" name="kills"/>'
        self.write('kills.py', """#!/usr/bin/env python3
import os
import signal
import rosgraph
import rospy
import xmlrpc.client
rospy.init_node('kills')
rospy.sleep(5.0)
uri = rosgraph.Master('/kills').lookupNode('/recorder')
os.kill(xmlrpc.client.ServerProxy(uri).getPid('/kills')[2], signal.SIGKILL)
rospy.spin()
""", 0o755)
        recorder = '<node pkg="rosbag" type="record" name="recorder" args="-O x /ticks"/>'
        said, log = self.run_it('a', '--until', '8', nodes=killer + recorder, may_fail=True)
        self.assertIn('  not covered: it was not closed', said)
        self.assertIn("the bag of '/recorder' is not covered: it was not closed", log.end['not_repeatable_because'])
        self.assertEqual(log.bags, {})
