"""Odometry of a robot at rest: as on the way on the scaled clock, and at the wanted rate in lockstep."""
import unittest

from geometry_msgs.msg import PoseWithCovarianceStamped
from lockstep_launcher_run import Scenario, run_scenario
from nav_msgs.msg import Odometry
from robot_harness import Record

LAUNCH_FILE = """
<launch>  <!-- a robot whose odometry goes on while it stands; runs in lockstep are on ROS masters of their own -->
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot_0" required="true">
    <rosparam>{max_speed: 1.0, start_x: 1.0}</rosparam>
  </node>
</launch>
"""
FACTOR = 10
OWN_NODE = 'odometry_at_rest_test'

MS = 1_000_000  # ns
PROGRAM = {'odometer': ['odometer.py']}
ASKED = [{'name': 'robot_0', 'odom_rate_at_rest': 5.0, 'pose_update_freq': 10.0}, {'name': 'robot_1'}]


class OdometryAtRest(Scenario, unittest.TestCase):
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
