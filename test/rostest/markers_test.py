#!/usr/bin/python3
"""Robots as markers: what they look like, and when how much of it is published."""
import unittest

import rosgraph
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose
from robot_harness import RawClient, Record, pose_stamped
from visualization_msgs.msg import Marker, MarkerArray

from move_base_abstract.geometry import Pose2D
from move_base_abstract.srv import AddRobot, RemoveRobot
from move_base_abstract_ros import marker_builder
from move_base_abstract_ros.marker_builder import ARROW, GOAL, LEG, NAME, Look, View

TOPIC = '/move_base_abstract/markers'
LOOK = Look('robot_7', 7, 'map', 2.0)
ROBOTS = {'robot_0', 'robot_1', 'robot_2'}


def shown(messages):
    """Return {(namespace, id): marker} as RViz shows it after ``messages``."""
    markers = {}
    for message in messages:
        for marker in message.markers:
            if marker.action == Marker.ADD:
                markers[marker.ns, marker.id] = marker
            else:
                markers.pop((marker.ns, marker.id), None)
    return markers


class Looks:
    """The builder alone, without topics."""

    def test_the_arrow_is_centred_on_the_robot_and_points_ahead(self):
        arrow, name = marker_builder.body(LOOK, View(Pose2D(3.0, 4.0)))
        self.assertEqual((arrow.type, arrow.pose.position.x, arrow.pose.position.y), (Marker.ARROW, 2.0, 4.0))
        self.assertEqual((arrow.scale.x, arrow.pose.orientation.w), (2.0, 1.0))
        self.assertEqual((name.type, name.text), (Marker.TEXT_VIEW_FACING, 'robot_7'))
        self.assertGreater(name.pose.position.y, 4.0)

    def test_all_four_share_namespace_frame_and_hue_and_differ_in_id(self):
        view = View(Pose2D(), Pose2D(5.0), (Pose2D(), Pose2D(5.0)))
        markers = marker_builder.body(LOOK, view) + marker_builder.route(LOOK, view)
        self.assertEqual([marker.id for marker in markers], [ARROW, NAME, GOAL, LEG])
        self.assertEqual({(m.ns, m.header.frame_id, m.action) for m in markers}, {('robot_7', 'map', Marker.ADD)})
        self.assertEqual(len({(m.color.r, m.color.g, m.color.b) for m in markers}), 1)
        self.assertEqual([(p.x, p.y) for p in markers[3].points], [(0.0, 0.0), (5.0, 0.0)])

    def test_no_goal_and_no_leg_are_taken_away(self):
        actions = [(marker.id, marker.action) for marker in marker_builder.route(LOOK, View(Pose2D()))]
        self.assertEqual(actions, [(GOAL, Marker.DELETE), (LEG, Marker.DELETE)])

    def test_colours_depend_on_the_number_only_and_a_hundred_differ(self):
        colours = {(c.r, c.g, c.b) for c in map(marker_builder.colour, range(100))}
        self.assertEqual(len(colours), 100)
        self.assertEqual(marker_builder.colour(3), marker_builder.colour(3))

    def test_a_robots_number_is_that_at_the_end_of_its_name_else_its_index(self):
        numbers = [marker_builder.robot_number(name, 5) for name in ('robot_12', 'thorvald', 'r2d2', 'a1b')]
        self.assertEqual(numbers, [12, 5, 2, 5])


