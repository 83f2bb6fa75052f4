"""What the time master plays is what a fleet would send in its turns, at their instants, to the byte."""
import os
import sys
import unittest

from in_lockstep import InLockstep, assert_same
from night import times
from scenarios import Condition, repeated
from waiting import read

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
FOLLOWER = os.path.join(HERE, 'unmodified', 'feedback_follower.py')
BUSYBODY = os.path.join(HERE, 'busybody.py')
RATES = {'feedback_freq': 20.0, 'pose_update_freq': 10.0, 'tf_heartbeat_freq': 10.0, 'max_speed': 1.0,
         'acceleration': 0.5}
#: periodic output that follows from more than the instant and the motion, some of it of robots whose poses are wrong
MORE = {'scan_rate': 7.0, 'scan_beams': 20, 'scan_noise': 0.02, 'battery_capacity': 10.0, 'battery_state_freq': 3.0,
        'buggify': {'jump': 0.5, 'mute': 0.2}}
TOPICS = ['/diagnostics', *('/robot_{}/{}'.format(i, topic) for i in range(3) for topic in (
    'scan', 'battery_state', 'amcl_pose', 'base_pose_ground_truth', 'move_base/local_costmap/costmap',
    'move_base/local_costmap/footprint'))]
#: a node that takes no part and prints the stamps [ns] of a robot's odometry
ONLOOKER = """
import rospy
from nav_msgs.msg import Odometry
rospy.init_node('onlooker')
rospy.Subscriber('/robot_1/odom', Odometry, lambda message: print(message.header.stamp.to_nsec(), flush=True))
rospy.spin()
"""


def run_once(condition=Condition(), plays=True, followers=1, onlooker=False, more=False):
    """Return a run of followers and their fleet, with all messages in its log, what they ``said``, and ``watched``."""
    names = ['/follower_{}'.format(number) for number in range(followers)]
    with InLockstep(['/fleet', *names], condition, log_messages=True, chaos_seed=5 if more else 0) as run:
        run.ros.run('fleet', 'fleet', parameters={
            'play_output': plays, 'defaults': {**RATES, **(MORE if more else {})},
            'robots': [{'name': 'robot_{}'.format(i), 'start_y': 2.0 * i} for i in range(3)]})
        watching = run.ros.spawn('/onlooker', [sys.executable, '-c', ONLOOKER]) if onlooker else None
        children = [run.ros.spawn(name, [find_executable('lockstep'), FOLLOWER, '__name:=' + name[1:],
                                           '_more:={}'.format(TOPICS if more else [])])
                    for name in names]
        with condition.around():
            run.said = run.end_of(*children)
        run.watched = [int(line) for line in read(watching).splitlines() if line.isdigit()] if watching else []
    return run


class Played(unittest.TestCase):
    """Each test compares with one run in which the fleet gets a grant for each of its turns."""

    @classmethod
    def setUpClass(cls):
        cls.plain = run_once(plays=False)

    def assert_same(self, run):
        self.assertEqual(run.said, self.plain.said)
        assert_same(self, self.plain.events, run.events)

    def test_the_plain_run_has_all_that_can_be_played_and_what_ends_it(self):
        topics = [robot for _, robot, kind, _ in self.plain.events if kind == 'message']
        for topic in ('/robot_0/move_base/feedback', '/robot_2/odom', '/tf'):
            self.assertGreater(topics.count(topic), 200, topic)
        self.assertGreater(self.plain.said[0].count('PREEMPTED'), 3, self.plain.said)
        self.assertEqual(self.plain.end['not_repeatable_because'], [])

    def test_every_message_is_the_same(self):
        for run in repeated('feedback followers', run_once, lambda run: repr((run.said, run.events)).encode()):
            self.assert_same(run)
            self.assertEqual(run.end['not_repeatable_because'], [])

    def test_an_onlooker_hears_all_at_its_instant_and_changes_nothing(self):
        run = run_once(Condition(speed_limit=20.0), onlooker=True)
        self.assert_same(run)
        self.assertGreater(len(run.watched), 50)
        self.assertEqual(run.watched, sorted(run.watched))

    def test_scans_batteries_costmaps_diagnostics_and_wrong_poses_are_the_same(self):
        plain, run = (run_once(plays=plays, more=True) for plays in (False, True))
        for topic in TOPICS:
            self.assertGreater(sum(row[1:3] == (topic, 'message') for row in plain.events), 10, topic)
        for lapse in ('jump', 'mute'):
            self.assertIn(lapse, [row[3][0] for row in plain.events if row[2] == 'lapse_began'])
        self.assertEqual(run.said, plain.said)
        assert_same(self, plain.events, run.events)

#: a node that takes no part, and lets time go on in steps at first
STEPPER = """
import rospy
from move_base_abstract_ros.time_master_client import TimeMasterClient
rospy.init_node('stepper')
master = TimeMasterClient()
for number in range(12):
    master.wait_until(master.step(0.15 + 0.07 * (number % 5)))
master.resume()
rospy.spin()
"""
#: {how a run goes on: parameters of the time master, and of the second fleet}
EVENTFUL = {
    'in steps': ({'start_paused': True}, {}),
    'with a lookahead': ({'lookahead': 0.08}, {}),
    'with chaos, over a radio, charged, and up to an end': (
        {'chaos_seed': 3, 'chaos_delay': 0.1, 'end_at': 12.3456, 'network': [
            'seed 1', 'host robot_* robot /robot_*/**', 'host base at 0.0 0.0 /busybody',
            'link base robot_* delay 1000000 50000000 loss 0.1 lost drop']}, {'lockstep_charge': 'fixed:0.01'})}


def run_eventful(plays, seed, clock, of_second):
    """Return a run of two fleets and a busybody, with all messages in its log, and what the busybody ``said``."""
    fleets = ['fleet_0', 'fleet_1']
    with InLockstep(['/busybody', *fleets], log_messages=True, **clock) as run:
        for part, (name, own) in enumerate(zip(fleets, ({}, of_second))):
            run.ros.run('fleet', name, parameters={
                'play_output': plays, 'part': part, 'parts': len(fleets), **own,
                'defaults': {**RATES, 'buggify': {'stop': 0.2, 'jump': 0.3, 'mute': 0.2}},
                'robots': [{'name': 'robot_{}'.format(number), 'start_y': 2.0 * number} for number in range(4)]})
        if 'start_paused' in clock:
            run.ros.spawn('/stepper', [sys.executable, '-c', STEPPER])
        run.said, = run.end_of(run.ros.spawn('/busybody', [
            find_executable('lockstep'), BUSYBODY, str(seed), '__name:=busybody']))
    return run


class Eventful(unittest.TestCase):
    """What begins, ends and changes within a stretch: each run has the messages of the one that plays nothing."""

    def test_whatever_happens_every_message_is_the_same(self):
        for seed in range(times(1, 5)):
            for name, (clock, of_second) in EVENTFUL.items():
                with self.subTest(name, seed=seed):
                    plain, played = (run_eventful(plays, seed, clock, of_second) for plays in (False, True))
                    self.assertEqual(played.said, plain.said)
                    assert_same(self, plain.events, played.events)
                    self.assertEqual(played.end, plain.end)
                    self.assertEqual(played.end['not_repeatable_because'], [])
                    kinds = [kind for _, _, kind, _ in played.events]
                    self.assertEqual(kinds.count('uncaught'), 0, played.events)
                    self.assertGreater(kinds.count('message'), 200)
