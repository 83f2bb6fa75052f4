"""What robots publish in lockstep, and on the scaled clock: laser scans, odometry at rest, and their events."""
import hashlib
import json
import os
import struct
import unittest

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from lockstep_launcher_run import Scenario, run_programs, run_scenario
from nav_msgs.msg import Odometry
from robot_harness import GUARD, Record
from sensor_msgs.msg import LaserScan

from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import make_scenario
from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- robots on the scaled clock; the runs in lockstep are on ROS masters of the test's own -->
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="scaled" required="true">
    <rosparam>{scan_rate: 5.0, scan_topic: laser, tf_prefix: scaled, scan_frame: laser}</rosparam>
  </node>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot_0" required="true">
    <rosparam>{max_speed: 1.0, start_x: 1.0}</rosparam>
  </node>
</launch>
"""
FACTOR = 10
OWN_NODE = 'robot_topics_test'

HERE = os.path.dirname(os.path.abspath(__file__))
MAP = os.path.join(HERE, '..', '..', 'maps', 'farm_yard.yaml')
LASER = {'scan_rate': 10.0, 'scan_beams': 181, 'scan_noise': 0.02, 'scan_x': 0.2, 'scan_y': -0.1, 'scan_yaw': 0.3,
         'scan_z': 0.25,
         'scan_range_max': 20.0}
ROBOTS = [dict(LASER, name='robot_0', max_speed=1.0, use_map=True, seed=5, start_x=10.0, start_y=4.0, turn_rate=1.0),
          {'name': 'robot_1', 'max_speed': 1.0, 'start_x': 14.0, 'start_y': 4.0, 'robot_radius': 0.4}]
SERVER = {'/map_server': ([find_executable('map_server'), MAP], 0)}
MS = 1_000_000  # ns
SENT_NS = 2500 * MS
PROGRAM = {'odometer': ['odometer.py']}
ASKED = [{'name': 'robot_0', 'odom_rate_at_rest': 5.0, 'pose_update_freq': 10.0}, {'name': 'robot_1'}]
READER = os.path.join(HERE, 'robot_event_reader.py')
KINDS = ('goal', 'departed', 'stands', 'ended', 'battery')


def scans_of_the_plain_fleet(stamps):
    """Return {stamp [ns]: (SHA-1 of the ranges, Pose2D of the laser)}."""
    fleet = Fleet(make_scenario({'robots': ROBOTS}), occupancy=load_map(read_description(MAP)))
    found = {}
    for stamp_ns in stamps:
        fleet.run(stamp_ns)
        scan = fleet.robot('robot_0').scan()
        data = struct.pack('<{}f'.format(len(scan.ranges)), *scan.ranges)
        found[stamp_ns] = hashlib.sha1(data).hexdigest(), scan.pose
        if stamp_ns == SENT_NS:  # a robot's own event comes before a goal at the same instant
            fleet.robot('robot_0').send(13.0, 6.0)
            fleet.robot('robot_1').send(12.0, 4.0)
    return found


class LaserScans(Scenario, unittest.TestCase):
    """They are those of the plain Python fleet, to the bit, at exact instants, at the pose of the laser in tf."""

    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario({'scanner': ['scanner.py']}, until=8.0, fleet=ROBOTS, others=SERVER)
        cls.rows = [line.split() for line in cls.runs[0].printed('scanner')]

    def test_they_come_at_multiples_of_the_period(self):
        self.assertEqual({row[0] for row in self.rows}, {'scan'})
        stamps = [int(row[1]) for row in self.rows]
        self.assertIn(stamps[0], (1000 * MS, 1100 * MS))
        self.assertEqual(stamps, [stamps[0] + 100 * MS * number for number in range(len(stamps))])
        self.assertGreater(stamps[-1], 7800 * MS)

    def test_they_are_those_of_the_plain_fleet_and_tf_has_the_laser_there(self):
        expected = scans_of_the_plain_fleet([int(row[1]) for row in self.rows])
        self.assertGreater(len({one for one, _ in expected.values()}), 50)
        for _, stamp, found, count, _, x, y, z in self.rows:
            digest, pose = expected[int(stamp)]
            self.assertEqual((found, int(count)), (digest, 181), stamp)
            self.assertAlmostEqual(float(x), pose.x, places=8)
            self.assertAlmostEqual(float(y), pose.y, places=8)
            self.assertAlmostEqual(float(z), 0.25)

    def test_whether_they_are_heard_changes_nothing_that_others_are_told(self):
        deaf = run_programs({'scanner': [['--'], 'scanner.py', '_topic:=nothing']}, until=8.0, fleet=ROBOTS,
                            others=SERVER)

        def events(run):
            return [line for line in run.log.split(b'\n') if b'LaserScan' not in line and b'/scan' not in line][1:-2]
        self.assertEqual(deaf.printed('scanner'), [])
        self.assertEqual([line for line in events(deaf) if b'/tf' in line],
                         [line for line in events(self.runs[0]) if b'/tf' in line])

    def test_on_the_scaled_clock_they_come_at_multiples_too(self):
        scan = rospy.wait_for_message('/scaled/laser', LaserScan, GUARD)
        self.assertEqual(scan.header.stamp.to_nsec() % (200 * MS), 0)
        self.assertEqual((scan.header.frame_id, len(scan.ranges), scan.ranges[0]), ('scaled/laser', 361, float('inf')))


class OdometryAtRest(Scenario, unittest.TestCase):
    """It is as on the way on the scaled clock, and comes at the wanted rate in lockstep."""

    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario(PROGRAM, until=6.0, fleet=ASKED)

    def heard(self, run, robot, topic):
        """Return [(stamp [ms], x [m], speed [m/s])] of the messages that the program heard."""
        rows = [line.split() for line in run.printed('odometer')]
        return [(int(row[2]) / MS, float(row[3]), row[4]) for row in rows if row[:2] == [robot, topic]]

    def test_in_lockstep_it_comes_at_multiples_of_its_period_from_the_instant_at_which_the_robot_stands(self):
        for topic in ('odom', 'base_pose_ground_truth'):
            rows = self.heard(self.runs[0], 'robot_0', topic)
            before = [row for row in rows if row[1] == 0.0 and row[2] == '0.0']
            self.assertEqual([stamp for stamp, *_ in before], [1000, 1200, 1400, 1600, 1800, 2000, 2200, 2400, 2600,
                                                               2800, 3000])
            departed = max(stamp for stamp, x, _ in rows if x == 0.0)
            self.assertEqual(departed, 3050)
            after = [row for row in rows if row[1] == 1.0]
            self.assertEqual([stamp for stamp, *_ in after], [4050 + 200 * number for number in range(10)])
            way = [row for row in rows if 0.0 < row[1] < 1.0]
            self.assertEqual([stamp for stamp, *_ in way], [3150 + 100 * number for number in range(9)])

    def test_who_does_not_ask_hears_what_it_heard_and_amcl_is_silent_at_rest(self):
        self.assertEqual([stamp for stamp, *_ in self.heard(self.runs[0], 'robot_1', 'odom')], [1000])
        stamps = [stamp for stamp, *_ in self.heard(self.runs[0], 'robot_0', 'amcl_pose')]
        self.assertEqual(stamps[0], 1000)
        self.assertEqual((stamps[1], stamps[-1]), (3050, 4050))

    def test_on_the_scaled_clock_it_is_that_of_the_way(self):
        odometry = Record.fresh('/robot_0/odom', Odometry)
        poses = Record.fresh('/robot_0/amcl_pose', PoseWithCovarianceStamped)
        first = odometry.wait_for().header.stamp
        odometry.wait_for(lambda message: (message.header.stamp - first).to_sec() >= 5.0)
        stamps = sorted({message.header.stamp.to_nsec() for message in odometry.messages})
        self.assertTrue(all(step % (100 * MS) == 0 for step in (b - a for a, b in zip(stamps, stamps[1:]))))
        self.assertGreater(len(stamps), 3, 'a busy machine may leave many out')
        self.assertEqual({message.pose.pose.position.x for message in odometry.messages}, {1.0})
        self.assertLessEqual(len(poses.messages), 1)


class RobotEvents(Scenario, unittest.TestCase):
    """~events has the rows of the event log in its order, and programs that react to it repeat exactly."""

    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario({'event_reader': [READER]}, until=40.0, fleet=[
            {'name': 'robot_0', 'battery_capacity': 0.5, 'battery_thresholds': [0.9999, 0.9998]},
            {'name': 'robot_1', 'start_y': 4.0}])

    def test_it_has_the_rows_of_the_event_log_in_their_order(self):
        rows = []
        for line in self.runs[0].log.decode().splitlines()[1:-1]:
            row = json.loads(line)
            if row['kind'] in KINDS:
                texts = [value for value in row['values'] if isinstance(value, str)]
                numbers = [float(value) for value in row['values'] if not isinstance(value, str)]
                rows.append('{} {} {} {} {}'.format(row['time_ns'], row['robot'], row['kind'], texts, numbers))
        heard = self.runs[0].printed('event_reader')
        self.assertEqual(heard, rows[:len(heard)])
        self.assertLess(len(rows) - len(heard), 4)  # the events at the very end were not heard
        self.assertEqual({line.split()[2] for line in heard}, set(KINDS))
        self.assertEqual({line.split()[1] for line in heard}, {'robot_0', 'robot_1'})
