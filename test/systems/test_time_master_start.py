"""How a time master starts and ends, each time under a ROS master of its own.

Everything waits for events; GUARD [s, wall] only ends a test that would never end.
"""

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import threading
import unittest

import rosgraph
from waiting import GUARD, read, wait_for
from warm import Loopback

#: the tests read the output of the time master while it runs
os.environ['ROSCONSOLE_STDOUT_LINE_BUFFERED'] = '1'


class DyingMaster:
    """A proxy of a ROS master that, for its clients, dies at its Nth request."""

    def __init__(self, uri, requests):
        self._target = rosgraph.network.parse_http_host_and_port(uri)
        self._left = requests
        self._lock = threading.Lock()
        self._sockets = [socket.create_server(('127.0.0.1', 0))]
        self.uri = f'http://127.0.0.1:{self._sockets[0].getsockname()[1]}/'
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        try:
            while True:
                client = self._sockets[0].accept()[0]
                server = socket.create_connection(self._target)
                with self._lock:
                    self._sockets += [client, server]
                threading.Thread(target=self._forward, args=(client, server, True), daemon=True).start()
                threading.Thread(target=self._forward, args=(server, client, False), daemon=True).start()
        except OSError:
            pass

    def _forward(self, source, target, counts):
        try:
            while True:
                data = source.recv(1 << 16)
                if counts and b'POST ' in data:
                    with self._lock:
                        self._left -= 1
                        if self._left <= 0:
                            self.die()
                if not data:
                    target.shutdown(socket.SHUT_WR)
                    return
                target.sendall(data)
        except OSError:
            pass

    def die(self):
        """Refuse new connections and end the others, as the kernel does for a process that is killed."""
        for one in self._sockets:
            try:
                one.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
            one.close()


