"""How the Python nodes start and end: signals, a ROS master or a time master that dies, command lines, full disks.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""
import errno
import os
import signal
import socket
import subprocess
import sys
import unittest
from unittest import mock

import rosgraph
import rospkg
from waiting import GUARD, read, wait_for, wait_for_words

from move_base_abstract_ros.loopback import Loopback, find_executable

SHARE = rospkg.RosPack().get_path('move_base_abstract')
MAP = os.path.join(SHARE, 'maps', 'field.yaml')
FAKE_GAZEBO = os.path.join(SHARE, 'test', 'data', 'gazebo_fake')
#: name, executable, parameters, arguments, end of the name of the topic or service that it makes last
NODES = (('single', 'move_base', {}, (), '/move_base_simple/goal'),
         ('original', 'move_base_abstract_actionserver', {}, ('robot_9',), '/move_base_simple/goal'),
         ('many', 'fleet', {'robots': [{'name': 'robot', 'count': 3}]}, (), '/reset'),
         ('tasks', 'task_server', {'robots': ['a', 'b']}, (), '/b/work/goal'),
         ('maps', 'map_server', {}, (MAP,), '/static_map'))
#: a node that prints whether init_node slept for long, and whether its registrations were woken at the end
WAITS = """
import time
slept = []
sleep = time.sleep
time.sleep = lambda seconds: (slept.append(seconds), sleep(seconds))
from move_base_abstract_ros.replacing import rospy_start
import rospy
from rospy.impl import masterslave
from rospy.impl.registration import get_registration_listeners
looks = []
registered = masterslave.ROSHandler._is_registered
masterslave.ROSHandler._is_registered = lambda handler: looks.append(1) or len(looks) > 2 and registered(handler)
rospy_start.shorten_waits()
rospy.init_node('waits', disable_signals=True)
print('no long look' if max(slept) < 0.01 else slept)
manager = next(one for one in get_registration_listeners().listeners if hasattr(one, 'cond'))
woken, wait = [], manager.cond.wait
manager.cond.wait = lambda seconds: woken.append(wait(seconds))
while not woken:
    sleep(0.001)
rospy.signal_shutdown('it is over')
print(woken[-1])
"""
#: a node that ends before the thread that accepts connections has run its first line, which forgets the end
ENDS_EARLY = """
import threading
from move_base_abstract_ros.replacing import rospy_start
rospy_start.prepare()
from rospy.impl import tcpros_base
server = tcpros_base.TCPServer(None)
server.shutdown()
thread = threading.Thread(target=server.run)
thread.start()
thread.join()
other = tcpros_base.TCPServer(None)
other.server_sock.shutdown(2)  # accept fails, although nobody has closed the socket
try:
    other.run()
except OSError as error:
    print('still an error:', error.errno)
