"""Robots as markers: their looks, and the times and sizes of the messages."""
import math
import tempfile
import unittest
from dataclasses import replace
from unittest import mock

import rosgraph
import rospy
from actionlib import SimpleActionClient
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose
from robot_harness import RawClient, Record, pose_stamped
from visualization_msgs.msg import Marker, MarkerArray

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task
from move_base_abstract.scenario import make_scenario
from move_base_abstract.srv import AddRobot, RemoveRobot
from move_base_abstract_ros.markers import marker_builder, world_markers
from move_base_abstract_ros.markers.marker_builder import ARROW, GOAL, LEG, NAME, Look, View
from move_base_abstract_ros.markers.world_markers import OUTLINE, SIGN

LAUNCH_FILE = """
<launch>  <!-- robots as markers: one message for all robots of a process -->
  <node pkg="move_base_abstract" type="fleet" name="fleet" required="true">
    <rosparam>
      defaults: {max_speed: 2.0, marker_size: 2.0}
      robots:
        - {name: robot_0, start_x: 1.0, start_y: 2.0}
        - {name: robot_1, start_y: 5.0}
        - {name: robot_2, start_y: 10.0}
      zones: [{name: gate, rectangle: [20.0, 20.0, 24.0, 24.0], capacity: 1}]
      places: [{name: dock, y: 5.0, capacity: 1, duration: 100000.0, reach: 1.0}]
    </rosparam>
  </node>
</launch>
"""
FACTOR = 5
OWN_NODE = 'markers_test'

