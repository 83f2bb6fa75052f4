"""Fleets: many robots compared with the plain Python fleet, pre-emption and cancel, add, remove, reset."""
import itertools
import math
import random
import unittest
from concurrent.futures import ThreadPoolExecutor

import rosgraph
import rospkg
import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from dynamic_reconfigure.client import Client
from nav_msgs.msg import Odometry
from robot_harness import GUARD, REACHED, RawClient, Record, active_since_ns, pose_stamped
from sensor_msgs.msg import BatteryState
from std_srvs.srv import Trigger

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import read_scenario
from move_base_abstract.srv import AddRobot, Fail, RemoveRobot, SetCharge

LAUNCH_FILE = """
<launch>  <!-- twenty robots in two processes -->
  <include file="$(find move_base_abstract)/launch/fleet.launch">
    <arg name="scenario" value="$(find move_base_abstract)/test/data/twenty_robots.yaml"/>
    <arg name="processes" value="2"/>
  </include>
</launch>
"""
FACTOR = 20
OWN_NODE = 'fleet_test'

NAMES = ['{}_{}'.format(kind, number) for kind in ('robot', 'truck') for number in range(10)]
FIRST, SECOND = '/fleet_0', '/fleet_1'  # ten robots each


def service(name, kind):
    """Return a proxy of a service that must be there."""
    rospy.wait_for_service(name, GUARD * 20)
    return rospy.ServiceProxy(name, kind)


def parameters_of_all():
    """Return all parameters of the parameter server; rospy.get_param('/') shows only a cache."""
    return rosgraph.Master('/fleet_test').getParam('/')


