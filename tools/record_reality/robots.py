"""The robots of a recording: their topics, and the goals that they get."""
import math
import re
import threading
from collections import deque

import rospy
from actionlib_msgs.msg import GoalID
from geometry_msgs.msg import Pose
from legs import ABORTED, STUCK_M, Leg
from move_base_msgs.msg import MoveBaseActionGoal, MoveBaseActionResult, RecoveryStatus
from nav_msgs.msg import Odometry, Path
from rosgraph_msgs.msg import Log
from std_srvs.srv import Empty

_STUCK_GOALS = 2  # goals in a row, after which a stuck robot is put elsewhere


class Robot:
    """One robot: its pose, its leg under way, and rows of finished legs. Messages wait until ``take`` is called."""

    def __init__(self, number, place, run):
        self.number, self.name, self._place, self._run = number, 'robot_{}'.format(number), place, run
        self.pose, self.v, self.w = None, 0.0, 0.0
        self.leg, self.rows, self.is_ready, self.moved = None, [], False, 0
        self._goals = self._stuck = 0
        self._aborted = False  # whether the previous goal was
        self._mail = deque()
        self._goal, self._cancel, self._put = [rospy.Publisher('/{}/{}'.format(self.name, topic), kind, queue_size=5)
                                               for topic, kind in (('move_base/goal', MoveBaseActionGoal),
                                                                   ('move_base/cancel', GoalID), ('cmd_pose', Pose))]
        for topic, kind in (('odom', Odometry), ('move_base/NavfnROS/plan', Path),
                            ('move_base/result', MoveBaseActionResult), ('move_base/recovery_status', RecoveryStatus)):
            rospy.Subscriber('/{}/{}'.format(self.name, topic), kind, self._mail.append, queue_size=100)

    def logged(self, text):
        """Note a line of its move_base's log."""
        self._mail.append(text)

    def is_heard(self):
        """Return whether move_base and Stage have subscribed to all topics that are published here."""
        return all(publisher.get_num_connections() for publisher in (self._goal, self._cancel, self._put))

    def take(self, now):
        """Handle all messages since the step before."""
        result = None
        while self._mail:
            message = self._mail.popleft()
            if isinstance(message, Odometry):
                self._drive(message, now)
            elif isinstance(message, MoveBaseActionResult):
                result = message
            elif self.leg is not None:
                self._tell(message, now)
        if result is not None and self.leg is not None and result.status.goal_id.id == self._id():
            self._end(result.status.status, result.status.text, now)

    def _drive(self, odometry, now):
        pose, twist = odometry.pose.pose, odometry.twist.twist
        self.pose = (pose.position.x, pose.position.y, 2.0 * math.atan2(pose.orientation.z, pose.orientation.w))
        self.pose = self.pose[:2] + (math.atan2(math.sin(self.pose[2]), math.cos(self.pose[2])),)
        self.v, self.w = twist.linear.x, twist.angular.z
        if self.leg is not None:
            self.leg.moved(self.pose, self.v, self.w, now)

    def _tell(self, message, now):
        if isinstance(message, Path):
            self.leg.planned([(pose.pose.position.x, pose.pose.position.y) for pose in message.poses], now)
        elif isinstance(message, RecoveryStatus):
            self.leg.recoveries += 1
        else:
            self.leg.missed += 'Control loop missed its desired rate' in message
            self.leg.failures += 'DWA planner failed to produce path' in message

    def send(self, kind, goal, now):
        """Send a goal (x, y, yaw) [m, rad]."""
        self._goals += 1
        self.leg = Leg(self._goals, kind, self.pose, goal, now)
        message = MoveBaseActionGoal()
        message.goal_id.id = self._id()
        message.goal_id.stamp = message.header.stamp = rospy.Time.from_sec(now)
        message.goal.target_pose.header.frame_id = 'map'
        message.goal.target_pose.pose = _pose(*goal)
        self._goal.publish(message)

    def _id(self):
        return '{} {} {}'.format(self._run, self.number, self.leg.number)

    def cancel(self, why):
        """Cancel its goal; ``why``: the number for the column ``cancelled``."""
        if self.leg.cancelled == 0:
            self.leg.cancelled = why
            self._cancel.publish(GoalID(id=self._id()))

    def cut(self, now):
        """End the recording of the leg under way, as if it were cancelled."""
        if self.leg is not None:
            self.leg.cancelled = 2
            self._end(2, '', now)

    def _end(self, state, text, now):
        leg, self.leg = self.leg, None
        stuck = state == ABORTED and self._aborted and leg.driven < STUCK_M
        self._aborted = state == ABORTED
        self._stuck = self._stuck + 1 if stuck else 0
        self.rows.append(leg.row(self._run, self.number, (state, text, now), self._place.clearance, stuck))

    def put_elsewhere_if_stuck(self):
        """If the robot has been stuck for some goals, let Stage put it to a roomy place; return whether it did."""
        if self._stuck < _STUCK_GOALS or self.leg is not None:
            return False
        self._stuck, self._aborted = 0, False
        self.moved += 1
        self._put.publish(_pose(*self._place.roomy_place_near(*self.pose[:2]), self.pose[2]))
        return True

    def clear_costmaps(self):
        """Call its move_base's service clear_costmaps, without waiting; return the thread that calls."""
        service = rospy.ServiceProxy('/{}/move_base/clear_costmaps'.format(self.name), Empty)
        # The service may wait for a costmap, which may wait for the clock.
        caller = threading.Thread(target=service, daemon=True)
        caller.start()
        return caller


