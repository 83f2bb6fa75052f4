"""A lean action client for robots: it calls back when a goal ends, and does nothing else.

It listens only to results. The clients of actionlib also follow status and feedback. This costs a message for each
transition, and in lockstep a round.
"""
from __future__ import annotations

import itertools
from typing import Any, Dict

import rospy
from actionlib_msgs.msg import GoalID
from move_base_msgs.msg import MoveBaseActionGoal

from .messages import packing
from .messages.outlets import Outlet
from .messages.unpacking import ResultIn


class GoalClient:
    """Sends goals to the robot ``name`` (its namespace).

    ``on_end(client, goal_id, status, text)`` is called when a goal of this client ends. ``status`` is a constant of
    actionlib_msgs/GoalStatus.
    """

    def __init__(self, name: str, on_end: Any) -> None:
        self.name = name
        self._on_end = on_end
        self._numbers = itertools.count(1)
        self._open: Dict[Any, Any] = {}
        prefix = '/{}/move_base/'.format(name.strip('/'))
        self._frames: Dict[Any, Any] = {}
        self._goal = Outlet(prefix + 'goal', MoveBaseActionGoal, queue_size=10, tcp_nodelay=True)
        self._cancel = rospy.Publisher(prefix + 'cancel', GoalID, queue_size=10, tcp_nodelay=True)
        self._result = rospy.Subscriber(prefix + 'result', ResultIn, self._on_result, tcp_nodelay=True)

    def is_connected(self) -> bool:
        """Return whether the client is connected to the robot's server. Goals that are sent before are lost."""
        return bool(self._goal.is_heard() and self._cancel.get_num_connections()
                    and self._result.get_num_connections())

    def send(self, x: float, y: float, yaw: float = 0.0, frame: str = 'map') -> Any:
        """Send a goal, a pose in ``frame``: ``x``, ``y`` [m], ``yaw`` [rad]; return the id of the goal, a text."""
        goal_id = '{}-{}-{}'.format(rospy.get_name(), self.name, next(self._numbers))
        now_ns = rospy.get_rostime().to_nsec()
        if frame not in self._frames:
            self._frames[frame] = packing.InFrame(frame)
        target = self._frames[frame].target(x, y, yaw)
        self._open[goal_id] = True
        self._goal.send(lambda seq: packing.action_goal(seq, goal_id, now_ns, target))
        return goal_id

    def cancel(self, goal_id: str) -> None:
        """Ask the robot to cancel the goal with this id. ``on_end`` is called when it ends."""
        self._cancel.publish(GoalID(id=goal_id))

    def close(self) -> None:
        """Unregister all topics; ``on_end`` is not called any more."""
        for topic in (self._goal, self._cancel, self._result):
            topic.unregister()

    def _on_result(self, message: Any) -> None:
        if self._open.pop(message.name, False):
            self._on_end(self, message.name, message.state, message.said)
