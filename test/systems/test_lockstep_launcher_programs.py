"""Other people's programs in lockstep by the launcher: ROS's tools, and actionlib and dynamic_reconfigure in scripts.

Each group runs three times: twice at full speed on a loaded machine, once at most 50 times as fast as real time.
"""

import glob
import os
import shutil
import tempfile
import unittest

from lockstep_launcher_run import Scenario, run_programs, run_scenario

SIMULATED = ['--sleep', 'simulated']  # their loops use time.sleep


def installed(package, name):
    """Return the path of a node of an installed package in this distribution."""
    for prefix in ('/usr/lib', '/usr/lib/*', '/opt/ros/*/lib'):
        for path in glob.glob(os.path.join(prefix, package, name)):
            return path
    raise AssertionError('{} of the package {} is not installed'.format(name, package))


class EndTest(unittest.TestCase):
    def test_a_sleep_in_which_the_run_ends_lasts_until_the_node_is_shut_down(self):
        run = run_programs({'ticks': [SIMULATED, 'ticks_beyond_the_end.py']}, until=3.2)
        self.assertEqual(run.printed('ticks'), ['tick'] * 5)  # at 1.5, 2, 2.5 and 3 s, and in the end


class ToolsTest(Scenario, unittest.TestCase):
    """ROS's command line tools and helper nodes."""

    # One node writes a bag that another one reads, and view_frames.py calls `dot`.
    labelled = "run.bag, which '/recorder' writes", "'/view_frames': subprocess.Popen in "

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='lockstep_programs_')
        rostopic = shutil.which('rostopic')
        echo = [SIMULATED, rostopic, 'echo']
        where = os.getcwd()
        os.chdir(cls.folder)  # view_frames writes its files there
        try:
            cls.runs = run_scenario({
                'pub': [rostopic, 'pub', '-r', '2', '/numbers', 'std_msgs/Float64', 'data: 1.5'],
                'pub_once': [rostopic, 'pub', '-1', '/once', 'std_msgs/String', 'data: hi'],
                'pub_latched': [rostopic, 'pub', '/latched', 'std_msgs/String', 'data: kept'],
                'echo': [*echo, '-n', '5', '/numbers'], 'echo_table': [*echo, '-p', '-n', '3', '/sensor'],
                'echo_once': [*echo, '/once'], 'echo_latched': [*echo, '-n', '1', '/latched'],
                'echo_point': [*echo, '/point_x'], 'echo_doubled': [*echo, '/doubled'],
                'hz': [SIMULATED, rostopic, 'hz', '/numbers'],
                'transform': [SIMULATED, installed('topic_tools', 'transform'), '--wait-for-start', '/played/data',
                              '/doubled', 'std_msgs/Float64', 'm * 2'],
                # It does not wait, since the topic is there from the first instant on.
                'transform_now': [installed('topic_tools', 'transform'), '/numbers', '/negative', 'std_msgs/Float64',
                                  'numpy.negative(m.data)'],
                'echo_negative': [*echo, '-n', '3', '/negative'],
                'relay_field': [SIMULATED, installed('topic_tools', 'relay_field'), '--wait-for-start', '/sensor',
                                '/point_x', 'std_msgs/Float64', 'data: m.point.x'],
                'sensor': ['sensor.py', '_rate:=5.0', '_delay:=0.1', '~out:=/sensor', '~other:=/point_x'],
                'recorder': ['bag_writer.py', cls.folder + '/run.bag'],
                'player': ['bag_player.py', cls.folder + '/run.bag'],
                'tf_echo': [installed('tf2_tools', 'echo.py'), 'map', 'robot_0/base_link', '-l', '4'],
                'view_frames': [installed('tf2_tools', 'view_frames.py')],
            }, until=12.0, fleet=[{'name': 'robot_0', 'tf_heartbeat_freq': 2.0}], before=cls.clean)
            with open('frames.gv') as graph:
                cls.graph = graph.read()
        finally:
            os.chdir(where)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def clean(cls):
        for name in os.listdir(cls.folder):
            os.remove(os.path.join(cls.folder, name))

    def printed(self, name):
        return [line for line in super().printed(name) if not line.startswith('WARNING')]

    def test_rostopic_pub_at_a_rate_and_echo(self):
        self.assertEqual(self.printed('echo'), ['data: 1.5', '---'] * 5)

    def test_rostopic_pub_latched_and_once(self):
        self.assertEqual(self.printed('echo_latched'), ['data: "kept"', '---'])
        self.assertEqual(self.printed('echo_once'), ['data: "hi"', '---'])
        self.assertEqual(self.runs[0].codes['pub_once'], 0)

    def test_rostopic_echo_as_a_table(self):
        lines = self.printed('echo_table')
        self.assertTrue(lines[0].startswith('%time,field.header.seq'), lines[0])
        stamps = [int(line.split(',')[2]) for line in lines[1:]]
        self.assertEqual([later - stamps[0] for later in stamps], [0, 200000000, 400000000])

    def test_rostopic_hz(self):
        lines = self.printed('hz')
        rates = [line for line in lines if 'average rate' in line]
        self.assertGreaterEqual(len(rates), 9)
        self.assertEqual(set(rates), {'average rate: 2.000'})
        self.assertIn('\tmin: 0.500s max: 0.500s std dev: 0.00000s window: 19', lines)

    def test_rosbag_written_and_read_in_python(self):
        # Recorded from 1 s to 3.2 s, twice a second. The player finds the bag at its next look, and plays it 1 s later.
        self.assertEqual(self.printed('recorder'), ['{:.9f} numbers 1.5'.format(t) for t in (1.5, 2.0, 2.5, 3.0)])
        self.assertEqual(self.printed('player'), [
            '1.550000000 not yet', '2.050000000 not yet', '2.550000000 not yet', '3.050000000 not yet'] + [
            '{:.9f} 1.5'.format(t) for t in (4.55, 5.05, 5.55, 6.05)])

    def test_topic_tools_transform_and_relay_field(self):
        self.assertEqual(self.printed('echo_doubled'), ['data: 3.0', '---'] * 4)
        self.assertEqual(self.printed('echo_negative'), ['data: -1.5', '---'] * 3)
        points = self.printed('echo_point')[::2]
        self.assertGreaterEqual(len(points), 20)
        first = int(float(points[0].split()[1]))
        self.assertEqual(points, ['data: {:.1f}'.format(first + n) for n in range(len(points))])

    def test_tf2_echo(self):
        times = [line for line in self.printed('tf_echo') if line.startswith('At time')]
        self.assertEqual(times, ['At time {0}, (current time {1})'.format(t - 0.5, float(t)) for t in range(2, 6)])

    def test_tf2_view_frames(self):
        self.assertIn('"map" -> "robot_0/odom"', self.graph.replace('odom_combined', 'odom'))
        self.assertIn('Recorded at time: 6.00001"', self.graph)


