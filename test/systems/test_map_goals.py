"""Robots with a map: the goals that they refuse, the texts and times of that, and the plans of make_plan."""
import os
import threading
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan, SetMap
from robot_harness import (
    GUARD,
    NO_PLAN,
    REACHED,
    LoadMap,
    RawClient,
    Record,
    go,
    pose_stamped,
    simple_client,
)
from rosgraph_msgs.msg import Log

from move_base_abstract_ros.maps.map_listener import MapListener

LAUNCH_FILE = """
<launch>  <!-- a map with a block in it, and a fleet whose robots use the map in different ways -->
  <include file="$(find move_base_abstract)/launch/map.launch">
    <arg name="map" value="$(find move_base_abstract)/test/data/blocks.yaml"/>
  </include>
  <node pkg="move_base_abstract" type="fleet" name="fleet" output="screen" required="true">
    <rosparam>
      defaults: {max_speed: 2.0, use_map: true, frame_timeout: 20.0}
      robots:
        - {name: plain}
        - {name: strict, allow_unknown: false}
        - {name: bold, allow_occupied_goals: true}
        - {name: patient, abort_policy: upstream}
        - {name: blind, use_map: false}
        - {name: late, map_topic: /late_map}
        - {name: lost, map_topic: nowhere, frame_timeout: 0.3}
        - {name: stranger, global_frame: world}
        - {name: own}
    </rosparam>
  </node>
</launch>
"""
FACTOR = 20
OWN_NODE = 'map_goals_test'

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data')
FREE, OCCUPIED, UNKNOWN, OFF = (1.25, 0.25), (2.25, 0.25), (4.25, 0.25), (10.0, 0.0)
REFUSED = (GoalStatus.ABORTED, NO_PLAN)
OFF_THE_MAP = 'The goal sent to the navfn planner is off the global costmap. Planning will always fail to this goal.'


def plan(robot, goal, tolerance=0.0):
    """Return the poses [(x, y)] of make_plan for ``robot`` from (0, 0) to ``goal`` [m]."""
    name = '/{}/move_base/make_plan'.format(robot)
    rospy.wait_for_service(name, GUARD)
    poses = rospy.ServiceProxy(name, GetPlan)(pose_stamped(), pose_stamped(*goal), tolerance).plan.poses
    return [(pose.pose.position.x, pose.pose.position.y) for pose in poses]