class StartTest(unittest.TestCase):
    def start(self, ros, **parameters):
        return ros.run('time_master', 'time_master', parameters=parameters)

    def ended(self, child):
        """Wait until a child ends by itself; return (exit code, output)."""
        return child.process.wait(GUARD), read(child)

    def running(self, ros, child):
        """Wait until the time master publishes /clock; return its output so far."""
        self.wait_for_publisher(ros, '/time_master')
        self.assertIsNone(child.process.poll())
        return read(child)

    def wait_for_publisher(self, ros, node):
        master = rosgraph.Master('/test', master_uri=ros.uri)
        wait_for(f'{node}* publishes /clock',
                 lambda: any(name.startswith(node) for topic, names in master.getSystemState()[0] for name in names
                             if topic == '/clock'))

    def other_publisher(self, ros):
        """Start a stock publisher of /clock; return it when the ROS master lists it."""
        command = [shutil.which('rostopic'), 'pub', '-r', '20', '/clock', 'rosgraph_msgs/Clock', 'clock: {secs: 5}']
        process = subprocess.Popen(command, env=ros.environment, stdout=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.wait_for_publisher(ros, '/rostopic')
        return process

    def test_a_bad_parameter_is_fatal_and_names_key_namespace_value_and_what_is_allowed(self):
        cases = ((dict(factor=0), '/time_master/factor must be from 0.01 to 1000000', 'got 0'),
                 (dict(factor='fast'), '/time_master/factor must be a number', "got 'fast'"),
                 (dict(start_paused=1), '/time_master/start_paused must be true or false', "got '1'"),
                 (dict(state_rate=1e9), '/time_master/state_rate must be from 0.1 to 100 Hz', 'got 1e+09'),
                 (dict(finest_step=[1]), '/time_master/finest_step must be a number', 'got'))
        for parameters, *texts in cases:
            with Loopback() as ros:
                code, log = self.ended(self.start(ros, **parameters))
                self.assertEqual(code, 1, log)
                for text in ['FATAL', *texts]:
                    self.assertIn(text, log)

    def test_an_unknown_parameter_gets_a_warning(self):
        with Loopback() as ros:
            log = self.running(ros, self.start(ros, factr=3.0))
            self.assertIn('parameter /time_master/factr is unknown', log)
            self.assertNotIn('use_sim_time', log)

    def test_use_sim_time_that_is_not_true_gets_a_warning(self):
        with Loopback(use_sim_time=False) as ros:
            self.assertIn('/use_sim_time is not true', self.running(ros, self.start(ros)))

    def test_sigint_and_sigterm_end_it_without_an_error(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with Loopback() as ros:
                child = self.start(ros)
                self.running(ros, child)
                os.kill(child.pid, number)
                code, log = self.ended(child)
                self.assertEqual(code, 0, log)
                self.assertNotIn('FATAL', log)

    def test_a_list_may_come_from_the_command_line_where_it_is_a_text(self):
        for text, words in (('[/a, b]', 'when there are: /a, /b'), ("['a', \"b\"]", 'when there are: /a, /b'),
                            ('[]', 'when there are: the first participants')):
            with Loopback() as ros:
                child = ros.run('time_master', 'time_master', arguments=[
                    '_mode:=lockstep', f'_participants:={text}', '_excluded_topics:=[/rosbag, diagnostics]'])
                wait_for(words, lambda child=child, words=words: words in read(child))
                self.assertNotIn('unknown', read(child))
                master = rosgraph.Master('/test', master_uri=ros.uri)
                self.assertEqual(master.getParam('/time_master/excluded_topics'), ['/rosbag', 'diagnostics'])
        for text in ('/a', '[/a', '[a, [b]]', '[a,,b]', 'a, b'):
            with Loopback() as ros:
                code, log = self.ended(self.start(ros, mode='lockstep', participants=text))
                self.assertEqual(code, 1, log)
                self.assertIn(f"participants must be a list of texts, such as [a, b], got '{text}' (text)", log)

    def test_a_ros_master_that_dies_in_one_of_the_first_calls_ends_it(self):
        with contextlib.ExitStack() as stack:
            children = []
            for requests in (1, 2, 3, 5, 8, 13, 21, 34, 45, 50):
                ros = stack.enter_context(Loopback())
                ros.set_param('/time_master/mode', 'lockstep')
                uri, ros.uri = ros.uri, DyingMaster(ros.uri, requests).uri
                children.append((requests, self.start(ros)))
                ros.uri = uri
            for requests, child in children:
                with self.subTest(requests=requests):
                    code, log = self.ended(child)
                    self.assertEqual(code, 1, log)
                    self.assertIn('the ROS master at', log)

    def test_without_a_ros_master_it_waits_for_one_until_it_is_told_to_end(self):
        with Loopback() as ros, socket.socket() as taken:
            taken.bind(('127.0.0.1', 0))  # nobody listens there, and no other test can
            uri, ros.uri = ros.uri, f'http://127.0.0.1:{taken.getsockname()[1]}/'
            child = ros.run('time_master', 'time_master')
            wait_for('the warning', lambda: f'waiting for the ROS master at {ros.uri}' in read(child))
            os.kill(child.pid, signal.SIGTERM)
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            ros.uri = uri

    def test_another_living_publisher_of_clock_is_named_and_ends_it(self):
        with Loopback(use_sim_time=False) as ros:
            self.other_publisher(ros)
            code, log = self.ended(self.start(ros))
            self.assertEqual(code, 1, log)
            self.assertRegex(log, r'FATAL.*/rostopic_\S+ publishes /clock already')

    def test_a_silent_publisher_of_clock_is_named_in_a_warning_only(self):
        with Loopback(use_sim_time=False) as ros:
            os.kill(self.other_publisher(ros).pid, signal.SIGSTOP)
            log = self.running(ros, self.start(ros))
            self.assertRegex(log, r'/rostopic_\S+ is listed as a publisher of /clock but is silent')

    def test_a_time_master_that_was_killed_can_be_started_anew(self):
        with Loopback() as ros:
            first = self.start(ros)
            self.running(ros, first)
            os.kill(first.pid, signal.SIGKILL)
            first.process.wait(GUARD)
            self.running(ros, self.start(ros))

