"""A lean action client for robots: one callback when a goal ends, nothing else.

It listens to results only. actionlib's clients also follow status and feedback, which costs each of them a message per
transition; in lockstep, a round.
"""
import itertools

import rospy
from actionlib_msgs.msg import GoalID
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult

from move_base_abstract.geometry import quaternion_of_yaw


class GoalClient:
    """Sends goals to the robot ``name`` (its namespace).

    ``on_end(client, goal_id, status, text)`` is called for the ends of this client's goals; ``status`` is that of
    actionlib_msgs/GoalStatus.
    """

    def __init__(self, name, on_end):
        self.name = name
        self._on_end = on_end
        self._numbers = itertools.count(1)
        self._open = {}
        prefix = '/{}/move_base/'.format(name.strip('/'))
        self._goal = rospy.Publisher(prefix + 'goal', MoveBaseActionGoal, queue_size=10, tcp_nodelay=True)
        self._cancel = rospy.Publisher(prefix + 'cancel', GoalID, queue_size=10, tcp_nodelay=True)
        self._result = rospy.Subscriber(prefix + 'result', MoveBaseActionResult, self._on_result, tcp_nodelay=True)

    def is_connected(self):
        """Return whether there is a server; goals sent before are lost."""
        return bool(self._goal.get_num_connections() and self._cancel.get_num_connections()
                    and self._result.get_num_connections())

    def send(self, x, y, yaw=0.0, frame='map'):
        """Send a goal [m, rad, in ``frame``]; return its id."""
        goal_id = '{}-{}-{}'.format(rospy.get_name(), self.name, next(self._numbers))
        goal = MoveBaseActionGoal()
        goal.goal_id.id = goal_id
        goal.goal_id.stamp = goal.header.stamp = rospy.Time.now()
        pose = goal.goal.target_pose
        pose.header.frame_id = frame
        pose.pose.position.x, pose.pose.position.y = x, y
        orientation = pose.pose.orientation
        orientation.x, orientation.y, orientation.z, orientation.w = quaternion_of_yaw(yaw)
        self._open[goal_id] = True
        self._goal.publish(goal)
        return goal_id

    def cancel(self, goal_id):
        """Ask for the end of a goal."""
        self._cancel.publish(GoalID(id=goal_id))

    def close(self):
        """Leave the graph."""
        for topic in (self._goal, self._cancel, self._result):
            topic.unregister()

    def _on_result(self, message):
        if self._open.pop(message.status.goal_id.id, False):
            self._on_end(self, message.status.goal_id.id, message.status.status, message.status.text)
