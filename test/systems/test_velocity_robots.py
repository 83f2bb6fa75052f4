"""Robots under velocities, driven by nodes of strangers: the same to the byte, and as a hand integral has it."""
import math
import os
import sys
import unittest

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from in_lockstep import InLockstep, assert_same
from nav_msgs.msg import Odometry
from robot_harness import Record
from scenarios import Condition, repeated
from tf2_msgs.msg import TFMessage
from waiting import read, wait_for

from move_base_abstract.engine.chance import Chance, Purpose
from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- on the scaled clock; the runs in lockstep are on ROS masters of the test's own -->
  <include file="$(find move_base_abstract)/launch/velocity_robot.launch">
    <arg name="name" value="scaled"/>
    <arg name="x" value="2.0"/>
    <arg name="map_to_odom" value="true"/>
  </include>
</launch>
"""
FACTOR = 5
OWN_NODE = 'velocity_robots_test'

HERE = os.path.dirname(os.path.abspath(__file__))
UNMODIFIED = os.path.join(HERE, 'unmodified')
BLOCKS = os.path.join(HERE, '..', 'data', 'blocks.yaml')
NS_PER_S = 10 ** 9
#: two robots with the names, the topics and the frames of stage_ros, and one that stands in the way
FLEET = {'defaults': {'driven_by': 'velocities', 'scan_rate': 5.0, 'scan_beams': 37, 'scan_range_max': 6.0,
                      'robot_radius': 0.3, 'base_watchdog_timeout': 0.2},
         'robots': [{'name': 'robot_0', 'start_x': 1.0, 'start_y': -2.0, 'start_yaw': 0.7},
                    {'name': 'robot_1', 'start_y': 3.0},
                    {'name': 'robot_2', 'start_x': 5.0, 'start_y': 3.0}]}
#: a node that takes no part and prints the stamps [ns] of a robot's odometry
ONLOOKER = """
import rospy
from nav_msgs.msg import Odometry
rospy.init_node('onlooker')
rospy.Subscriber('/robot_0/odom', Odometry, lambda message: print(message.header.stamp.to_nsec(), flush=True))
rospy.spin()
"""
#: commands by hand; prints what is asked for
SCRIPT = """#!/usr/bin/env python3
import math, sys
import rospy
from geometry_msgs.msg import Pose, Twist, TwistStamped
from nav_msgs.msg import Odometry
from std_srvs.srv import Empty
rospy.init_node('client')
odometry, truth = [], []
rospy.Subscriber('odom', Odometry, odometry.append)
rospy.Subscriber('base_pose_ground_truth', Odometry, truth.append)
commands = rospy.Publisher('cmd_vel', {type}, queue_size=10)
rospy.wait_for_message('odom', Odometry)

def command(forward, turning=0.0, lateral=0.0):
    message = {type}()
    twist = getattr(message, 'twist', message)
    twist.linear.x, twist.linear.y, twist.angular.z = forward, lateral, turning
    commands.publish(message)

def at(seconds):
    rospy.sleep(rospy.Time.from_sec(seconds) - rospy.Time.now())

def say(message):
    pose, twist = message.pose.pose, message.twist.twist
    yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
    print('%.9f %s %s %.9f %.9f %.9f %.6f %.6f %.6f' % (
        message.header.stamp.to_sec(), message.header.frame_id, message.child_frame_id, pose.position.x,
        pose.position.y, yaw, twist.linear.x, twist.linear.y, twist.angular.z))