class FleetTrial(unittest.TestCase):
    """Two processes with ten robots each."""

    @classmethod
    def setUpClass(cls):
        cls.scenario = read_scenario(rospkg.RosPack().get_path('move_base_abstract') + '/test/data/twenty_robots.yaml')
        for node in (FIRST, SECOND):
            rospy.wait_for_service(node + '/reset', GUARD * 20)
        cls.clients = {name: RawClient('/' + name) for name in NAMES}
        cls.odom = {name: Record('/{}/odom'.format(name), Odometry) for name in NAMES}

    def setUp(self):
        for node in (FIRST, SECOND):
            self.assertTrue(service(node + '/reset', Trigger)().success)
        for client in self.clients.values():
            client.result.clear()
            client.status.clear()

    def test_all_robots_do_exactly_what_the_plain_python_fleet_does(self):
        rng = random.Random(7)
        goals = {name: (rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-3, 3)) for name in NAMES}
        oracle = Fleet(self.scenario)
        for name, goal in goals.items():
            oracle.send(name, *goal)
        oracle.run()
        expected = {entry.robot: entry.time_ns - 1_000_000_000 for entry in oracle.trace if entry.kind == 'ended'}
        ids = {name: self.clients[name].send(pose_stamped(*goal)) for name, goal in goals.items()}
        for name, goal_id in ids.items():
            start_ns = active_since_ns(self.clients[name], goal_id)
            ended = self.clients[name].ending(goal_id)
            self.assertEqual(ended.status.status, GoalStatus.SUCCEEDED, name)
            self.assertEqual(ended.header.stamp.to_nsec() - start_ns, expected[name], name)
            pose = oracle.pose(name)
            self.odom[name].wait_for(lambda odom, pose=pose: (odom.pose.pose.position.x,
                                                              odom.pose.pose.position.y) == (pose.x, pose.y))

    def test_each_robot_has_frames_of_its_own(self):
        buffer = tf2_ros.Buffer(debug=False)
        listener = tf2_ros.TransformListener(buffer)
        for name in NAMES:  # before the listener is connected, the present time is too early
            buffer.lookup_transform('map', name + '/base_link', rospy.Time(), rospy.Duration(200.0))
        for name in NAMES:
            found = buffer.lookup_transform('map', name + '/base_link', rospy.Time.now(), rospy.Duration(200.0))
            spec = next(spec for spec in self.scenario.robots if spec.name == name)
            self.assertAlmostEqual(found.transform.translation.x, spec.settings.start.x, places=9)
            self.assertAlmostEqual(found.transform.translation.y, spec.settings.start.y, places=9)
        listener.unregister()

    def test_goals_in_another_robots_frame_stamped_now_or_ahead_wait_for_its_pose(self):
        ends = []
        for number, (ahead, name) in enumerate(itertools.product((0.0, 0.02, 2.0), NAMES[:5]), 1):
            stamp = rospy.Time.now() + rospy.Duration(ahead)
            pose = pose_stamped(0.1 * number, frame=NAMES[-1] + '/base_link', stamp=stamp)
            ends.append(self.clients[name].ending(self.clients[name].send(pose)).status)
        self.assertEqual({(end.status, end.text) for end in ends}, {REACHED})

    def test_reset_ends_goals_and_brings_robots_home_but_time_goes_on(self):
        client = self.clients['robot_3']
        goal_id = client.send(pose_stamped(500.0))
        start_ns = active_since_ns(client, goal_id)
        self.odom['robot_3'].clear()
        self.assertTrue(service(FIRST + '/reset', Trigger)().success)
        ended = client.ending(goal_id)
        self.assertEqual((ended.status.status, ended.status.text),
                         (GoalStatus.ABORTED, 'Aborting on the goal because the robots have been reset'))
        home = self.odom['robot_3'].wait_for(lambda odom: odom.pose.pose.position.x == 3.0)
        self.assertGreaterEqual(home.header.stamp.to_nsec(), start_ns)
        self.assertEqual(self.clients['robot_3'].status.wait_for(lambda array: not array.status_list).status_list, [])

    def test_a_robot_is_added_works_and_is_removed_without_a_trace(self):
        parameters = parameters_of_all()
        answer = service(SECOND + '/add_robot', AddRobot)('newcomer', 7.0, 8.0, math.pi, 'max_speed: 4.0')
        self.assertTrue(answer.success, answer.message)
        client = RawClient('/newcomer')
        self.assertEqual(client.drive(pose_stamped(7.0, 28.0))[1], 5_000_000_000)
        second = client.send(pose_stamped(900.0))
        client.wait_for_state(second, GoalStatus.ACTIVE)
        self.assertTrue(service(SECOND + '/remove_robot', RemoveRobot)('newcomer').success)
        ended = client.ending(second)
        self.assertEqual((ended.status.status, ended.status.text),
                         (GoalStatus.ABORTED, 'Aborting on the goal because the robot has been removed'))
        publishers, subscribers, services = rosgraph.Master('/fleet_test').getSystemState()
        mine = [(name, nodes) for name, nodes in itertools.chain(publishers, subscribers, services)
                if name.startswith('/newcomer/') and SECOND in nodes]
        self.assertEqual(mine, [])
        self.assertEqual(parameters_of_all(), parameters)
        self.assertTrue(service(SECOND + '/add_robot', AddRobot)('newcomer', 0.0, 0.0, 0.0, '').success)
        self.assertTrue(service(SECOND + '/remove_robot', RemoveRobot)('newcomer').success)

    def test_a_robot_fails_on_request_is_silent_and_is_repaired_and_diagnostics_say_so(self):
        parameters = ('max_speed: 1.0\nfailure_kind: silent\nrepair_distribution: never\n'
                      'battery_capacity: 1.0\nambient_power: 0.0\nfriction_coefficient: 0.0')
        self.assertTrue(service(SECOND + '/add_robot', AddRobot)('patient', 0.0, 0.0, 0.0, parameters).success)
        self.addCleanup(service(SECOND + '/remove_robot', RemoveRobot), 'patient')
        fail, repair = service('/patient/move_base/fail', Fail), service('/patient/move_base/repair', Trigger)
        told = Record('/diagnostics', DiagnosticArray)
        told.wait_for(lambda array: array.status[0].level == DiagnosticStatus.OK)
        client = RawClient('/patient')
        goal_id = client.send(pose_stamped(0.0, 40.0))
        client.wait_for_state(goal_id, GoalStatus.ACTIVE)
        self.assertIn("got 'nap'; allowed: 'abort', 'stall', 'silent' or 'stuck'",
                      fail('nap', rospy.Duration()).message)
        self.assertTrue(fail('', rospy.Duration()).success)
        self.assertFalse(fail('', rospy.Duration()).success)
        failed = told.wait_for(lambda array: array.status[0].level == DiagnosticStatus.ERROR)
        self.assertEqual((failed.status[0].hardware_id, failed.status[0].message), ('patient', 'failed: silent'))
        client.cancel(goal_id)
        for seconds in range(3):  # simulated s; a status under way comes within the first one
            told.clear()
            told.wait_for(lambda array: array.status[0].level == DiagnosticStatus.ERROR)
            if seconds == 0:
                client.status.clear()
        self.assertEqual((client.status.messages, client.endings(goal_id)), ([], []))
        self.assertTrue(repair().success)
        self.assertEqual(client.ending(goal_id).status.status, GoalStatus.PREEMPTED)
        self.assertFalse(repair().success)
        set_battery = service('/patient/move_base/set_battery', SetCharge)
        self.assertIn('allowed: a number in 0..1', set_battery(2.0).message)
        battery = Record('/patient/battery_state', BatteryState)
        self.assertGreater(battery.wait_for().percentage, 0.99)
        self.assertTrue(set_battery(0.0).success)
        state = battery.wait_for(lambda state: state.percentage == 0.0)
        self.assertEqual((state.voltage, state.capacity, state.serial_number), (12.0, 1.0, 'patient'))
        refused = client.ending(client.send(pose_stamped(0.0, 1.0)))
        self.assertEqual((refused.status.status, refused.status.text),
                         (GoalStatus.ABORTED, 'Aborting on the goal because the battery is empty'))
        told.wait_for(lambda array: (array.status[0].level, array.status[0].message) == (
            DiagnosticStatus.ERROR, 'battery empty'))

    def test_parameters_that_were_there_before_a_robot_stay_when_it_is_removed(self):
        of_the_user = {'max_planning_retries': 3, 'of_the_user': 1, 'TrajectoryPlannerROS': {'max_vel_x': 0.75}}
        rospy.set_param('/guest/move_base', of_the_user)
        self.addCleanup(rospy.delete_param, '/guest')
        self.assertTrue(service(FIRST + '/add_robot', AddRobot)('guest', 0.0, 0.0, 0.0, '').success)
        self.assertEqual(rospy.get_param('/guest/move_base'), of_the_user)
        client = Client('/guest/move_base/TrajectoryPlannerROS', timeout=GUARD)
        client.update_configuration({'xy_goal_tolerance': 0.5})
        self.assertEqual(rospy.get_param('/guest/move_base/TrajectoryPlannerROS'),
                         {'max_vel_x': 0.75, 'xy_goal_tolerance': 0.5})
        client.close()
        self.assertTrue(service(FIRST + '/remove_robot', RemoveRobot)('guest').success)
        self.assertEqual(rospy.get_param('/guest/move_base'), of_the_user)

    def test_robots_that_are_added_and_removed_at_the_same_time_do_not_disturb_each_other(self):
        # A proxy for each call, since proxies of Debian 11's rospy do not work in several threads.
        def add(name):
            return service(FIRST + '/add_robot', AddRobot)(name, 0.0, 0.0, 0.0, '')

        def remove(name):
            return service(FIRST + '/remove_robot', RemoveRobot)(name)

        names = ['guest_{}'.format(number) for number in range(6)]
        for call in (add, remove):
            with ThreadPoolExecutor(len(names)) as pool:
                self.assertEqual([answer.message for answer in pool.map(call, names)], [''] * len(names))
            listed = {name for part in rosgraph.Master('/fleet_test').getSystemState() for name, nodes in part
                      if FIRST in nodes}
            there = [name for name in names if '/{}/move_base/status'.format(name) in listed]
            self.assertIn(there, ([], names))
        self.assertEqual(there, [])

    def test_bad_requests_are_refused_with_a_reason(self):
        add = service(FIRST + '/add_robot', AddRobot)
        for arguments, reason in ((('robot_0', 0, 0, 0, ''), 'is there already'),
                                  (('7up', 0, 0, 0, ''), 'a letter first'),
                                  (('ok', math.nan, 0, 0, ''), 'start_x'),
                                  (('ok', 0, 0, 0, 'max_sped: 1'), "did you mean 'max_speed'?"),
                                  (('ok', 0, 0, 0, 'max_speed: -1'), 'a finite number > 0'),
                                  (('ok', 0, 0, 0, 'start_x: 7'), "start_x: unknown here; the request's own field x"),
                                  (('ok', 0, 0, 0, '[' * 50000), 'more than 32 deep'),
                                  (('x' * 70000, 0, 0, 0, ''), 'a letter first'),
                                  (('ok', 0, 0, 0, 'tf_prefix: robot_3'), "'robot_3' and 'ok' would both publish")):
            answer = add(*arguments)
            self.assertFalse(answer.success)
            self.assertIn(reason, answer.message)
            self.assertLess(len(answer.message), 600)
        answer = service(FIRST + '/remove_robot', RemoveRobot)('nobody')
        self.assertFalse(answer.success)
        self.assertIn("robot 'nobody' is unknown", answer.message)
