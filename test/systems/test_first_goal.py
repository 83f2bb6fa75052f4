"""If a client starts before the server, no goal is lost, since the server connects to the client only once.

rospy drops a connection to a publisher when it makes a second one, with all messages on it. It makes a second one if it
hears of another publisher of the topic (its own node, for example) while it makes the first one.
"""
import os
import tempfile
import threading
import unittest
import xmlrpc.client

import rosgraph
import rospy
import warm
from actionlib_msgs.msg import GoalID, GoalStatus
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from master_proxy import MasterProxy
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult, MoveBaseGoal
from robot_harness import GUARD, RawClient, Record, pose_stamped
from rospy.impl.registration import get_registration_listeners
from waiting import wait_for

from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = '<launch></launch>'
FACTOR = 20
OWN_NODE = 'first_goal_test'


class SlowClient:
    """The publishers of a client in this process; requests for a connection wait until ``release`` is set."""

    def __init__(self, topics):
        self._handler = get_registration_listeners().listeners[0].handler
        self._request_topic = self._handler.requestTopic
        self.calls = dict.fromkeys(topics, 0)
        self.release = threading.Event()
        self._handler.requestTopic = self._answer

    def _answer(self, caller_id, topic, protocols):
        if topic in self.calls:
            self.calls[topic] += 1
            self.release.wait(GUARD)
        return self._request_topic(caller_id, topic, protocols)

    def close(self):
        """Answer all requests at once."""
        self.release.set()
        self._handler.requestTopic = self._request_topic


def is_up(node, topic):
    """Return whether the ROS master lists ``node`` as a subscriber of ``topic``."""
    return node in dict(rosgraph.Master(rospy.get_name()).getSystemState()[1]).get(topic, ())


class FirstGoal(unittest.TestCase):
    def start(self, executable, name, parameters, uri=None):
        """Start a node that is ended with the test."""
        rospy.set_param(name, parameters)
        namespace, own = name.rsplit('/', 1)
        with tempfile.NamedTemporaryFile(suffix='.out', delete=False) as output:
            process = warm.start([find_executable(executable), '__ns:=' + (namespace or '/'), '__name:=' + own], output,
                                 dict(os.environ, ROS_MASTER_URI=uri or rosgraph.get_master_uri()))

        def end():
            process.terminate()
            process.wait(GUARD)
            process.release()
        self.addCleanup(end)

    def test_every_server_advertises_a_topic_before_it_listens_to_it(self):
        robots = {'robots': [{'name': 'a0'}, {'name': 'a1'}]}
        for executable, name, parameters, last in (
                ('move_base', '/o1/move_base', {}, '/o1/move_base_simple/goal'),
                ('move_base_abstract_actionserver', '/o2/server', {}, '/o2/move_base_simple/goal'),
                ('fleet', '/o3/fleet', robots, '/o3/a1/move_base_simple/goal'),
                ('task_server', '/o4/tasks', {'robots': ['']}, '/o4/work/goal')):
            proxy = MasterProxy(rosgraph.get_master_uri())
            self.addCleanup(proxy.close)
            self.start(executable, name, parameters, proxy.uri)
            wait_for('{} at {}'.format(name, last), lambda last=last, name=name: is_up(name, last))
            heard = set()
            for method, params in list(proxy.calls):
                topic = params[1] if len(params) > 1 else ''
                if method == 'registerSubscriber':
                    heard.add(topic)
                elif method == 'registerPublisher':
                    self.assertNotIn(topic, heard, '{} advertises it after it has subscribed'.format(executable))
            self.assertIn(last, heard)

    def first_goal(self, executable, node_name, parameters, robot):
        """Start a server before the client answers, announce the client again and again; the first goal must arrive."""
        topics = [robot + '/move_base/goal', robot + '/move_base/cancel']
        client = SlowClient(topics)
        self.addCleanup(client.close)
        result = Record(robot + '/move_base/result', MoveBaseActionResult)
        publishers = [rospy.Publisher(topics[0], MoveBaseActionGoal, queue_size=10),
                      rospy.Publisher(topics[1], GoalID, queue_size=10)]
        self.start(executable, node_name, parameters)
        wait_for('that the server asks for the client', lambda: all(client.calls.values()))
        wait_for('the server is up', lambda: is_up(node_name, robot + '/move_base_simple/goal'))
        node = xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(node_name))
        for other, kind in (('initialpose', PoseWithCovarianceStamped), ('set_pose', Pose),
                            ('move_base_simple/goal', PoseStamped)):
            for topic in topics:
                node.publisherUpdate('/master', topic, [rospy.get_node_uri()])
            # The server's rospy handles updates one by one, so it has handled the two above when this one is connected.
            publishers.append(rospy.Publisher(robot + '/' + other, kind, queue_size=1))
            wait_for(other, publishers[-1].get_num_connections)
        self.assertEqual(client.calls, dict.fromkeys(topics, 1), 'a second connection is being made')
        client.release.set()
        wait_for('a connection', lambda: all(publisher.get_num_connections() for publisher in publishers))
        publishers[0].publish(MoveBaseActionGoal(goal=MoveBaseGoal(pose_stamped(1.0))))
        self.assertEqual(result.wait_for().status.status, GoalStatus.SUCCEEDED)

    def test_a_robots_first_goal(self):
        self.first_goal('move_base', '/f1/move_base', {'max_speed': 100.0}, '/f1')

    def test_the_first_goal_of_a_robot_of_a_fleet(self):
        self.first_goal('fleet', '/f2/fleet', {'robots': [{'name': 'a0', 'max_speed': 100.0}]}, '/f2/a0')

    def test_in_a_fleet_a_goal_of_rviz_arrives_and_others_see_it(self):
        """A robot of a fleet publishes on its own goal topic, and is not connected to itself."""
        self.start('fleet', '/f3/fleet', {'robots': [{'name': 'a0', 'max_speed': 100.0}]})
        client = RawClient('/f3/a0')
        seen = Record.fresh('/f3/a0/move_base/goal', MoveBaseActionGoal)
        publisher = rospy.Publisher('/f3/a0/move_base_simple/goal', PoseStamped, queue_size=1)
        wait_for('a connection', publisher.get_num_connections)
        publisher.publish(pose_stamped(1.0))
        self.assertEqual(client.result.wait_for().status.status, GoalStatus.SUCCEEDED)
        self.assertEqual(seen.wait_for().goal.target_pose.pose.position.x, 1.0)
        self.assertEqual(len(client.result.messages), 1)
        node = xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode('/f3/fleet'))
        own_uri = rosgraph.Master(rospy.get_name()).lookupNode('/f3/fleet')
        self.assertEqual([topic for _, other, _, _, topic, *_ in node.getBusInfo(rospy.get_name())[2]
                          if other in ('/f3/fleet', own_uri)], [])
