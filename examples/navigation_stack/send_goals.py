#!/usr/bin/env python3
"""Send ~goals [m, m, rad, frame map] to move_base, one after another, and say how well the robot knew where it was.

Once a second the pose on tf (map -> ~base_frame) is compared with base_pose_ground_truth of the same stamp, and so is
odom, which begins at ~start [m, m, rad, frame map].
"""
import math
import sys

import actionlib
import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry


def yaw_of(rotation):
    """Return the heading [rad] of ``rotation``."""
    return 2.0 * math.atan2(rotation.z, rotation.w)


class Errors:
    """How far off localization and odometry are [m, rad]."""

    def __init__(self):
        self.localization, self.odometry = [], []
        self._truths, self._odometries = {}, {}  # poses by their stamps
        self._buffer = tf2_ros.Buffer()
        tf2_ros.TransformListener(self._buffer)
        self._base = rospy.get_param('~base_frame')
        rospy.Subscriber('base_pose_ground_truth', Odometry, _keep, self._truths)
        rospy.Subscriber('odom', Odometry, _keep, self._odometries)
        rospy.Timer(rospy.Duration(1.0), self._look)

    def _look(self, _):
        try:
            found = self._buffer.lookup_transform('map', self._base, rospy.Time())
        except tf2_ros.TransformException:
            return
        stamp, place = found.header.stamp, found.transform.translation
        if stamp not in self._truths or stamp not in self._odometries:
            return
        truth, (ahead, aside, turned) = self._truths[stamp], self._odometries[stamp]
        x, y, yaw = rospy.get_param('~start')
        self.localization.append(_error((place.x, place.y, yaw_of(found.transform.rotation)), truth))
        self.odometry.append(_error((x + ahead * math.cos(yaw) - aside * math.sin(yaw),
                                     y + ahead * math.sin(yaw) + aside * math.cos(yaw), yaw + turned), truth))

    def say(self, what, errors):
        """Print mean and maximum of ``errors``."""
        places, angles = zip(*errors)
        print('{}: mean {:.3f} m, max {:.3f} m, max {:.1f} deg, of {}'.format(
            what, sum(places) / len(places), max(places), math.degrees(max(angles)), len(errors)), flush=True)


def _keep(message, poses):
    pose = message.pose.pose
    poses[message.header.stamp] = pose.position.x, pose.position.y, yaw_of(pose.orientation)
    while len(poses) > 100:
        poses.pop(next(iter(poses)))


def _error(pose, truth):
    turned = math.remainder(pose[2] - truth[2], 2.0 * math.pi)
    return math.hypot(pose[0] - truth[0], pose[1] - truth[1]), abs(turned)


def main():
    """Send the goals; exits with 1 if one is not reached."""
    rospy.init_node('send_goals')
    errors = Errors()
    client = actionlib.SimpleActionClient('move_base', MoveBaseAction)
    client.wait_for_server()
    failed = 0
    for x, y, yaw in rospy.get_param('~goals'):
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id, goal.target_pose.header.stamp = 'map', rospy.Time.now()
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
        goal.target_pose.pose.orientation.z, goal.target_pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        client.send_goal_and_wait(goal)
        reached = client.get_state() == GoalStatus.SUCCEEDED
        failed += not reached
        said = 'reached' if reached else client.get_goal_status_text()
        print('{:.2f} s: goal ({}, {}, {}) {}'.format(rospy.Time.now().to_sec(), x, y, yaw, said), flush=True)
    errors.say('localization', errors.localization)
    errors.say('odometry', errors.odometry)
    return failed > 0


if __name__ == '__main__':
    sys.exit(main())