class ActionsTest(Scenario, unittest.TestCase):
    """All calls of actionlib's clients and servers, and dynamic_reconfigure."""

    programs = {
        'servers': ['action_servers.py'],
        'client_e': ['action_client.py', '_server:=executing'],
        'client_a': ['action_client.py', '_server:=accepting'],
        'handles': ['action_handles.py'],
        'server': ['configured.py', '_serve:=true'], 'config_client': ['configured.py'],
    }
    until = 30.0

    def test_a_simple_client_of_a_simple_server_that_executes(self):
        self.assertEqual(self.printed('client_e'), [
            '3.000000000 server False', '3.000000000 server True', '3.000000000 no goal False 9',
            "5.000000000 and wait 3 SUCCEEDED 2 'done'",
            # Cancelled after 1.2 s; the server checks twice a second.
            "6.500000000 not in time 2 PREEMPTED 3 'stopped'",
            '6.500000000 active_cb', '6.500000000 feedback_cb 0', '7.000000000 feedback_cb 1',
            '7.500000000 feedback_cb 2',
            "7.750000000 in time False ACTIVE None 'This goal has been accepted by the simple action server'",
            '8.000000000 feedback_cb 3', '8.500000000 feedback_cb 4', '9.000000000 feedback_cb 5',
            '9.500000000 done_cb 3 3', "9.500000000 in time True SUCCEEDED 3 'done'",
            "10.500000000 cancelled PREEMPTED 2 'stopped'", "11.500000000 all cancelled PREEMPTED 2 'stopped'",
            "12.500000000 cancelled by time PREEMPTED 2 'stopped'",
            # The server takes up to 0.1 s to begin with the next goal, as it does in wall time elsewhere.
            "15.100000000 replaced SUCCEEDED 1 'done'",
            '15.100000000 not followed 9 False', "17.100000000 refused ABORTED -3 'no'"])

    def test_a_simple_client_of_a_simple_server_with_callbacks(self):
        lines = self.printed('client_a')
        self.assertIn("5.000000000 and wait 3 SUCCEEDED 1 ''", lines)
        # rospy.Duration(1.2) is 1.199999999 s.
        self.assertIn("6.199999999 not in time 2 PREEMPTED 0 ''", lines)
        for line in ("9.800000000 cancelled PREEMPTED 0 ''", "10.400000000 all cancelled PREEMPTED 0 ''",
                     "11.000000000 cancelled by time PREEMPTED 0 ''"):
            self.assertIn(line, lines)
        servers = self.printed('servers')
        self.assertIn('5.000000000 accepted 9', servers)
        self.assertIn('6.199999999 pre-empt, new goal: False', servers)

    def test_handles_of_many_goals(self):
        lines = self.printed('handles')
        for line in ("1.000000000 REJECTED 0 'never'", "1.500000000 PREEMPTED -1 'cancelled'",
                     "2.000000000 SUCCEEDED 1 'done'", "4.000000000 SUCCEEDED 3 'done'",
                     "4.500000000 PREEMPTED -1 'cancelled'"):
            self.assertIn(line, lines)
        self.assertEqual(lines[-1], '4.510000000 [3, 3, 2, 5, 2]')

    def test_dynamic_reconfigure(self):
        self.assertEqual(self.printed('server'), [
            '1.000000000 speed 1.0 level -1', '2.000000000 speed 2.5 level 1', '3.000000000 speed 10.0 level 1',
            '5.000000000 speed 7.5 level 1'])
        self.assertEqual([line for line in self.printed('config_client') if 'heard' not in line], [
            '2.000000000 got 2.5', '3.000000000 got 10.0', '3.000000000 has 10.0', '6.000000000 has 7.5'])