{body}
"""


def strangers(condition=Condition(), plays=True, onlooker=False, **clock):
    """Return a run of a commander and an avoider, each with a robot of a fleet, with all messages in its log.

    onlooker: whether a node that takes no part hears odometry; what it heard is ``watched``.
    """
    with InLockstep(['/fleet', '/robot_0/commander', '/robot_1/avoider'], condition, log_messages=True, **clock) as run:
        run.ros.run('fleet', 'fleet', parameters=dict(FLEET, play_output=plays))
        watching = run.ros.spawn('/onlooker', [sys.executable, '-c', ONLOOKER]) if onlooker else None
        run.ros.set_param('/robot_0/commander', {'frames': 'robot_0/'})
        children = [run.ros.spawn(name, [find_executable('lockstep'), os.path.join(UNMODIFIED, program),
                                         '__name:=' + name.rsplit('/', 1)[1], '__ns:=' + name.rsplit('/', 1)[0]])
                    for name, program in (('/robot_0/commander', 'velocity_commander.py'),
                                          ('/robot_1/avoider', 'scan_avoider.py'))]
        with condition.around():
            run.said = [said.splitlines() for said in run.end_of(*children)]
        run.watched = [int(line) for line in read(watching).splitlines() if line.isdigit()] if watching else []
    return run


def by_hand(body, message='Twist', world=None, beside=(), **parameters):
    """Return (what a client printed, as rows of words; the run) with one robot in the namespace /r; world: a map.

    beside: other nodes of this package, (executable, parameters), ...
    """
    with InLockstep(['/r/velocity_robot', '/r/client', *('/' + name for name, _ in beside)], log_messages=True) as run:
        script = os.path.join(run.ros.log_dir, 'client.py')
        with open(script, 'w', encoding='utf-8') as stream:
            stream.write(SCRIPT.format(type=message, body=body))
        for name, others in beside:
            run.ros.run(name, name, parameters=others)
        if world:
            run.ros.run('map_server', 'map_server', arguments=[world])
        run.ros.run('velocity_robot', 'velocity_robot', '/r', dict(parameters, use_map=bool(world)))
        said, = run.end_of(run.ros.spawn('/r/client', [find_executable('lockstep'), script, '__name:=client',
                                                       '__ns:=/r']))
    return [line.split() for line in said.splitlines()], run


class Strangers(unittest.TestCase):
    """Each test compares with one run in which the fleet gets a grant for each of its turns."""

    @classmethod
    def setUpClass(cls):
        cls.plain = strangers(plays=False)

    def test_the_plain_run_is_worth_comparing(self):
        commander, avoider = self.plain.said
        self.assertIn('robot_0/odom', commander[-1])
        self.assertIn(' at 0.000 m/s', commander[-1])
        self.assertEqual(len(avoider), 61)
        self.assertGreater(int(avoider[-1].split()[3]), 5, avoider)
        topics = [robot for _, robot, kind, _ in self.plain.events if kind == 'message']
        for topic, least in (('/robot_0/odom', 100), ('/robot_0/cmd_vel', 100), ('/robot_1/base_scan', 50),
                             ('/tf', 100)):
            self.assertGreater(topics.count(topic), least, topic)
        self.assertEqual((self.plain.end['not_repeatable_because'], self.plain.end['degraded_because']), ([], []))

    def test_every_message_is_the_same_whatever_else_happens_and_when_the_time_master_plays(self):
        for run in repeated('driven by strangers', strangers, lambda run: repr((run.said, run.events)).encode()):
            self.assertEqual(run.said, self.plain.said)
            assert_same(self, self.plain.events, run.events)
            self.assertEqual(run.end['not_repeatable_because'], [])

    def test_an_onlooker_hears_odometry_and_changes_nothing(self):
        run = strangers(Condition(speed_limit=10.0), onlooker=True)
        assert_same(self, self.plain.events, run.events)
        self.assertGreater(len(run.watched), 50)
        self.assertEqual(run.watched, sorted(run.watched))

    def test_with_a_lookahead_the_same_messages_come_however_they_are_made(self):
        runs = [strangers(plays=plays, lookahead=0.04) for plays in (False, True)]
        self.assertEqual(runs[0].said, runs[1].said)
        assert_same(self, runs[0].events, runs[1].events)

    def test_a_node_of_its_own_drives_as_a_robot_of_a_fleet(self):
        own = {**FLEET['defaults'], **FLEET['robots'][0], 'tf_prefix': 'robot_0'}
        del own['name']
        with InLockstep(['/robot_0/velocity_robot', '/robot_0/commander']) as run:
            run.ros.run('velocity_robot', 'velocity_robot', '/robot_0', own)
            run.ros.set_param('/robot_0/commander', {'frames': 'robot_0/'})
            said, = run.end_of(run.ros.spawn('/robot_0/commander', [
                find_executable('lockstep'), os.path.join(UNMODIFIED, 'velocity_commander.py'), '__name:=commander',
                '__ns:=/robot_0']))
        self.assertEqual(said.splitlines(), self.plain.said[0])

    def test_tf_and_odometry_are_one(self):
        words = self.plain.said[0][-1].replace(';', '').split()
        self.assertEqual(words[2:4], words[-2:])


class ByHand(unittest.TestCase):
    """Each test drives one robot, and has its log."""

    maxDiff = 3000

    def test_an_arc_is_that_of_a_hand_integral_and_odometry_begins_where_the_robot_starts(self):
        rows, _ = by_hand('at(3.0); command(0.5, 0.25); at(3.4); command(0.5, 0.25); at(3.85); say(odometry[-1]); '
                          'say(truth[-1])', start_x=2.0, start_y=-1.0, start_yaw=0.5, tf_prefix='r')
        seconds, odom, base, *odometry = rows[0]
        self.assertEqual((float(seconds), odom, base), (3.8, 'r/odom', 'r/base_link'))
        turned = 0.25 * 0.8
        wanted = [2.0 * math.sin(turned), 2.0 * (1.0 - math.cos(turned)), turned, 0.5, 0.0, 0.25]
        for got, hand in zip(map(float, odometry), wanted):
            self.assertAlmostEqual(got, hand, delta=2e-9)
        x, y = wanted[:2]
        for got, hand in zip(map(float, rows[1][3:6]), (2.0 + x * math.cos(0.5) - y * math.sin(0.5),
                                                        -1.0 + x * math.sin(0.5) + y * math.cos(0.5), 0.7)):
            self.assertAlmostEqual(got, hand, delta=2e-9)
        self.assertEqual(rows[1][1], 'map')

    def test_the_watchdog_stops_the_robot_at_its_instant_and_both_names_work(self):
        for name, seconds in (('cmd_vel_timeout', 0.35), ('base_watchdog_timeout', 0.2), (None, 0.5)):
            _, run = by_hand('at(3.0); command(1.0); at(6.0)', **({name: seconds} if name else {}))
            stands = [event for event in run.events if event[2] == 'stands' and event[0] > 2 * NS_PER_S]
            self.assertEqual([event[0] for event in stands], [int((3.0 + seconds) * NS_PER_S)], name)
            self.assertAlmostEqual(stands[0][3][0], seconds, delta=1e-9)

    def test_what_is_no_velocity_is_refused_and_the_command_before_it_goes_on(self):
        body = ("at(3.0); command(1.0); at(3.2); command(float('nan')); command(0.0, float('inf')); at(6.0); "
                'say(odometry[-1])')
        rows, run = by_hand(body)
        self.assertAlmostEqual(float(rows[0][3]), 0.5, delta=1e-9)
        self.assertEqual(run.end['not_repeatable_because'], [])

    def test_stamped_commands_and_sideways(self):
        rows, _ = by_hand('at(3.0); command(0.3, 0.0, 0.4); at(5.0); say(odometry[-1])', 'TwistStamped',
                          use_stamped_vel=True, holonomic=True)
        self.assertEqual([float(word) for word in rows[0][3:5]], [0.15, 0.2])

    def test_a_teleport_and_a_reset(self):
        body = ('place = rospy.Publisher("cmd_pose", Pose, queue_size=1); there = Pose(); there.position.x = 7.0; '
                'there.orientation.w = 1.0; at(3.0); place.publish(there); at(3.95); say(truth[-1]); '
                'rospy.ServiceProxy("reset_positions", Empty)(); at(5.0); say(truth[-1]); say(odometry[-1])')
        rows, _ = by_hand(body, start_x=1.0)
        self.assertEqual([float(row[3]) for row in rows], [7.0, 1.0, 0.0])

    def test_a_wall_of_the_map_stops_the_robot_where_it_touches(self):
        rows, run = by_hand('at(3.0); command(0.5); at(7.0); say(odometry[-1])', world=BLOCKS, start_y=0.5,
                            robot_radius=0.3, cmd_vel_timeout=0.0, scan_rate=5.0)
        self.assertAlmostEqual(float(rows[0][3]), 1.7, delta=5e-6)
        (at_ns, _, _, values), = [event for event in run.events if event[2] == 'stalled']
        self.assertAlmostEqual(at_ns / NS_PER_S, 6.4, delta=1e-5)
        self.assertEqual(values, ['wall'])

    def test_frames_and_topics_have_the_names_that_parameters_give(self):
        body = ('from tf2_msgs.msg import TFMessage; seen = []; rospy.Subscriber("/tf", TFMessage, seen.append); '
                'at(4.05); say(odometry[-1]); '
                'print("tf", *sorted({one.child_frame_id for message in seen for one in message.transforms}))')
        rows, _ = by_hand(body, base_frame_id='chassis', odom_frame_id='wheels', publish_rate=50.0,
                          odom_origin=[1.0, 0.0, 0.0])
        self.assertEqual([rows[0][:4], rows[1]],
                         [['4.040000000', 'wheels', 'chassis', '-1.000000000'], ['tf', 'chassis']])
        rows, _ = by_hand(body, enable_odom_tf=False)
        self.assertEqual([rows[0][:3], rows[1]], [['4.000000000', 'odom', 'base_link'], ['tf']])
        rows, _ = by_hand(body, footprint_frame='', publish_map_frame=True)
        self.assertEqual(rows[1], ['tf', 'base_link', 'odom'])

    def test_a_robot_that_has_failed_stands_and_loses_commands(self):
        body = ('from move_base_abstract.srv import Fail; rospy.wait_for_service("velocity_robot/fail"); '
                'at(3.0); command(0.5); at(3.41); '
                'print(rospy.ServiceProxy("velocity_robot/fail", Fail)("stall", rospy.Duration(2.0)).success); '
                'at(4.0); command(0.5); at(5.35); say(odometry[-1]); at(5.55); say(odometry[-1]); command(0.5); '
                'at(6.05); say(odometry[-1])')
        rows, run = by_hand(body, failure_kind='stall', cmd_vel_timeout=0.0)
        self.assertEqual(rows[0], ['True'])
        self.assertEqual([(float(row[0]), round(float(row[3]), 6)) for row in rows[1:]],
                         [(5.3, 0.205), (5.5, 0.205), (6.0, 0.43)])
        self.assertEqual(run.end['not_repeatable_because'], [])

    def test_a_fleet_adds_and_removes_such_robots(self):
        body = ('from move_base_abstract.srv import AddRobot, RemoveRobot; rospy.wait_for_service("/fleet/add_robot"); '
                'answer = rospy.ServiceProxy("/fleet/add_robot", AddRobot)("other", 1.0, 0.0, 0.0, '
                '"{driven_by: velocities, cmd_vel_timeout: 0.0}"); print(answer.success); '
                'drive = rospy.Publisher("/other/cmd_vel", Twist, queue_size=1); twist = Twist(); '
                'twist.linear.x = 0.5; at(4.0); drive.publish(twist); at(6.05); '
                'say(rospy.wait_for_message("/other/odom", Odometry)); '
                'rospy.ServiceProxy("/reset_positions", Empty)(); '
                'say(rospy.wait_for_message("/other/odom", Odometry)); '
                'print(rospy.ServiceProxy("/fleet/remove_robot", RemoveRobot)("other").success); at(8.0); '
                'print(any(name.startswith("/other/odom") for name, _ in rospy.get_published_topics()))')
        rows, run = by_hand(body, beside=[('fleet', {'robots': []})])
        self.assertEqual([rows[0], float(rows[1][3]), float(rows[2][3]), *rows[3:]],
                         [['True'], 1.025, 0.0, ['True'], ['False']])
        self.assertEqual(run.end['not_repeatable_because'], [])

    def test_odometry_that_is_wrong_is_played_as_if_it_were_not_and_the_truth_is_true(self):
        body = ('from tf2_msgs.msg import TFMessage; rospy.Subscriber("/tf", TFMessage, lambda _message: None); '
                'at(3.0); command(0.5, 0.25); at(3.45); say(odometry[-1]); say(truth[-1])')
        runs = [by_hand(body, odom_error=[0.2, 0.0, 0.0, 0.4], seed=7, play_output=plays, publish_map_frame=True)
                for plays in (True, False)]
        (rows, run), (_, other) = runs
        assert_same(self, run.events, other.events)
        chance = Chance(7, 'r')
        forward, turning = (one * (1.0 + most * (chance.uniform(0, Purpose.ODOMETRY, place) - 0.5))
                            for place, one, most in ((0, 0.5, 0.2), (2, 0.25, 0.4)))
        for row, (speed, rate) in zip(rows, ((forward, turning), (0.5, 0.25))):
            turned = rate * 0.4
            radius = speed / rate
            wanted = [radius * math.sin(turned), radius * (1.0 - math.cos(turned)), turned, speed, 0.0, rate]
            for got, hand in zip(map(float, row[3:]), wanted):
                self.assertAlmostEqual(got, hand, delta=1e-6)
        self.assertGreater(abs(forward - 0.5), 1e-3)

    def test_a_fleet_resets_all_as_stage_ros_does(self):
        body = ('drive = rospy.Publisher("/one/cmd_vel", Twist, queue_size=1); twist = Twist(); twist.linear.x = 0.5; '
                'at(4.0); drive.publish(twist); at(4.3); rospy.ServiceProxy("/reset_positions", Empty)(); at(5.0); '
                'say(rospy.wait_for_message("/one/odom", Odometry))')
        rows, run = by_hand(body, beside=[('fleet', {'robots': [{'name': 'one', 'driven_by': 'velocities'}]})])
        self.assertEqual(float(rows[0][3]), 0.0)
        stands = [event for event in run.events if event[1] == 'one' and event[2] == 'stands']
        self.assertAlmostEqual(stands[-1][0] / NS_PER_S, 4.3, delta=1e-8)

    def test_limits_of_diff_drive_controller(self):
        rows, _ = by_hand('at(3.0); command(2.0); at(3.05); say(odometry[-1]); at(4.0); command(2.0); at(4.2); '
                          'say(odometry[-1])',
                          cmd_vel_timeout=5.0, pose_update_freq=100.0, linear={'x': {
                              'has_velocity_limits': True, 'max_velocity': 0.8, 'has_acceleration_limits': True,
                              'max_acceleration': 1.0}})
        self.assertEqual([float(row[6]) for row in rows], [0.06, 0.8])


class Scaled(unittest.TestCase):
    """The same node on the scaled clock, where commands come when they come."""

    def test_it_drives_while_commands_come_stops_after_the_last_one_and_is_put_elsewhere(self):
        odometry, transforms = Record('/scaled/odom', Odometry), Record('/tf', TFMessage)
        commands = rospy.Publisher('/scaled/cmd_vel', Twist, queue_size=1)
        places = rospy.Publisher('/scaled/initialpose', PoseWithCovarianceStamped, queue_size=1)
        wait_for('connections', lambda: commands.get_num_connections() and places.get_num_connections())
        ahead = Twist()
        ahead.linear.x = 0.5
        while not (odometry.messages and odometry.messages[-1].pose.pose.position.x > 1.0):
            commands.publish(ahead)
            rospy.sleep(0.1)
        still = odometry.wait_for(lambda message: not message.twist.twist.linear.x, 'a stop', len(odometry.messages))
        self.assertEqual((still.header.frame_id, still.child_frame_id), ('scaled/odom', 'scaled/base_link'))
        there = PoseWithCovarianceStamped()
        there.header.frame_id, there.pose.pose.position.x, there.pose.pose.orientation.w = 'map', -3.0, 1.0
        places.publish(there)
        odometry.wait_for(lambda message: message.pose.pose.position.x == -5.0, 'the jump')
        frames = [(one.header.frame_id, one.child_frame_id) for one in transforms.messages[-1].transforms]
        self.assertEqual(frames, [('map', 'scaled/odom'), ('scaled/odom', 'scaled/base_footprint'),
                                  ('scaled/base_footprint', 'scaled/base_link')])


if __name__ == '__main__':
    unittest.main()
