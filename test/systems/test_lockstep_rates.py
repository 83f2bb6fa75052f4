"""In lockstep robots publish what upstream's would, at its rates; a message without subscribers is no event."""
import os
import sys
import types
import unittest

import tf2_ros
from in_lockstep import InLockstep, assert_same
from waiting import read, wait_for_words

from move_base_abstract.lockstep.wire import Delivery
from move_base_abstract_ros.lockstep.exchange.delivery import Deliveries
from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
LISTENER = os.path.join(HERE, 'unmodified', 'late_listener.py')
#: a node that takes no part, and listens to all topics of the robots
ONLOOKER = """
import sys
import time
import xmlrpc.client
import rosgraph
import rospy
from rospy import AnyMsg
from std_srvs.srv import Trigger
from move_base_abstract.msg import TimeState
from move_base_abstract.srv import RunUntil
rospy.init_node('onlooker')
def say(*words):
    sys.stdout.write(' '.join(map(str, words)) + '\\n')  # at once: callbacks run in several threads
def hear(topic, callback=lambda message: say(message._connection_header['topic'])):
    return rospy.Subscriber(topic, AnyMsg, callback)
def state_when(phase, seconds=0):
    while True:
        state = rospy.wait_for_message('/time_master/state', TimeState)
        if state.phase == phase and state.sim_time.secs >= seconds:
            return state
state_when('paused')  # all is advertised
heard = [hear('/%s/%s' % (robot, topic)) for robot in ('robot_0', 'robot_1')
         for topic in ('odom', 'amcl_pose', 'robot_pose', 'move_base/feedback', 'move_base/status')]
heard.append(hear('/tf', lambda message: None))
fleet = xmlrpc.client.ServerProxy(rosgraph.Master('/onlooker').lookupNode('/fleet'))
while not {one.resolved_name for one in heard} <= {
        topic for _, node, _, _, topic, *_ in fleet.getBusInfo('/onlooker')[2] if node == '/onlooker'}:
    time.sleep(0.02)  # it is the fleet that must have taken the connections
rospy.ServiceProxy('/time_master/run_until', RunUntil)(rospy.Time(12))
for one in state_when('paused', 12).participants:
    say('tells', one.name, one.tells)
rospy.ServiceProxy('/time_master/resume', Trigger)()
say('idle at', state_when('idle', 13).sim_time)
rospy.spin()
"""

#: a node that hears a battery for a while
SHORT = """
import rospy
rospy.init_node('listener')
heard = rospy.Subscriber('/robot_0/battery_state', rospy.AnyMsg, lambda message: None)
rospy.sleep(3.0)
"""


def run_once(onlooker=False, **parameters):
    """Return a run of the listener and its fleet, with all messages in its log, what it ``said``, and ``watched``."""
    with InLockstep(['/fleet', '/listener'], log_messages=True, start_paused=onlooker) as run:
        run.ros.run('fleet', 'fleet', parameters=dict(
            {'defaults': {'max_speed': 1.0}, 'robots': [{'name': 'robot_0'}, {'name': 'robot_1'}]}, **parameters))
        watching = run.ros.spawn('/onlooker', [sys.executable, '-u', '-c', ONLOOKER]) if onlooker else None
        run.said, = run.end_of(run.ros.spawn('/listener', [find_executable('lockstep'), LISTENER, '__name:=listener']))
        if watching:
            wait_for_words(watching, 'idle at')
            run.watched = read(watching)
    return run


def stamps(run, what):
    """Return the stamps [ns] of the listener's lines about ``what``."""
    return [int(words[2]) for words in map(str.split, run.said.splitlines()) if words[1] == what]


