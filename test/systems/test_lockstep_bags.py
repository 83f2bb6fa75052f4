"""Bags of runs: recorders take part however they are started, write equal bytes, and are in the log or labelled."""
import itertools
import os
import unittest

import rosbag
from own_folder import OwnPackage
from scenarios import Condition, repeated

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

    def record(self, name, *words, nodes, condition=Condition(), code=0):
        """Run nodes in a folder of this name, which gets their bags; return (output, the EventLog)."""
        os.mkdir(self.path(name))
        self.environment.update(ROS_HOME=self.path(name), ROSCONSOLE_STDOUT_LINE_BUFFERED='1')
        file = self.write('system.launch', '<launch>{}</launch>'.format(COUNTS + nodes))
        with condition.around():
            return self.launch(os.path.join(name, 'events.jsonl'), *words, *condition.options, file, code=code)[:2]

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
            said, log = self.record(name, '--until', '45', nodes=RECORDERS + SPLIT, condition=condition)
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
        logs = (self.path(os.path.join(name, 'events.jsonl')) for name in ('run_0', 'run_1'))
        self.assertEqual(self.run_it('compare', *logs), (0, 'identical\n0 events each, 9 bags each\n'))

    def test_recorders_alone_are_nothing_to_do(self):
        _, log = self.record('a', '--end-when-idle', nodes=RECORDERS)
        self.assertIn('idle', log.end['reason'])
        self.assertEqual(self.stamps('a', 'some.bag')['/ticks'][-1], 41 * SECOND)

    def test_a_bag_that_is_not_covered_labels_the_run(self):
        recorder = '<node pkg="rosbag" type="record" name="recorder" args="-O x {}"/>'
        for name, words, args, why in (
                ('a', ('--onlooker', '/recorder'), '/ticks', 'it looks on: as it was asked for'),
                ('b', (), '/ticks /rosout', 'it records /rosout, which goes past lockstep')):
            said, log = self.record(name, '--until', '5', *words, nodes=recorder.format(args))
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
        said, log = self.record('a', '--until', '8', nodes=killer + recorder, code=3)
        self.assertIn('  not covered: it was not closed', said)
        self.assertIn("the bag of '/recorder' is not covered: it was not closed", log.end['not_repeatable_because'])
        self.assertEqual(log.bags, {})