class MapGoals(unittest.TestCase):
    """Each robot uses the map in another way, see map_goals.test."""

    @classmethod
    def setUpClass(cls):
        cls.log = Record('/rosout', Log)

    def ends(self, robot, places):
        """Send goals to ``places``, one after the other; return their endings."""
        client = simple_client('/' + robot)
        return [go(client, pose_stamped(*place)) for place in places]

    def test_goals_in_occupied_cells_and_off_the_map_are_refused(self):
        self.assertEqual(self.ends('plain', (FREE, OCCUPIED, UNKNOWN, OFF)), [REACHED, REFUSED, REACHED, REFUSED])

    def test_goals_in_unknown_cells_are_refused_if_one_says_so(self):
        self.assertEqual(self.ends('strict', (FREE, OCCUPIED, UNKNOWN, OFF)), [REACHED, REFUSED, REFUSED, REFUSED])

    def test_all_goals_are_allowed_if_one_says_so_or_uses_no_map(self):
        for robot in ('bold', 'blind'):
            self.assertEqual(self.ends(robot, (FREE, OCCUPIED, UNKNOWN, OFF)), [REACHED] * 4)

    def test_the_log_says_why_in_upstreams_words_off_the_map(self):
        self.ends('plain', (OFF, OCCUPIED))
        self.ends('strict', (UNKNOWN,))
        for text in ('plain: ' + OFF_THE_MAP, 'plain: The goal (2.25, 0.25) lies in an occupied cell of the map.',
                     'strict: The goal (4.25, 0.25) lies in an unknown cell of the map.'):
            line = self.log.wait_for(lambda message, text=text: message.msg == text)
            self.assertEqual(line.level, Log.WARN)

    def test_set_map_gives_one_robot_a_map_of_its_own(self):
        there = PoseWithCovarianceStamped()
        there.pose.pose.orientation.w = 1.0
        wall = OccupancyGrid()
        wall.header.frame_id, wall.info.resolution, wall.info.width, wall.info.height = 'map', 1.0, 2, 1
        wall.data = [0, 100]
        set_map = rospy.ServiceProxy('/own/set_map', SetMap)
        set_map.wait_for_service(GUARD)
        self.assertTrue(set_map(wall, there).success)
        self.assertEqual(self.ends('own', (FREE, (0.75, 0.25))), [REFUSED, REACHED])
        self.assertEqual(self.ends('plain', (FREE,)), [REACHED])
        wall.info.width = 7
        self.assertFalse(set_map(wall, there).success)
        wall.info.width, wall.header.frame_id = 2, 'world'
        self.assertFalse(set_map(wall, there).success)
        self.assertEqual(self.ends('own', (FREE, (0.25, 0.25))), [REFUSED, REACHED])

    def test_make_plan_finds_a_place_near_the_goal_as_move_base_does(self):
        self.assertEqual(plan('plain', FREE)[-1], FREE)
        self.assertEqual(plan('plain', OCCUPIED), [])
        self.assertEqual(plan('plain', OCCUPIED, 0.2), [])
        # move_base first tries a place in the west; the last pose is the goal itself
        for tolerance, x in ((0.3, 1.95), (1.0, 1.25), (1.5, 0.75), (100.0, 0.75)):
            near, goal = plan('plain', OCCUPIED, tolerance)[-2:]
            self.assertAlmostEqual(near[0], x, places=5)
            self.assertEqual((near[1], goal), (0.25, OCCUPIED))
        self.assertEqual(plan('strict', UNKNOWN), [])
        self.assertEqual(plan('bold', OFF)[-1], OFF)

    def test_the_global_costmap_is_the_map_and_the_local_one_a_window_of_it(self):
        wanted = rospy.wait_for_message('/map', OccupancyGrid, GUARD)
        for robot in ('plain', 'strict'):
            shown = rospy.wait_for_message('/{}/move_base/global_costmap/costmap'.format(robot), OccupancyGrid, GUARD)
            self.assertEqual((shown.info, shown.data), (wanted.info, wanted.data))
            window = rospy.wait_for_message('/{}/move_base/local_costmap/costmap'.format(robot), OccupancyGrid, GUARD)
            self.assertEqual(window.header.frame_id, robot + '/odom')
            self.assertEqual(set(window.data), {-1, *wanted.data}, 'it is larger than this map')

    @unittest.skipIf(LoadMap is None, 'nav_msgs has no LoadMap here')
    def test_another_map_counts_from_then_on(self):
        change = rospy.ServiceProxy('/change_map', LoadMap)
        self.addCleanup(change, os.path.join(DATA, 'blocks.yaml'))
        yard = os.path.join(DATA, '..', '..', 'maps', 'farm_yard.yaml')
        costmap = Record('/plain/move_base/global_costmap/costmap', OccupancyGrid)
        self.assertEqual(change(yard).result, 0)
        costmap.wait_for(lambda grid: grid.info.width == 600)
        self.assertEqual(self.ends('plain', ((10.0, 4.0), (10.0, 28.0))), [REACHED, REFUSED])
        change(os.path.join(DATA, 'blocks.yaml'))
        costmap.wait_for(lambda grid: grid.info.width == 12)

    def test_a_goal_waits_for_the_first_map(self):
        client = RawClient('/late')
        goal_id = client.send(pose_stamped(*FREE))
        grid = OccupancyGrid(data=[0] * 100)
        grid.header.frame_id = 'map'
        grid.info.resolution, grid.info.width, grid.info.height = 0.5, 10, 10  # orientation left out: all zero
        publisher = rospy.Publisher('/late_map', OccupancyGrid, queue_size=1, latch=True)
        threading.Timer(0.5, publisher.publish, (grid,)).start()
        ended = client.ending(goal_id)
        self.assertEqual((ended.status.status, ended.status.text), REACHED)
        self.assertEqual(publisher.get_num_connections(), 1)

    def test_a_map_that_is_none_is_not_used_and_the_old_one_stays(self):
        topic = '/bad_map'
        listener = MapListener.on(topic)
        seen = []
        listener.follow(lambda message, occupancy: seen.append(occupancy.width))
        publisher = rospy.Publisher(topic, OccupancyGrid, queue_size=10)
        while not publisher.get_num_connections():
            rospy.rostime.wallsleep(0.01)
        for width, resolution, text in (
                (2, 1.0, 'map on /bad_map: 2 x 1 cells of 1 m'),
                (3, 1.0, 'the map on /bad_map is not used: got 2 cells; allowed: 3 x 1'),
                (2, 0.0, 'the map on /bad_map is not used: map: resolution: got 0.0'),
                (1, 2.0, 'map on /bad_map: 1 x 1 cells of 2 m')):
            grid = OccupancyGrid(data=[0] * min(width, 2))
            grid.info.resolution, grid.info.width, grid.info.height = resolution, width, 1
            publisher.publish(grid)
            self.log.wait_for(lambda message, text=text: text in message.msg)
        self.assertEqual(seen, [2, 1])
        self.assertIs(MapListener.on(topic), listener)

    def test_without_a_map_a_goal_ends_with_a_text_that_names_the_topic(self):
        [(state, text)] = self.ends('lost', (FREE,))
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("No map has come on '/lost/nowhere' yet", text)
        with self.assertRaisesRegex(rospy.ServiceException, "No map has come on '/lost/nowhere' yet"):
            plan('lost', FREE)

    def test_a_map_in_another_frame_than_the_robots_is_refused(self):
        client = simple_client('/stranger')
        rospy.wait_for_message('/stranger/move_base/global_costmap/costmap', OccupancyGrid, GUARD)
        state, text = go(client, pose_stamped(*FREE, frame='world'))
        self.assertEqual(state, GoalStatus.ABORTED)
        self.assertIn("The map on '/map' cannot be used: it is given in the frame 'map'", text)