"""
SOIL_COORDINATOR = ('lockstep', '--own', 'soil_mapping.ros.soil_coordinator')
WITHOUT_ARGUMENTS = (('fleet',), ('task_server',), SOIL_COORDINATOR)


def run(*words, master='http://127.0.0.1:1/'):
    """Run a program that ends by itself; return (exit code, output)."""
    environment = dict(os.environ, ROS_MASTER_URI=master)
    done = subprocess.run([find_executable(words[0]), *words[1:]], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=GUARD, env=environment, universal_newlines=True,
                          check=False)
    return done.returncode, done.stdout


class EndTest(unittest.TestCase):
    def start(self, ros):
        """Start a node of each kind; return {name: child}. map_server adds to its name."""
        return {name: ros.run(executable, name, parameters=parameters, arguments=arguments)
                for name, executable, parameters, arguments, _ in NODES}

    def ended(self, child):
        """Wait until a child ends by itself; return (exit code, output)."""
        wait_for(child.name + ' ends', lambda: child.process.poll() is not None)
        return child.process.returncode, child.name + ' said: ' + read(child)

    def wait_for_clock(self, ros, names):
        """Wait until the nodes have begun to set up: they listen to /clock and get none."""
        master = rosgraph.Master('/test', master_uri=ros.uri)
        for name in names:
            wait_for(name + ' listens to /clock', lambda name=name: any(
                topic == '/clock' and any(node.startswith('/' + name) for node in nodes)
                for topic, nodes in master.getSystemState()[1]))

    def wait_until_ready(self, ros):
        """Wait until each node has the topic or service that it makes last."""
        master = rosgraph.Master('/test', master_uri=ros.uri)
        for name, _, _, _, last in NODES:
            wait_for(name + ' is ready', lambda name=name, last=last: any(
                topic.endswith(last) and any(node.startswith('/' + name) for node in nodes)
                for part in master.getSystemState() for topic, nodes in part))

    def assert_no_traceback(self, log):
        self.assertNotIn('Traceback', log)
        self.assertNotIn('did not end within', log)

    def assert_signals_end(self, children):
        """Send all nodes SIGINT or SIGTERM, in turn, and assert that they end in order."""
        for index, child in enumerate(children.values()):
            child.process.send_signal((signal.SIGINT, signal.SIGTERM)[index % 2])
        for child in children.values():
            code, log = self.ended(child)
            self.assertEqual(code, 0, log)
            self.assert_no_traceback(log)

    def test_signals_end_each_node_while_it_waits_for_the_clock(self):
        with Loopback() as ros:
            children = self.start(ros)
            self.wait_for_clock(ros, children)
            self.assert_signals_end(children)

    def test_signals_end_each_node_that_is_ready(self):
        with Loopback(use_sim_time=False) as ros:
            children = self.start(ros)
            self.wait_until_ready(ros)
            self.assert_signals_end(children)
            left = str(rosgraph.Master('/test', master_uri=ros.uri).getSystemState())
            self.assertEqual([name for name in children if '/' + name in left], [])

    def test_a_signal_ends_a_node_that_waits_for_a_ros_master(self):
        with Loopback() as ros, socket.socket() as taken:
            taken.bind(('127.0.0.1', 0))  # nobody listens there, and no other test can
            own, ros.uri = ros.uri, 'http://127.0.0.1:{}/'.format(taken.getsockname()[1])
            child = ros.spawn('node', [find_executable('fleet')])
            ros.uri = own
            wait_for('it says what it waits for', lambda: 'master may not be running yet' in read(child))
            child.process.send_signal(signal.SIGTERM)
            code, log = self.ended(child)
            self.assertEqual(code, 0, log)
            self.assert_no_traceback(log)

    def test_a_node_ends_when_its_ros_master_dies_while_it_starts(self):
        with Loopback() as ros:
            children = self.start(ros)
            self.wait_for_clock(ros, children)
            ros._children[0].process.kill()
            for child in children.values():
                code, log = self.ended(child)
                self.assertEqual(code, 1, log)
                self.assertRegex(log, 'the ROS master at {} (has gone while|does not answer)'.format(ros.uri))
                self.assert_no_traceback(log)

    def test_a_signal_ends_a_node_whose_ros_master_hangs(self):
        with Loopback() as ros:
            children = self.start(ros)
            self.wait_for_clock(ros, children)
            ros._children[0].process.send_signal(signal.SIGSTOP)
            self.assert_signals_end(children)
            ros._children[0].process.send_signal(signal.SIGCONT)

    def test_rospy_waits_no_longer_than_it_must(self):
        with Loopback(use_sim_time=False) as ros:
            environment = dict(ros.environment, PYTHONPATH=os.pathsep.join(filter(None, sys.path)))
            done = subprocess.run([sys.executable, '-c', WAITS], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  timeout=GUARD, env=environment, universal_newlines=True, check=False)
        self.assertEqual(done.stdout.split(), ['no', 'long', 'look', 'True'])

    def test_an_end_before_the_first_connection_is_no_error(self):
        environment = dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, sys.path)))
        done = subprocess.run([sys.executable, '-c', ENDS_EARLY], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=GUARD, env=environment, universal_newlines=True,
                              check=False)
        self.assertEqual(done.stdout, 'still an error: {}\n'.format(errno.EINVAL))

    def test_a_time_master_that_is_killed_is_named_once(self):
        with Loopback() as ros:
            clock = ros.run('time_master', 'time_master', parameters={'mode': 'scaled', 'factor': 20.0})
            children = self.start(ros)
            self.wait_until_ready(ros)
            clock.process.kill()
            for child in children.values():
                wait_for('word of it', lambda child=child: (
                    '/time_master, which published /clock, is gone' in read(child)))
            self.assertEqual([read(child).count('simulated time stands still') for child in children.values()],
                             [1] * len(NODES))

    def test_a_robot_for_a_simulator_with_a_clock_of_its_own_warns_where_there_is_no_use_sim_time(self):
        with mock.patch.dict(os.environ, PYTHONPATH=FAKE_GAZEBO + ':' + os.environ['PYTHONPATH']):
            with Loopback(use_sim_time=False) as ros:
                for backend, simulator in (('stage_ros', 'Stage'), ('gazebo', 'Gazebo')):
                    robot = ros.run('move_base', 'move_base', '/' + backend, {'backend': backend})
                    wait_for_words(robot, "goes by the machine's clock. {} publishes /clock".format(simulator))
                    wait_for_words(robot, 'start {} first'.format(simulator))

    def test_help_is_printed_without_a_ros_master_and_unknown_arguments_are_refused(self):
        for executable in ('move_base', 'move_base_abstract_actionserver', 'fleet', 'task_server', 'map_server', 'demo',
                           'why', 'compare', 'lockstep', 'help', 'time_master'):
            code, text = run(executable, '--help')
            self.assertEqual(code, 0, text)
            self.assertIn('usage', text.lower())
        for words in (*WITHOUT_ARGUMENTS, ('time_master',)):
            code, text = run(*words, '--bogus')
            self.assertEqual(code, 2, text)
            self.assertIn('unknown argument --bogus', text)

    def test_ranks_and_seeds_of_the_launcher_are_bounded(self):
        for words in (('--rank', '99999999999999'), ('--rank', '9' * 5001), ('--seed', '9' * 5001), ('--rank', '1e3')):
            code, text = run('lockstep', *words, 'true')
            self.assertEqual(code, 2, text)
            self.assertIn('must be a whole number', text)
            self.assertLess(len(text), 600)

    def test_names_that_are_none_end_a_node(self):
        ros = Loopback(use_sim_time=False).__enter__()
        self.addCleanup(ros.close)
        names = []
        for executable, parameters, words in (
                ('task_server', {'robots': ['a b']}, "/robots: got ['a b']; allowed: a list of different"),
                ('task_server', {'robots': ['a', '/a']}, 'allowed: a list of different namespaces'),
                ('task_server', {'task': 'a b'}, "/task: got 'a b'"),
                ('fleet', {'robots': [{'name': 'a b'}]}, "name: got 'a b'; allowed: letters"),
                ('fleet', {'robots': [{'name': 'a', 'count': 1000000000}]}, 'got 1000000000; allowed: a whole number'),
                ('fleet', {'robots': [{'name': 'a', 'count': 2, 'tf_prefix': 'x'}]}, "tf frame 'x/base_link'"),
                (SOIL_COORDINATOR, {'names': ['a b', 'c', 'd']}, "got ['a b', 'c', 'd']; allowed: a list"),
                (SOIL_COORDINATOR, {'robots': 1000000000}, 'got 1000000000; allowed: a whole number in 1..1000')):
            program, *arguments = (executable,) if isinstance(executable, str) else executable
            names.append((ros.run(program, 'node_{}'.format(len(names)), parameters=parameters,
                                  arguments=arguments), words))
        for child, words in names:
            code, log = self.ended(child)
            self.assertEqual(code, 1, log)
            self.assertIn(words, log)
            self.assert_no_traceback(log)

    def test_an_output_that_cannot_be_written_is_said_in_one_line(self):
        for unbuffered in ('', '1'):
            with open('/dev/full', 'w') as full:
                done = subprocess.run([find_executable('compare'), '--help'], stdout=full, stderr=subprocess.PIPE,
                                      timeout=GUARD, universal_newlines=True, check=False,
                                      env=dict(os.environ, PYTHONUNBUFFERED=unbuffered))
            self.assertEqual(done.returncode, 1)
            self.assertEqual(done.stderr, 'compare: the output cannot be written: No space left on device\n')

    def test_a_log_file_that_cannot_be_written_is_said_once_and_the_node_goes_on(self):
        with Loopback() as ros:
            node = subprocess.Popen(['prlimit', '--fsize=0', find_executable('fleet'), '_robots:=[]', '__name:=node'],
                                    env=ros.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                    universal_newlines=True)
            self.addCleanup(node.kill)
            self.wait_for_clock(ros, ['node'])
            node.send_signal(signal.SIGTERM)
            text, _ = node.communicate(timeout=GUARD)
            self.assertEqual(node.returncode, 0, text)
            self.assertRegex(text, r'the log \S+ cannot be written: File too large; the node goes on without it')
            self.assertEqual(text.count('cannot be written'), 1, text)
            self.assert_no_traceback(text)