TOPIC = '/move_base_abstract/markers'
LOOK = Look('robot_7', 7, 'map', 2.0)
ROBOTS = {'robot_0', 'robot_1', 'robot_2'}
AREAS = {'place dock', 'zone gate'}


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
    """Tests of the builder alone, without topics."""

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

    def test_an_area_is_red_where_nobody_more_is_let_in_and_names_few_of_those_who_wait(self):
        look = world_markers.AreaLook('zone gate', 'map', ((0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)), 1.0)
        use = world_markers.Use('gate', ('a',), 1, tuple('bcdef'))
        outline, sign = world_markers.draw(look, use)
        self.assertEqual([(p.x, p.y) for p in outline.points], [*look.corners, look.corners[0]])
        self.assertEqual(sign.text, 'gate 1/1\nwaits: b, c, d, e, ...')
        self.assertGreater(sign.color.r, 2.0 * sign.color.g)
        uses = (world_markers.Use('gate'), world_markers.Use('gate', (), 1), world_markers.Use('gate', closed=True))
        free = [world_markers.draw(look, one)[1] for one in uses]
        self.assertEqual([(one.text, one.color.r > one.color.g) for one in free],
                         [('gate', False), ('gate 0/1', False), ('gate closed', True)])

    def test_a_lane_has_an_arrow_for_each_direction_and_says_its_room_and_who_waits(self):
        look = world_markers.AreaLook('lane a - b', 'map', ((0.0, 0.0), (10.0, 0.0)), 1.0, is_lane=True)
        for one_way, tips in ((True, [5.35]), (False, [5.35, 4.65])):
            line, heads, sign = world_markers.draw(replace(look, one_way=one_way), world_markers.Use('a - b'))
            self.assertEqual([(p.x, p.y) for p in line.points], [*look.corners])
            self.assertEqual([(p.x, p.y) for p in heads.points[::4]], [(tip, 0.0) for tip in tips])
            self.assertEqual({round(abs(p.y), 3) for p in heads.points[1::2]}, {0.21})  # on both sides behind the tip
            self.assertEqual(sign.action, Marker.DELETE)  # without a text
        self.assertLess(heads.points[1].x, tips[0])
        self.assertGreater(heads.points[5].x, tips[1])
        texts = [world_markers.draw(look, world_markers.Use('a - b', inside, 1, waiting))[2]
                 for inside, waiting in (((), ()), (('c',), ('d', 'e')))]
        self.assertEqual([sign.text for sign in texts], ['0/1', '1/1\nwaits: d, e'])
        self.assertGreater(texts[1].color.r, 2.0 * texts[1].color.g)

    def test_a_node_has_a_ring_at_each_spot_and_a_sign_if_it_has_room_for_several(self):
        look = world_markers.AreaLook('node a', 'map', ((0.0, 0.0), (3.0, 4.0)), 1.0)
        rings, sign = world_markers.draw_spots(look, world_markers.Use('a', ('r',), 2))
        points = [(p.x, p.y) for p in rings.points]
        self.assertEqual((points[:2], sign.text, sign.action), ([*look.corners], '1/2', Marker.ADD))
        self.assertEqual({round(math.dist(point, (3.0, 4.0)), 6) for point in points[2:]}, {0.4})
        ring, sign = world_markers.draw_spots(replace(look, corners=((1.0, 0.0),)), world_markers.Use('a', ('r',), 1))
        self.assertEqual({round(math.dist((p.x, p.y), (1.0, 0.0)), 6) for p in ring.points}, {0.4})
        self.assertEqual((sign.action, ring.color.r > 2.0 * ring.color.g), (Marker.DELETE, True))
        _, sign = world_markers.draw_spots(look, world_markers.Use('a', ('r',), 1, ('s',)))
        self.assertEqual((sign.action, sign.text), (Marker.ADD, '1/1\nwaits: s'))

    def test_the_nodes_of_a_net_are_dots_with_names_and_sent_once_to_each_who_looks(self):
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as stream:
            stream.write('{nodes: [{name: a, x: 1, y: 2}, {name: b, x: 4, y: 2}], '
                         'edges: [{from: a, to: b, one_way: true}]}')
            stream.flush()
            scenario = make_scenario({'robots': [{'name': 'r', 'count': 2, 'routes': 'lanes', 'lanes': stream.name}]})
        board, traffic = mock.Mock(), mock.Mock()
        with mock.patch.object(world_markers.robot_markers, 'board', lambda *_: board):
            world_markers.add(None, scenario, traffic, None)
        nodes, lane = (call.args[0] for call in board.add.call_args_list)
        self.assertEqual((lane.look.name, lane.look.one_way), ('lane a - b', True))
        dots, *names = nodes.draw(nodes.view(0))
        self.assertEqual([(p.x, p.y) for p in dots.points], [(1.0, 2.0), (4.0, 2.0)])
        self.assertEqual([(sign.ns, sign.text, sign.pose.position.x) for sign in names],
                         [('node names', 'a', 1.0), ('node names', 'b', 4.0)])
        self.assertEqual(len({(marker.ns, marker.id) for marker in (dots, *names)}), 3)
        self.assertEqual(nodes.draw(nodes.view(0)), [])
        nodes.forget_drawn()
        self.assertEqual(len(nodes.draw(nodes.view(0))), 3)

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
    """Tests with a fleet of three robots in one process."""

    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service('/fleet/add_robot')
        cls.record = Record(TOPIC, MarkerArray)
        cls.client = RawClient('/robot_0')

    def wait_for(self, condition):
        """Wait until the markers that RViz shows fulfil ``condition``; return them."""
        self.record.wait_for(lambda message: condition(shown(self.record.messages)))
        return shown(self.record.messages)

    def test_1_who_comes_late_is_shown_all_robots_in_one_message(self):
        first = self.record.wait_for()
        self.assertEqual({(m.ns, m.id) for m in first.markers if m.action == Marker.ADD},
                         {(name, part) for name in ROBOTS for part in (ARROW, NAME)}
                         | {(name, part) for name in AREAS for part in (OUTLINE, SIGN)})
        self.assertEqual([shown([first])[key].text for key in (('robot_0', NAME), ('zone gate', SIGN),
                                                               ('place dock', SIGN))],
                         ['robot_0\nidle', 'gate 0/1', 'dock 0/1'])
        arrow = shown([first])['robot_0', ARROW]
        self.assertEqual((arrow.pose.position.x, arrow.pose.position.y), (0.0, 2.0))

    def test_2_nothing_is_sent_while_nothing_happens(self):
        self.record.wait_for()
        rospy.sleep(5.0)
        placed = rospy.Publisher('/robot_1/set_pose', Pose, queue_size=1, latch=True)
        placed.publish(pose_stamped(3.0, 5.0).pose)
        self.wait_for(lambda markers: markers['robot_1', ARROW].pose.position.x == 2.0)
        self.assertEqual([sorted({marker.ns for marker in message.markers}) for message in self.record.messages],
                         [sorted(ROBOTS | AREAS), ['robot_1']], 'the newcomer is told all, then only what has happened')
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

    def test_31_who_works_at_a_place_and_who_waits_is_shown_there_and_above_the_robots(self):
        clients = [SimpleActionClient('/robot_{}/work'.format(number), PlaceTaskAction) for number in (1, 2)]
        placed = rospy.Publisher('/robot_2/set_pose', Pose, queue_size=1, latch=True)
        placed.publish(pose_stamped(0.0, 5.5).pose)
        self.wait_for(lambda markers: markers['robot_2', ARROW].pose.position.y == 5.5)
        for client, state in zip(clients, ('working', 'waiting')):
            self.assertTrue(client.wait_for_server(rospy.Duration(600.0)))
            client.send_goal(PlaceTaskGoal(Task(place='dock')))
            self.wait_for(lambda markers, state=state: any(m.text.endswith('\n' + state) for m in markers.values()))
        self.wait_for(lambda markers: markers['place dock', SIGN].text == 'dock 1/1\nwaits: robot_2')
        clients[0].cancel_goal()
        self.wait_for(lambda markers: markers['place dock', SIGN].text == 'dock 1/1' and markers[
            'robot_1', NAME].text == 'robot_1\nidle' and markers['robot_2', NAME].text == 'robot_2\nworking')
        clients[1].cancel_goal()
        placed.publish(pose_stamped(0.0, 10.0).pose)
        self.wait_for(lambda markers: markers['robot_2', ARROW].pose.position.y == 10.0)
        placed.unregister()

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
        """Other people's programs find robots by names such as '/robot_*', split at '_' and '/'."""
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
