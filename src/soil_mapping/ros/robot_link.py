"""One robot as its user sees it: the action of move_base, the action of its tasks, and a topic with its pose."""
from __future__ import annotations

import math
import threading
from typing import Any, Optional

import rospy
from actionlib import ActionClient, CommState, GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry

from move_base_abstract.motion.geometry import quaternion_of_yaw
from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task
from soil_mapping.mission.odometer import Odometer

SAME_PLACE_M = 1e-6  # a robot that is so near to a place is there


class RobotLink:
    """Clients of one robot. When a goal ends, (index, the goal's handle) is put on a queue.

    index: that of the robot in the mission. namespace: that of its topics. task: name of the sampling action below it.
    pose_topic: topic of nav_msgs/Odometry in the map frame, also below it. events: a queue.Queue.
    """

    def __init__(self, index: int, namespace: str, task: Any, pose_topic: Any, events: Any) -> None:
        self.index = index
        self.namespace = '/' + namespace.strip('/')
        self._events = events
        self._drive = ActionClient(f'{self.namespace}/move_base', MoveBaseAction)
        self._task = ActionClient(f'{self.namespace}/{task}', PlaceTaskAction)
        self._handle = None  # of the goal under way, kept because a client forgets goals without a handle
        self._goal_place: Any = None  # (x, y) of the drive under way
        self._lock = threading.Lock()  # poses come in another thread
        self._odometer: Any = Odometer()
        rospy.Subscriber(f'{self.namespace}/{pose_topic}', Odometry, self._on_pose, tcp_nodelay=True)

    @property
    def is_ready(self) -> bool:
        """Whether both servers are connected and the robot's pose is known."""
        at_once = rospy.Duration(nsecs=-1)
        return self._odometer.position is not None and self._drive.wait_for_server(at_once) \
            and self._task.wait_for_server(at_once)

    @property
    def lacks(self) -> str:
        """What is_ready waits for, in words."""
        at_once = rospy.Duration(nsecs=-1)
        parts = [client.ns for client in (self._drive, self._task) if not client.wait_for_server(at_once)]
        return ', '.join(parts + ([] if self._odometer.position else [f'the pose of {self.namespace}']))

    @property
    def is_busy(self) -> bool:
        """Whether a goal is under way."""
        return self._handle is not None

    @property
    def is_driving(self) -> bool:
        """Whether the goal under way is one of move_base."""
        return self._handle is not None and self._goal_place is not None

    def is_at(self, x: float, y: float) -> bool:
        """Return whether the robot stands at a place of the map frame [m]."""
        return math.dist(self._odometer.position, (x, y)) <= SAME_PLACE_M

    def drive(self, x: float, y: float) -> None:
        """Send the robot to a place of the map frame [m]; its yaw there is the direction of the straight line."""
        self._goal_place = (x, y)
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = 'map'
        goal.target_pose.header.stamp = rospy.Time.now()
        pose = goal.target_pose.pose
        pose.position.x, pose.position.y = x, y
        here: Any = self._odometer.position
        yaw = math.atan2(y - here[1], x - here[0])
        pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = quaternion_of_yaw(yaw)
        self._send(self._drive, goal)

    def take_sample(self, dwell_ns: Any) -> None:
        """Let the robot sample where it stands, for dwell_ns [simulated ns]."""
        self._goal_place = None
        self._send(self._task, PlaceTaskGoal(Task(duration=rospy.Duration(nsecs=dwell_ns))))

    def cancel(self) -> None:
        """Cancel the goal that is under way, if there is one; its end is reported like any other."""
        if self._handle is not None:
            self._handle.cancel()

    def is_reached(self, handle: Any) -> bool:
        """Return whether the goal of this handle is the one under way, and has been reached."""
        return handle == self._handle and handle.get_terminal_state() == GoalStatus.SUCCEEDED

    def end_of_goal(self, handle: Any) -> Optional[bool]:
        """Return whether an ended goal was reached, and note its end; None if it is not the goal under way."""
        if handle != self._handle:
            return None
        self._handle = None
        return handle.get_terminal_state() == GoalStatus.SUCCEEDED

    def place_after(self, handle: Any) -> Any:
        """Return the Place at which a drive has ended.

        It is the robot's pose, if one has arrived since then. Otherwise, if the goal was reached, it is the goal's
        place, because poses come over another connection and may be late.
        """
        result = handle.comm_state_machine.latest_result
        if result is not None and self._goal_place is not None \
                and handle.get_terminal_state() == GoalStatus.SUCCEEDED:
            with self._lock:
                self._odometer.reached(result.header.stamp.to_nsec(), *self._goal_place)
        return self.place()

    def place(self) -> Any:
        """Return the Place where the robot was last seen, with its way since the last call."""
        with self._lock:
            return self._odometer.take_place()

    def _send(self, client: Any, goal: Any) -> None:
        self._handle = client.send_goal(goal, self._on_transition)

    def _on_transition(self, handle: Any) -> None:
        if handle.get_comm_state() == CommState.DONE:
            self._events.put((self.index, handle))

    def _on_pose(self, message: Any) -> None:
        position = message.pose.pose.position
        stamp_ns = message.header.stamp.to_nsec() or rospy.Time.now().to_nsec()  # 0: the publisher sets no stamp
        with self._lock:
            self._odometer.pose(stamp_ns, position.x, position.y)
