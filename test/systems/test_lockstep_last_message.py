"""What a node sends before it leaves is heard, however it leaves and the run ends: in rospy, roscpp and a bag."""
import unittest

import rosbag
from own_folder import OwnPackage

RESULT = """#!/usr/bin/env python3
import os, sys
from os import _exit
import rospy
from std_msgs.msg import Float64, String
rospy.init_node('result')
result = rospy.Publisher('/result', String, queue_size=10)
rospy.sleep(0.5)
result.publish('first')
rospy.sleep(2.0)
ending = rospy.get_param('~ending')
if ending == 'hook':
    rospy.on_shutdown(lambda: result.publish('last'))
else:
    result.publish('last')
if ending == 'crash':
    raise ValueError('it breaks down')
elif ending == 'exit':
    sys.exit(0)
elif ending == 'at_once':
    os._exit(0)
elif ending == 'at_once_by_name':
    _exit(0)
elif ending == 'shutdown':
    rospy.signal_shutdown('done')
elif ending == 'stays':
    rospy.spin()
"""
HEARER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
def hear(message):
    print('heard', message.data, rospy.get_time(), flush=True)
    answers.publish(message)
rospy.init_node('hearer')
answers = rospy.Publisher('/answers', String, queue_size=10)
rospy.Subscriber('/result', String, hear)
rospy.spin()
"""
LAUNCH = """<launch>
  <node pkg="study_of_others" type="result.py" name="result" required="{required}">
    <param name="ending" value="{ending}"/>
  </node>
  <node pkg="study_of_others" type="hearer.py" name="hearer" output="screen"/>
  <node pkg="move_base_abstract" type="shim_listener" name="relay">
    <remap from="ticks" to="/result"/>
    <remap from="heard" to="/relayed"/>
  </node>
  <node pkg="rosbag" type="record" name="bag" args="-O {bag} /result /answers /relayed"/>
</launch>
"""
FIRST, LAST = 1_500_000_000, 3_500_000_000  # ns


class LastMessageTest(OwnPackage, unittest.TestCase):
    """A node publishes at 1.5 s and at 3.5 s, and leaves."""

    FILES = {'result.py': RESULT, 'hearer.py': HEARER}

    def _run(self, ending, *words, required=True, code=0):
        """Run the launch file; return (output, messages of the bag, the log's last record)."""
        bag = self.path(ending + '.bag')
        path = self.write(ending + '.launch', LAUNCH.format(
            required=str(required).lower(), ending=ending, bag=bag))
        said, log, _ = self.launch(ending + '.jsonl', '--log-messages', *words, path, code=code)
        with rosbag.Bag(bag) as recorded:
            heard = [(topic, message.data, time.to_nsec()) for topic, message, time in recorded.read_messages()]
        return said, heard, log.end

    def test_whoever_hears_it_hears_the_last_one_too(self):
        for ending in ('returns', 'hook', 'crash', 'exit', 'at_once', 'at_once_by_name', 'shutdown'):
            with self.subTest(ending=ending):
                said, heard, end = self._run(ending, code=3 if ending == 'crash' else 0)
                self.assertIn(('/result', 'last', LAST), heard)
                self.assertIn('heard last 3.5', said)
                self.assertEqual(end['at_ns'], LAST)
                self.assertEqual(end['ended_by'], 'departure')
                self.assertTrue(end['repeatable'], end)
                self.assertEqual({topic for topic, text, _ in heard if 'first' in text},
                                 {'/result', '/answers', '/relayed'})
                # What those who hear it send reaches nobody any more.
                self.assertEqual([topic for topic, text, _ in heard if 'last' in text], ['/result'])

    def test_with_a_lookahead_it_is_heard_when_it_arrives(self):
        said, heard, end = self._run('returns', '--lookahead', '0.05')
        self.assertIn('heard last 3.55', said)
        self.assertEqual([time for topic, text, time in heard if (topic, text) == ('/result', 'last')],
                         [LAST + 50_000_000])
        self.assertEqual(end['at_ns'], LAST)

    def test_at_the_end_of_time_as_well(self):
        said, heard, end = self._run('stays', '--until', '3.5', '--stored-topic', '/result', required=False)
        self.assertIn('heard last 3.5', said)
        self.assertIn(('/result', 'last', LAST), heard)
        self.assertEqual((end['ended_by'], end['at_ns']), ('end_at', LAST))