class Rates(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.plain = run_once()

    def assert_same(self, run):
        self.assertEqual(run.said, self.plain.said)
        assert_same(self, self.plain.events, run.events)
        self.assertEqual(run.end['not_repeatable_because'], [])

    def count(self, topic, run=None):
        return [robot for _, robot, kind, _ in (run or self.plain).events if kind == 'message'].count(topic)

    def test_poses_come_at_their_rate_from_the_moment_somebody_listens(self):
        present, *first = [stamp for stamp in stamps(self.plain, '/robot_1/odom') if stamp < 3_900_000_000]
        self.assertEqual(present, 3_350_000_000)
        # robot_1 departs at 1 s or a little later, when its goal comes; its poses are on multiples from then on
        self.assertEqual({stamp - first[0] for stamp in first}, {k * 100_000_000 for k in range(5)})
        self.assertLessEqual(first[0], 3_450_000_000)
        self.assertGreater(first[0], 3_350_000_000)
        self.assertEqual(self.plain.said.count('/robot_1/odom'), self.plain.said.count('/robot_1/amcl_pose'))

    def test_tf_and_status_come_at_their_rates(self):
        self.assertGreater(self.plain.said.count('tf robot_1/base_link'), 15)
        status = stamps(self.plain, 'status')
        self.assertIn(200_000_000, {later - stamp for stamp, later in zip(status, status[1:])})

    def test_feedback_comes_to_those_who_ask_for_it_and_to_nobody_else(self):
        heard = self.plain.said.count('feedback')
        self.assertEqual(heard, 1 + 20 * 9 + 5)  # 9.25 m at 1 m/s: at the start, at 20 Hz, and at the goal
        self.assertEqual(self.count('/robot_0/move_base/feedback'), heard)
        self.assertEqual(self.count('/robot_1/move_base/feedback'), 0)

    def test_what_nobody_hears_has_no_instant(self):
        between = [time_ns for time_ns, *_ in self.plain.events if 3_900_000_000 < time_ns < 5_990_000_000]
        self.assertEqual(between, [])  # an action client gets changes, and no repeated status

    def test_an_onlooker_hears_all_and_changes_nothing(self):
        run = run_once(onlooker=True)
        self.assert_same(run)
        for topic in ('/robot_0/odom', '/robot_1/move_base/feedback'):
            self.assertGreater(run.watched.split().count(topic), 40, topic)
        self.assertIn('tells /fleet poses at 10 Hz to /onlooker; tf at 10 Hz to /onlooker; feedback at 20 Hz to '
                      '/listener, /onlooker; status at 5 Hz to /onlooker\n', run.watched)
        self.assertIn('tells /listener \n', run.watched)
        # time does not go on for an onlooker alone
        last_ns = run.events[-1][0]
        self.assertIn('idle at {}\n'.format(last_ns), run.watched)

    def test_without_played_output_all_is_the_same(self):
        self.assert_same(run_once(play_output=False))

    def test_when_the_last_listener_has_gone_time_does_not_go_on_for_batteries(self):
        for plays in (True, False):
            with InLockstep(['/fleet', '/listener']) as run:
                run.ros.run('fleet', 'fleet', parameters={'play_output': plays, 'robots': [
                    {'name': 'robot_0', 'battery_capacity': 10.0, 'battery_state_freq': 1.0}]})
                script = os.path.join(run.ros.log_dir, 'listener.py')
                with open(script, 'w') as file:
                    file.write(SHORT)
                run.end_of(run.ros.spawn('/listener', [find_executable('lockstep'), script]))
            self.assertEqual([kind for _, _, kind, _ in run.events if kind == 'battery'], [], plays)

    def test_one_word_leaves_events_only_and_names_who_listens_in_vain(self):
        run = run_once(events_only=True)
        self.assertEqual(run.end['not_repeatable_because'], [])
        self.assertEqual(self.count('/robot_0/move_base/feedback', run), 0)
        self.assertLessEqual(len(stamps(run, '/robot_1/odom')), 4)
        self.assertEqual(run.end['degraded_because'], [])
        told = [(robot, values) for _, robot, kind, values in run.events if kind == 'listens_in_vain']
        self.assertIn(('robot_0', ['/listener', '/robot_0/move_base/feedback', 'feedback_freq']), told)


class Nothing:
    """A stand-in for a subscription."""

    def unregister(self):
        """Do nothing."""


def listener(of=tf2_ros.TransformListener, buffer=tf2_ros.Buffer):
    """Return a listener of tf2 of these classes without subscriptions, which would need a node."""
    made = of.__new__(of)
    made.buffer, made.tf_sub, made.tf_static_sub = buffer.__new__(buffer), Nothing(), Nothing()
    return made


def chosen(*callbacks):
    """Return what the time master hears about a subscription that gets these callbacks one after the other."""
    told, subscription = [], types.SimpleNamespace(closed=False, callbacks=[])
    deliveries = Deliveries(types.SimpleNamespace(choose=lambda _subscription, what: told.append(what)))
    for callback in callbacks:
        subscription.callbacks = subscription.callbacks + [(callback, None)]
        deliveries._look_at(subscription)
    return told


class ListenersOfTf(unittest.TestCase):

    def test_they_put_transforms_by(self):
        self.assertEqual(chosen(listener().callback), [Delivery.LATER])
        self.assertEqual(chosen(listener().static_callback, listener().callback), [Delivery.LATER])

    def test_whoever_else_subscribes_hears_them_at_once(self):
        self.assertEqual(chosen(listener().callback, print), [Delivery.LATER, Delivery.ALL])
        self.assertEqual(chosen(print, listener().callback), [])

    def test_what_is_not_quite_tf2s_may_do_more(self):
        class OwnBuffer(tf2_ros.Buffer):
            def set_transform(self, transform, authority):
                print(transform, authority)

        class OwnListener(tf2_ros.TransformListener):
            def callback(self, data):
                print(data)

        changed = listener()
        changed.buffer.set_transform = print
        for one in (listener(buffer=OwnBuffer), listener(OwnListener), changed):
            self.assertEqual(chosen(one.callback), [])
