"""Shared by the tests of robots and of the time master: recorded topics, stock clients and raw goals.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""
import itertools
import math
import threading
import time
import xmlrpc.client

import actionlib
import nav_msgs.srv
import rosgraph
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped, Quaternion, TransformStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionGoal, MoveBaseActionResult, MoveBaseGoal
from rosgraph_msgs.msg import Log
from rospy.impl.registration import get_topic_manager
from waiting import GUARD, wait_for

from move_base_abstract_ros.messages import conversions

SPEED = 2.0  # m/s, as in the .test files
ACCEPTED = 'This goal has been accepted by the simple action server'
ANOTHER_GOAL = 'This goal was canceled because another goal was received by the simple action server'
BAD_QUATERNION = 'Aborting on goal because it was sent with an invalid quaternion'
REACHED = (GoalStatus.SUCCEEDED, 'Goal reached.')
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'

LoadMap = getattr(nav_msgs.srv, 'LoadMap', None)  # Debian 11's nav_msgs has none

_ids = itertools.count(1)


class Record:
    """Keeps all messages of a topic in the order of their arrival, and waits for one of them."""

    def __init__(self, topic, kind):
        self.topic = topic
        self._messages = []
        self._changed = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, kind, self._add, queue_size=10000)

    @classmethod
    def fresh(cls, topic, kind):
        """Return a record that begins now and that all publishers know.

        It gets no message that was published earlier, except a latched one. Nothing else in this process may listen to
        ``topic``, since rospy would share that connection, with all messages under way on it.
        """
        assert not get_topic_manager().has_subscription(topic), '{} has a subscriber already'.format(topic)
        before = _connections(topic)
        record = cls(topic, kind)
        wait_for('a connection of ' + topic,
                 lambda: len({node for node, _ in _connections(topic) - before}) >= len(_publishers(topic)))
        return record

    def close(self):
        """Unsubscribe."""
        self._subscriber.unregister()

    def _add(self, message):
        with self._changed:
            self._messages.append(message)
            self._changed.notify_all()

    @property
    def messages(self):
        """The messages so far."""
        with self._changed:
            return list(self._messages)

    def clear(self):
        """Forget the messages so far."""
        with self._changed:
            self._messages.clear()

    def wait_for(self, wanted=lambda message: True, what='what was waited for', since=0):
        """Return the first message after the first ``since`` ones for which ``wanted`` is true."""
        deadline = time.monotonic() + GUARD
        seen = since
        with self._changed:
            while True:
                for message in self._messages[seen:]:
                    if wanted(message):
                        return message
                seen = max(since, len(self._messages))
                left = deadline - time.monotonic()
                if left <= 0.0 or rospy.is_shutdown():
                    raise AssertionError('{}: {} did not come within {} s; got {} messages, the last: '
                                         '{}'.format(self.topic, what, GUARD, len(self._messages), self._messages[-1:]))
                self._changed.wait(left)


def warned(log, *words):
    """Return the text of the first warning with all ``words`` in ``log``, a Record of /rosout."""
    return log.wait_for(lambda entry: entry.level == Log.WARN and all(word in entry.msg for word in words)).msg


def _publishers(topic):
    """Return the names of the nodes that publish ``topic``."""
    published = rosgraph.Master(rospy.get_name()).getSystemState()[0]
    return [node for name, nodes in published if name == topic for node in nodes]


def _connections(topic):
    """Return {(publisher, number)} of the connections of ``topic`` to this node, as its publishers see them."""
    master = rosgraph.Master(rospy.get_name())
    return {(node, number) for node in _publishers(topic)
            for number, other, direction, _, name, *_ in
            xmlrpc.client.ServerProxy(master.lookupNode(node)).getBusInfo(rospy.get_name())[2]
            if (other, direction, name) == (rospy.get_name(), 'o', topic)}


def pose_stamped(x=0.0, y=0.0, yaw=0.0, frame='map', stamp=None, quaternion=None):
    """Return a PoseStamped; ``quaternion`` (x, y, z, w) instead of ``yaw`` if given."""
    pose = PoseStamped()
    pose.header.frame_id = frame
    pose.header.stamp = stamp or rospy.Time()
    pose.pose.position.x, pose.pose.position.y = x, y
    pose.pose.orientation = Quaternion(*(quaternion or (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))))
    return pose


class RawClient:
    """Sends goals and cancels on the topics of the action, and keeps all answers."""

    def __init__(self, ns='/'):
        prefix = ns.rstrip('/') + '/move_base/'
        self.status = Record(prefix + 'status', GoalStatusArray)
        self.result = Record(prefix + 'result', MoveBaseActionResult)
        self._goal = rospy.Publisher(prefix + 'goal', MoveBaseActionGoal, queue_size=100)
        self._cancel = rospy.Publisher(prefix + 'cancel', GoalID, queue_size=100)
        self.status.wait_for()
        wait_for('a server at ' + prefix,
                 lambda: self._goal.get_num_connections() and self._cancel.get_num_connections())

    def send(self, pose, goal_id=None, stamp=None):
        """Send ``pose`` (PoseStamped) and return the goal's id; '' leaves the id to the server."""
        if goal_id is None:
            goal_id = 'goal_{}'.format(next(_ids))
        goal = MoveBaseActionGoal(goal_id=GoalID(stamp or rospy.Time(), goal_id), goal=MoveBaseGoal(pose))
        self._goal.publish(goal)
        return goal_id

    def cancel(self, goal_id='', stamp=None):
        """Publish a cancel with this id and stamp; without both, it cancels all goals."""
        self._cancel.publish(GoalID(stamp or rospy.Time(), goal_id))

    def ending(self, goal_id):
        """Wait for the result of ``goal_id`` and return its message."""
        return self.result.wait_for(lambda message: message.status.goal_id.id == goal_id)

    def drive(self, pose, goal_id=None):
        """Send ``pose`` and wait for its end; return ((state, text), how long it was active [ns])."""
        goal_id = self.send(pose, goal_id)
        start_ns = active_since_ns(self, goal_id)
        ended = self.ending(goal_id)
        return (ended.status.status, ended.status.text), ended.header.stamp.to_nsec() - start_ns

    def endings(self, goal_id):
        """Return [(status, text)] of all results of ``goal_id`` so far."""
        return [(message.status.status, message.status.text) for message in self.result.messages
                if message.status.goal_id.id == goal_id]

    def wait_for_state(self, goal_id, state):
        """Wait until the status topic shows ``goal_id`` in ``state``; return (array, its entry)."""
        def entry(array):
            return [status for status in array.status_list
                    if status.goal_id.id == goal_id and status.status == state]
        array = self.status.wait_for(entry)
        return array, entry(array)[0]

    def states(self, goal_id):
        """Return the states of ``goal_id`` on the status topic, without repetitions."""
        shown = [status.status for array in self.status.messages for status in array.status_list
                 if status.goal_id.id == goal_id]
        return [state for state, _ in itertools.groupby(shown)]


