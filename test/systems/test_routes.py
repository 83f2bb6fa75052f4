"""Robots that drive around buildings: plans, poses and durations, goals without a way, a new map on the way."""
import os
import unittest

import numpy as np
import rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseActionFeedback
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from nav_msgs.srv import GetPlan
from robot_harness import GUARD, NO_PLAN, REACHED, RawClient, Record, go, pose_stamped, simple_client

from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.msg import ZoneStates
from move_base_abstract.scenario import make_scenario
from move_base_abstract.srv import CloseZone, SetZoneLimit

LAUNCH_FILE = """
<launch>  <!-- the farm yard, and robots that drive around its buildings -->
  <include file="$(find move_base_abstract)/launch/map.launch"/>
  <node pkg="move_base_abstract" type="fleet" name="fleet" output="screen" required="true">
    <rosparam subst_value="true">
      lanes: $(find move_base_abstract)/config/lanes/farm_yard.yaml
      zones:
        - {name: shed, rectangle: [0.0, -30.0, 10.0, -10.0], capacity: 1}
      defaults: {max_speed: 2.0, use_map: true, frame_timeout: 20.0, routes: grid, robot_radius: 0.5,
                 start_x: 10.0, start_y: 4.0}
      robots:
        - {name: keeper}
        - {name: stopper, corners: stop, turn_rate: 1.0, acceleration: 1.0}
        - {name: planner, robot_radius: 0.3}
        - {name: laner, routes: lanes, use_map: false}
        - {name: holder, routes: none, use_map: false, start_x: 5.0, start_y: -20.0}
        - {name: waiter, routes: none, use_map: false, start_x: -5.0, start_y: -21.0}
        - {name: changer, map_topic: /changing_map, max_speed: 0.1}
    </rosparam>
  </node>
</launch>
"""
FACTOR = 20
OWN_NODE = 'routes_test'

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
MAPS = os.path.join(ROOT, 'maps')
LANES = os.path.join(ROOT, 'config', 'lanes', 'farm_yard.yaml')
START, GOAL, WALL, FAR = (10.0, 4.0), (10.0, 20.0), (10.0, 12.0), (-5.0, 4.0)


def yard():
    """Return the OccupancyMap of the farm yard."""
    return load_map(read_description(os.path.join(MAPS, 'farm_yard.yaml')))


def travelled(goal, **settings):
    """Return (corners, duration [ns]) of a robot of the plain Python fleet from START to ``goal``."""
    defaults = {'max_speed': 2.0, 'use_map': True, 'routes': 'grid', 'robot_radius': 0.5,
                'start_x': START[0], 'start_y': START[1], **settings}
    fleet = Fleet(make_scenario({'defaults': defaults, 'robots': [{'name': 'bot'}]}), start_ns=0, occupancy=yard())
    fleet.robot('bot').send(*goal)
    corners = fleet.robot('bot')._robot.leg.corners
    fleet.run()
    return list(corners), fleet.trace[-1].time_ns


def points(path):
    """Return [(x, y)] of a nav_msgs/Path."""
    return [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses]