class Markers(Looks, unittest.TestCase):
    """A fleet of three robots in one process."""

    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/fleet/add_robot')
        cls.record = Record(TOPIC, MarkerArray)
        cls.client = RawClient('/robot_0')

    def wait_for(self, condition):
        """Wait until what RViz shows fulfils ``condition``; return it."""
        self.record.wait_for(lambda message: condition(shown(self.record.messages)))
        return shown(self.record.messages)

    def test_1_who_comes_late_is_shown_all_robots_in_one_message(self):
        first = self.record.wait_for()
        self.assertEqual({(m.ns, m.id) for m in first.markers if m.action == Marker.ADD},
                         {(name, part) for name in ROBOTS for part in (ARROW, NAME)})
        arrow = shown([first])['robot_0', ARROW]
        self.assertEqual((arrow.pose.position.x, arrow.pose.position.y), (0.0, 2.0))

    def test_2_nothing_is_sent_while_nothing_happens(self):
        self.record.wait_for()
        rospy.sleep(5.0)
        placed = rospy.Publisher('/robot_1/set_pose', Pose, queue_size=1, latch=True)
        placed.publish(pose_stamped(3.0, 5.0).pose)
        self.wait_for(lambda markers: markers['robot_1', ARROW].pose.position.x == 2.0)
        self.assertEqual([sorted({marker.ns for marker in message.markers}) for message in self.record.messages],
                         [sorted(ROBOTS), ['robot_1']], 'the newcomer is told all, then only what has happened')
        placed.publish(pose_stamped(0.0, 5.0).pose)
        self.wait_for(lambda markers: markers['robot_1', ARROW].pose.position.x == -1.0)
        placed.unregister()

    def test_3_a_goal_and_its_leg_are_shown_until_the_goal_ends(self):
        goal_id = self.client.send(pose_stamped(1000.0, 2.0))
        markers = self.wait_for(lambda markers: ('robot_0', LEG) in markers)
        goal, leg = markers['robot_0', GOAL], markers['robot_0', LEG]
        self.assertEqual((goal.pose.position.x, goal.pose.position.y), (1000.0, 2.0))
        self.assertEqual([(p.x, p.y) for p in leg.points], [(1.0, 2.0), (1000.0, 2.0)])
        self.record.clear()
        self.record.wait_for(lambda _message: len(self.record.messages) >= 4)
        messages = self.record.messages
        for message in messages:
            self.assertEqual([(m.ns, m.id) for m in message.markers], [('robot_0', ARROW), ('robot_0', NAME)])
        places = [message.markers[0].pose.position.x for message in messages]
        self.assertEqual(places, sorted(places))
        self.client.cancel(goal_id)
        self.assertEqual(self.client.ending(goal_id).status.status, GoalStatus.PREEMPTED)
        self.record.wait_for(lambda message: {(m.id, m.action) for m in message.markers} >= {
            (GOAL, Marker.DELETE), (LEG, Marker.DELETE)})

    def test_4_robots_that_come_and_go_do_so_here_too(self):
        added = rospy.ServiceProxy('/fleet/add_robot', AddRobot)('late_9', 7.0, 8.0, 0.0, '')
        self.assertTrue(added.success, added.message)
        self.wait_for(lambda markers: ('late_9', NAME) in markers)
        removed = rospy.ServiceProxy('/fleet/remove_robot', RemoveRobot)('late_9')
        self.assertTrue(removed.success, removed.message)
        self.wait_for(lambda markers: not any(name == 'late_9' for name, _ in markers))

    def test_5_one_node_publishes_for_all(self):
        published = dict(rosgraph.Master('/test').getSystemState()[0])
        self.assertEqual(published[TOPIC], ['/fleet'])

    def test_6_what_is_no_robots_lies_under_a_name_of_its_own(self):
        """Programs of others take what begins with the robots' names for robots: '/robot_*', split at '_' and '/'."""
        master = rosgraph.Master('/test')
        publishers, subscribers, services = master.getSystemState()
        named = [name for group in (publishers, subscribers, services) for name, nodes in group
                 if set(nodes) & {'/fleet', '/time_master'}]
        first = {name.split('/')[1] for name in named + master.getParamNames() if name.count('/') > 1}
        self.assertLessEqual(ROBOTS, first)
        self.assertEqual(first - ROBOTS - {'late_9'}, {'fleet', 'move_base_abstract', 'rosdistro', 'roslaunch',
                                                       'time_master'} & first)
        at_the_root = {name for name in named if name.count('/') == 1}
        self.assertEqual(at_the_root, {'/clock', '/rosout', '/sim_time_factor', '/tf'} & at_the_root)


if __name__ == '__main__':
    rospy.init_node('markers_test')
    rostest.rosrun('move_base_abstract', 'markers', Markers)