class WatchedRobot(Robot):
    """A robot that gets its goals from another program."""

    def __init__(self, number, place, run):
        super().__init__(number, place, run)
        self._sent = None  # the latest goal, if its leg has not begun
        self._id_of_leg = ''
        self._plans = []
        rospy.Subscriber('/{}/move_base/goal'.format(self.name), MoveBaseActionGoal, self._mail.append, queue_size=100)

    def _tell(self, message, now):
        if isinstance(message, MoveBaseActionGoal):
            self._sent = message
        elif isinstance(message, Path) and not _leads_to(message, self.leg.goal):
            self._plans.append(message)
        else:
            super()._tell(message, now)

    def take(self, now):
        """Handle all messages since the step before; a goal's leg begins when the previous leg is over."""
        if self.leg is None:
            for message in list(self._mail):
                if isinstance(message, MoveBaseActionGoal):
                    self._sent = message
                elif isinstance(message, Path):
                    self._plans.append(message)
        super().take(now)
        if self._sent is not None and self.leg is None:
            self._begin(now)

    def _begin(self, now):
        pose, self._sent, self._id_of_leg = self._sent.goal.target_pose.pose, None, self._sent.goal_id.id
        self._goals += 1
        goal = (pose.position.x, pose.position.y, 2.0 * math.atan2(pose.orientation.z, pose.orientation.w))
        self.leg = Leg(self._goals, 'ranking', self.pose, goal, now)
        plans, self._plans = self._plans, []
        for plan in plans:
            if _leads_to(plan, goal):
                super()._tell(plan, now)

    def _id(self):
        return self._id_of_leg


def _leads_to(plan, goal):
    """Return whether a plan ends at a goal; an empty plan does."""
    if not plan.poses:
        return True
    end = plan.poses[-1].pose.position
    return math.hypot(end.x - goal[0], end.y - goal[1]) < 0.3


def watch_log(robots):
    """Give each robot the lines of its move_base's log; return the Subscriber."""
    by_name = {'/{}/move_base'.format(robot.name): robot for robot in robots}

    def take(message):
        robot = by_name.get(message.name)
        if robot is not None and re.search('missed its desired rate|failed to produce path', message.msg):
            robot.logged(message.msg)

    return rospy.Subscriber('/rosout', Log, take, queue_size=1000)


def _pose(x, y, yaw):
    pose = Pose()
    pose.position.x, pose.position.y = x, y
    pose.orientation.z, pose.orientation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    return pose
