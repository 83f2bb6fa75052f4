"""Messages that a fleet sends beforehand are those that it would send in its turns, at their instants, to the byte."""
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

from logged import ComparedRun
from scenarios import Condition, repeated
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
FOLLOWER = os.path.join(HERE, 'unmodified', 'feedback_follower.py')
GUARD = 120.0  # s, wall; only ends a run that would never end
RATES = {'feedback_freq': 20.0, 'pose_update_freq': 10.0, 'tf_heartbeat_freq': 10.0, 'max_speed': 1.0,
         'acceleration': 0.5}
#: a node that takes no part and prints the stamps [ns] of a robot's odometry
ONLOOKER = """
import rospy
from nav_msgs.msg import Odometry
rospy.init_node('onlooker')
rospy.Subscriber('/robot_1/odom', Odometry, lambda message: print(message.header.stamp.to_nsec(), flush=True))
rospy.spin()
"""


class Run(ComparedRun):
    """A run of followers and their fleet, with all messages in its log."""

    def __init__(self, condition=Condition(), foresee=True, followers=1, onlooker=False):
        folder = tempfile.mkdtemp(prefix='lockstep_foresight_')
        try:
            self._run(os.path.join(folder, 'events.jsonl'), condition, foresee, followers, onlooker)
        finally:
            shutil.rmtree(folder)

    def _run(self, log, condition, foresee, followers, onlooker):
        names = ['/follower_{}'.format(number) for number in range(followers)]
        with Loopback(is_warm=condition.is_warm) as ros:
            ros.run('time_master', 'time_master', parameters=dict(
                {'mode': 'lockstep', 'participants': ['/fleet', *names], 'event_log': log, 'log_messages': True},
                **condition.clock))
            ros.run('fleet', 'fleet', parameters={
                'foresee': foresee, 'defaults': RATES,
                'robots': [{'name': 'robot_{}'.format(i), 'start_y': 2.0 * i} for i in range(3)]})
            watching = ros.spawn('/onlooker', [sys.executable, '-c', ONLOOKER]) if onlooker else None
            children = [subprocess.Popen([find_executable('lockstep'), FOLLOWER, '__name:=' + name[1:]],
                                         env=ros.environment, stdout=subprocess.PIPE, universal_newlines=True)
                        for name in names]
            guard = threading.Timer(GUARD, lambda: [child.kill() for child in children])
            guard.start()
            with condition.around():
                self.said = [child.communicate()[0] for child in children]
            guard.cancel()
            if any(child.returncode for child in children):
                raise AssertionError('a follower ended with {}'.format([child.returncode for child in children]))
            ros.check()
            if watching:
                with open(watching.log_path) as stream:
                    self.watched = [int(line) for line in stream if line.strip().isdigit()]
        self.read_log(log)


class Foresight(unittest.TestCase):
    """Each test compares with one run in which the fleet gets a grant for each of its turns."""

    @classmethod
    def setUpClass(cls):
        cls.plain = Run(foresee=False)

    def test_the_plain_run_has_all_that_can_be_foreseen_and_what_takes_it_back(self):
        topics = [robot for _, robot, kind, _ in self.plain.events if kind == 'message']
        for topic in ('/robot_0/move_base/feedback', '/robot_2/odom', '/tf'):
            self.assertGreater(topics.count(topic), 200, topic)
        self.assertGreater(self.plain.said[0].count('PREEMPTED'), 3, self.plain.said)
        self.assertEqual(self.plain.end['not_repeatable_because'], [])

    def test_every_message_is_the_same(self):
        for run in repeated('feedback followers', Run, lambda run: repr((run.said, run.events)).encode()):
            run.assert_same(self, self.plain)
            self.assertEqual(run.end['not_repeatable_because'], [])

    def test_an_onlooker_hears_all_at_its_instant_and_changes_nothing(self):
        run = Run(Condition(speed_limit=20.0), onlooker=True)
        run.assert_same(self, self.plain)
        self.assertGreater(len(run.watched), 50)
        self.assertEqual(run.watched, sorted(run.watched))