class Routes(unittest.TestCase):
    """Each test has a robot of its own, see routes.test."""

    def travel(self, robot):
        """Send ``robot`` from START to GOAL; return (duration [ns], all poses [(x, y)] that it published)."""
        odometry = Record('/{}/odom'.format(robot), Odometry)
        feedback = Record('/{}/move_base/feedback'.format(robot), MoveBaseActionFeedback)
        client = RawClient('/' + robot)
        ended, took_ns = client.drive(pose_stamped(*GOAL))
        self.assertEqual(ended, REACHED)
        places = [message.pose.pose.position for message in odometry.messages] + [
            message.feedback.base_position.pose.position for message in feedback.messages]
        return took_ns, [(place.x, place.y) for place in places]

    def test_it_drives_around_the_building_for_as_long_as_the_plain_fleet(self):
        stopping = {'corners': 'stop', 'turn_rate': 1.0, 'acceleration': 1.0}
        for robot, settings in (('keeper', {}), ('stopper', stopping)):
            corners, duration_ns = travelled(GOAL, **settings)
            self.assertGreaterEqual(len(corners), 1)
            took_ns, places = self.travel(robot)
            self.assertEqual(took_ns, duration_ns)
            ways = [START, *corners, GOAL]
            self.assertTrue(places)  # there are only a few on a busy machine
            for place in places:
                self.assertLess(min(distance(place, *piece) for piece in zip(ways, ways[1:])), 1e-6)
            topics = ('NavfnROS/plan', 'TrajectoryPlannerROS/global_plan', 'TrajectoryPlannerROS/local_plan')
            for topic in topics:
                plan = points(rospy.wait_for_message('/{}/move_base/{}'.format(robot, topic), Path, GUARD))
                self.assertEqual((plan[0], plan[-1]), (START, GOAL))
                self.assertTrue(set(corners) <= set(plan))

    def test_it_keeps_to_the_lanes_for_as_long_as_in_the_plain_fleet(self):
        pen = (43.0, 11.0)
        corners, duration_ns = travelled(pen, routes='lanes', use_map=False, lanes=LANES)
        self.assertEqual(RawClient('/laner').drive(pose_stamped(*pen)), (REACHED, duration_ns))
        self.assertGreater(duration_ns, 9.0 / 0.4 * 1e9)  # since the last lane is slow
        plan = points(rospy.wait_for_message('/laner/move_base/NavfnROS/plan', Path, GUARD))
        self.assertEqual((plan[0], plan[-1]), (START, pen))
        self.assertTrue(set(corners) <= set(plan) and len(corners) == 3)

    def test_a_robot_waits_for_a_zone_and_all_can_see_it(self):
        zones = Record('/fleet/zones', ZoneStates)
        first = zones.wait_for().zones
        self.assertEqual(((first[0].kind, first[0].name), first[0].robots), (('zone', 'shed'), ['holder']))
        self.assertEqual((first[1].kind, first[1].name, first[1].capacity), ('lane', 'gate - pen', 1))
        feedback = Record('/waiter/move_base/feedback', MoveBaseActionFeedback)
        client, holder = RawClient('/waiter'), RawClient('/holder')
        goal_id = client.send(pose_stamped(5.0, -21.0))
        zones.wait_for(lambda message: message.zones[0].waiting == ['waiter'])
        last = feedback.wait_for(lambda message: message.feedback.base_position.pose.position.x > -1e-6)
        self.assertAlmostEqual(last.feedback.base_position.pose.position.x, 0.0, places=6)
        self.assertEqual(last.status.status, GoalStatus.ACTIVE)
        close = rospy.ServiceProxy('/fleet/close_zone', CloseZone)
        self.assertIn('there are: shed', close('shop', True).message)
        self.assertTrue(close('shed', True).success)
        self.assertEqual(holder.ending(holder.send(pose_stamped(15.0, -20.0))).status.status, GoalStatus.SUCCEEDED)
        closed = zones.wait_for(lambda message: not message.zones[0].robots).zones[0]
        self.assertEqual((closed.closed, closed.waiting), (True, ['waiter']))
        limit = rospy.ServiceProxy('/fleet/set_zone_limit', SetZoneLimit)
        self.assertIn('there are: shed', limit('shop', 1.0).message)
        self.assertIn('max_speed: got -1.0; allowed', limit('shed', -1.0).message)
        self.assertTrue(limit('shed', 0.5).success and limit('shed', 0.0).success)
        self.assertTrue(close('shed', False).success)
        self.assertEqual(client.ending(goal_id).status.status, GoalStatus.SUCCEEDED)
        zones.wait_for(lambda message: message.zones[0].robots == ['waiter'])

    def test_make_plan_gives_the_way_or_none(self):
        name = '/planner/move_base/make_plan'
        rospy.wait_for_service(name, GUARD)
        make_plan = rospy.ServiceProxy(name, GetPlan)
        corners, _ = travelled(GOAL, robot_radius=0.3)
        plan = points(make_plan(pose_stamped(*START), pose_stamped(*GOAL), 0.0).plan)
        self.assertTrue(set(corners) <= set(plan))
        self.assertEqual(make_plan(pose_stamped(*START), pose_stamped(*WALL), 0.0).plan.poses, [])
        near, goal = points(make_plan(pose_stamped(*START), pose_stamped(*WALL), 10.0).plan)[-2:]
        self.assertEqual(goal, WALL)
        self.assertTrue(0.3 < distance(near, WALL, WALL) < 10.0)

    def test_a_goal_without_a_way_ends_with_upstreams_text(self):
        client = simple_client('/planner')
        for goal in (WALL, FAR):
            self.assertEqual(go(client, pose_stamped(*goal)), (GoalStatus.ABORTED, NO_PLAN))

    def test_a_new_map_that_cuts_the_way_is_gone_by_at_once(self):
        maps = rospy.Publisher('/changing_map', OccupancyGrid, queue_size=1, latch=True)
        maps.publish(area())
        plans = Record('/changer/move_base/NavfnROS/plan', Path)
        odometry = Record('/changer/odom', Odometry)
        client = RawClient('/changer')
        goal_id = client.send(pose_stamped(*GOAL))
        straight = points(plans.wait_for())
        self.assertEqual({x for x, _ in straight}, {10.0})
        odometry.wait_for(lambda message: message.pose.pose.position.y > 5.0)
        maps.publish(area(wall=True))
        around = points(plans.wait_for(lambda path: len({pose.pose.position.x for pose in path.poses}) > 1))
        self.assertAlmostEqual(around[0][0], 10.0)
        self.assertTrue(5.0 < around[0][1] < 12.0, around[0])
        self.assertEqual(around[-1], GOAL)
        self.assertTrue(any(x < 5.0 or x > 15.0 for x, _ in around))
        client.cancel(goal_id)
        self.assertEqual(client.ending(goal_id).status.status, GoalStatus.PREEMPTED)


def area(wall=False):
    """Return a map of 20 m x 24 m; with ``wall``, a wall is across the way from START to GOAL."""
    cells = np.zeros((48, 40), np.int8)
    if wall:
        cells[24:26, 10:30] = 100
    grid = OccupancyGrid(data=cells.ravel().tolist())
    grid.header.frame_id = 'map'
    grid.info.resolution, grid.info.width, grid.info.height = 0.5, 40, 48
    return grid


def distance(place, begin, end):
    """Return the distance [m] of ``place`` from the straight line between two points."""
    here, there = Pose2D(*place), Pose2D(*begin)
    length = there.distance_to(Pose2D(*end))
    along = ((place[0] - begin[0]) * (end[0] - begin[0]) + (place[1] - begin[1]) * (end[1] - begin[1]))
    share = min(1.0, max(0.0, along / length ** 2)) if length else 0.0
    return here.distance_to(Pose2D(begin[0] + share * (end[0] - begin[0]), begin[1] + share * (end[1] - begin[1])))