def simple_client(ns='/', action='move_base'):
    """Return a stock SimpleActionClient that is connected."""
    client = actionlib.SimpleActionClient('{}/{}'.format(ns.rstrip('/'), action), MoveBaseAction)
    assert client.wait_for_server(rospy.Duration(10000.0)), 'no action server'
    return client


def go(client, pose):
    """Send ``pose`` by a stock client, wait for its end, return (state, text)."""
    client.send_goal(MoveBaseGoal(pose))
    assert client.wait_for_result(rospy.Duration(10000.0)), 'the goal did not end'
    return client.get_state(), client.get_goal_status_text()


def active_since_ns(client, goal_id):
    """Return the time at which ``goal_id`` became active [ns]: the stamp of the first status that shows it."""
    array, _ = client.wait_for_state(goal_id, GoalStatus.ACTIVE)
    return array.header.stamp.to_nsec()


def to_transform(pose, parent, child, stamp_ns):
    """Return the transform by which frame ``child`` stands at ``pose`` in frame ``parent``."""
    transform = TransformStamped(header=conversions.to_header(parent, stamp_ns), child_frame_id=child)
    placed = conversions.to_pose(pose)
    for axis in 'xyz':
        setattr(transform.transform.translation, axis, getattr(placed.position, axis))
    transform.transform.rotation = placed.orientation
    return transform
