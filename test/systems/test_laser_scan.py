"""Laser scans are those of the plain Python fleet, to the bit, at exact instants, at the pose of the laser in tf."""
import hashlib
import os
import struct
import unittest

import rospy
from lockstep_launcher_run import Scenario, run_programs, run_scenario
from robot_harness import GUARD
from sensor_msgs.msg import LaserScan

from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import make_scenario
from move_base_abstract_ros.loopback import find_executable

LAUNCH_FILE = """
<launch>  <!-- a robot that scans on the scaled clock; the runs in lockstep are on ROS masters of the test's own -->
  <include file="$(find move_base_abstract)/launch/time_master.launch"/>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="scaled" required="true">
    <rosparam>{scan_rate: 5.0, scan_topic: laser, tf_prefix: scaled, scan_frame: laser}</rosparam>
  </node>
</launch>
"""
OWN_NODE = 'laser_scan_test'

MAP = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'maps', 'farm_yard.yaml')
LASER = {'scan_rate': 10.0, 'scan_beams': 181, 'scan_noise': 0.02, 'scan_x': 0.2, 'scan_y': -0.1, 'scan_yaw': 0.3,
         'scan_range_max': 20.0}
ROBOTS = [dict(LASER, name='robot_0', max_speed=1.0, use_map=True, seed=5, start_x=10.0, start_y=4.0, turn_rate=1.0),
          {'name': 'robot_1', 'max_speed': 1.0, 'start_x': 14.0, 'start_y': 4.0, 'robot_radius': 0.4}]
SERVER = {'/map_server': ([find_executable('map_server'), MAP], 0)}
MS = 1_000_000  # ns
SENT_NS = 2500 * MS


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
        for _, stamp, found, count, _, x, y in self.rows:
            digest, pose = expected[int(stamp)]
            self.assertEqual((found, int(count)), (digest, 181), stamp)
            self.assertAlmostEqual(float(x), pose.x, places=8)
            self.assertAlmostEqual(float(y), pose.y, places=8)

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
