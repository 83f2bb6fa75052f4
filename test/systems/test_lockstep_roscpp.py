"""Unmodified roscpp programs in lockstep: Debian's own and nodes of test/cpp_nodes that know nothing of lockstep.

Programs that are exact are scenarios: each run must have the same event log, with the values that follow from simulated
time.
"""

import ctypes
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

import rosbag
from lockstep_raw_client import RawClient, address_at
from lockstep_roscpp_run import GUARD, Program, Runs, own, read, recorder, take_name
from own_sockets import closed_connections
from scenarios import repeated
from waiting import wait_for
from warm import Loopback

from move_base_abstract_ros.lockstep.programs.binary import find_shim
from move_base_abstract_ros.loopback import find_executable

RUNS = Runs()
SECOND = 10 ** 9
SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, os.pardir, 'src', 'roscpp_shim')
TOPIC_TOOLS = '/usr/lib/topic_tools/'
LISTENER = Program('listener', own('shim_listener'))


def rate(frequency=10.0, ticks=100, **more):
    return Program('rate', own('shim_rate'), frequency=frequency, ticks=ticks, **more)


def ticks_at(topic, times, numbers):
    return [f'{at} {topic} {number} {sent}' for at, number, sent in zip(times, numbers, times)]


class LockstepRoscppTest(unittest.TestCase):
    def same(self, programs, until=1e9):
        """Run a scenario; assert that the runs are the same up to ``until`` [s], and return the first."""
        runs = RUNS.scenario(programs, until)
        first = runs[0].until(until)
        self.assertTrue(first)
        for run in runs:
            self.assertEqual(run.code, 0, run.outputs)
            self.assertEqual(run.labels, [])
            self.assertEqual(run.until(until), first)
        return runs[0]

    def test_ten_thousand_ticks_of_a_rate_none_off(self):
        run = RUNS.run([rate(frequency=40.0, ticks=10000, quiet=True)])
        self.assertEqual(run.parameters['off'], 0)

    def test_roscpps_own_thread_is_not_woken_for_messages_between_participants(self):
        run = RUNS.run([rate(frequency=40.0, ticks=1000), recorder('/ticks')])
        self.assertEqual(len(run.printed(1)), 1000)
        self.assertLess(run.parameters['writes'], 100)  # not one into roscpp's pipe for each message

    def test_relay_and_a_callback_that_sleeps(self):
        run = self.same([rate(ticks=20), recorder('/heard', '/relayed'),
                         Program('listener', own('shim_listener'), work=0.25),
                         Program('relay', TOPIC_TOOLS + 'relay', '/ticks', '/relayed')])
        lines = run.printed(1)
        times = [SECOND + k * SECOND // 10 for k in range(1, 21)]
        # relay advertises when its first message comes, and that message has no subscriber yet.
        self.assertEqual([line for line in lines if 'relayed' in line], ticks_at('/relayed', times[1:], range(2, 21)))
        heard = [line.split()[2:5] for line in lines if '/heard' in line]
        self.assertEqual(heard[0], [str(1350000000), 'heard', '1'])
        self.assertEqual(heard[3], [str(2100000000), 'heard', '4'])

    def test_throttle(self):
        run = self.same([rate(ticks=60), recorder('/throttled'),
                         Program('throttle', TOPIC_TOOLS + 'throttle', 'messages', '/ticks', '1.0', '/throttled')])
        times = [SECOND + k * SECOND // 10 for k in (12, 23, 34, 45, 56)]  # it waits for more than a second
        self.assertEqual(run.printed(1), ticks_at('/throttled', times, (12, 23, 34, 45, 56)))

    def test_mux(self):
        run = self.same([rate(ticks=30), recorder('/muxed'),
                         Program('mux', TOPIC_TOOLS + 'mux', '/muxed', '/ticks', '/other')])
        self.assertEqual(len(run.printed(1)), 29)

    def test_static_transform_publisher(self):
        run = self.same([rate(ticks=5), Program('relay', TOPIC_TOOLS + 'relay', '/tf_static', '/copy'),
                         Program('static', '/usr/lib/tf2_ros/static_transform_publisher', '1', '2', '3', '0', '0', '0',
                                 'map', 'odom')])
        self.assertEqual([event[:2] for event in run.events], [(SECOND, '/tf_static')])

    def test_timers_of_all_kinds(self):
        run = self.same([rate(frequency=1.0, ticks=10), recorder('/fired'), Program('timers', own('shim_timer'))], 10)
        lines = run.printed(1)
        for line in lines:
            words = line.split()
            self.assertEqual(words[4], words[6], line)  # the times when it was due and when it fired
            self.assertEqual(int(words[0]), round(float(words[6]) * 1e9), line)
        first = [line.split()[2:5:2] for line in lines[:16]]
        self.assertEqual([at for name, at in first if name == 'slow'], ['1.300000000', '1.600000000', '1.900000000',
                                                                         '2.200000000'])
        self.assertEqual([at for name, at in first if name == 'once'], ['2.050000000'])
        self.assertTrue(any('again expected 4.05' in line for line in lines))

    def test_services(self):
        run = self.same([Program('client', own('shim_calls'), client=True), recorder('/answers'),
                         Program('server', own('shim_calls'), work=0.25)])
        lines = run.printed(1)
        self.assertEqual([line.split(' ', 3)[2:] for line in lines[:2]],
                         [['3000000000', 'not found'], ['3000000000', 'found']])
        self.assertEqual(lines[2:5], [f'{at} /answers {at} at {at}' for at in (3250000000, 4250000000, 5250000000)])
        self.assertEqual(lines[-1], '23000000000 /answers 23000000000 refused')

    def test_a_call_of_a_service_that_a_participant_offers_at_the_same_instant_fails_and_labels_nothing(self):
        run = self.same([Program('asker', own('shim_calls'), at_once=True), recorder('/answers'),
                         Program('server', own('shim_calls'))])
        self.assertEqual(run.printed(1), ['1500000000 /answers 1500000000 at 1500000000'])
        self.assertNotIn('Service call failed', run.outputs[0])

    def test_simple_action_client_and_server_with_their_own_threads(self):
        run = self.same([Program('goals', own('shim_goals'), goals=6), recorder('/results'),
                         Program('worker', own('shim_worker'))])
        results = [line.split(' ', 3)[2:] for line in run.printed(1)]
        self.assertEqual([text for _time, text in results],
                         ['server is there', *(f'goal {k} SUCCEEDED' for k in range(4)), 'timeout of 4',
                          'goal 4 PREEMPTED', 'goal 5 SUCCEEDED'])
        times = [int(time_ns) for time_ns, _text in results]
        steps = [(after - before) / 1e9 for before, after in zip(times, times[1:])]
        self.assertEqual(steps, [1.0, 1.1, 1.2, 1.3, 0.5, 0.1, 1.5])

    def test_onlookers_change_nothing(self):
        programs = [Program('goals', own('shim_goals'), goals=6), recorder('/results'),
                    Program('worker', own('shim_worker'))]
        runs = [RUNS.run(programs, speed_limit=1.0, onlook=onlook) for onlook in ((), ('/work/goal', '/results'))]
        self.assertEqual(runs[1].labels, [])
        self.assertEqual(runs[1].events, runs[0].events)

    def test_onlookers_are_not_counted_as_listeners(self):
        run = RUNS.run([rate(frequency=2.0, ticks=20), recorder('/ticks')], speed_limit=2.0, onlook=['/ticks'])
        self.assertEqual(run.parameters['listeners'], 1)
        self.assertEqual(run.labels, [])

    def test_transform_listener(self):
        run = self.same([Program('look', own('shim_frames'), look=True), recorder('/looked'),
                         Program('send', own('shim_frames'))], 10)
        lines = run.printed(1)
        self.assertEqual(lines[0], '1503000000 /looked 1500000000 1.500000 at 1503000000')  # tf2 asks every 3 ms here
        self.assertEqual(lines[10], '6800000000 /looked 6500000000 no transform at 6800000000')

    def test_the_listener_of_tf_asks_for_no_instant_of_its_own(self):
        run = RUNS.run([rate(frequency=20.0, ticks=200), Program('listen', own('shim_frames'), listen=True),
                        Program('send', own('shim_frames'))], ask_why=True)
        seconds = float(re.search(r'at ([\d.]+) s', run.why).group(1))
        leaps = int(re.search(r'(\d+) leaps', run.why).group(1))
        self.assertGreater(seconds, 10.0, run.why)
        self.assertLess(leaps / seconds, 21.0, run.why)  # with a look after each transform there would be 80 per second

    def test_what_waits_for_a_transform_comes_out_when_that_comes(self):
        run = self.same([Program('filter', own('shim_frames'), filter=True), recorder('/looked'),
                         Program('send', own('shim_frames'))], 7)
        seen = [[int(word) for word in line.split(' ', 2)[2].split(' came out at ')] for line in run.printed(1)]
        self.assertEqual(len(seen), 20)
        for stamp, out in seen:
            self.assertEqual(out, -(-stamp // 50_000_000) * 50_000_000)

    def test_rosbag_record_has_every_message_with_its_time(self):
        def content(condition):
            folder = tempfile.mkdtemp()
            self.addCleanup(shutil.rmtree, folder)
            path = os.path.join(folder, 'run.bag')
            record = Program('record', '/usr/lib/rosbag/record', '-O', path, '/ticks')
            run = RUNS.run([rate(ticks=200), record], condition=condition)
            self.assertEqual(run.labels, [])
            with rosbag.Bag(path) as bag:
                return [(topic, message.data, at.to_nsec()) for topic, message, at in bag.read_messages()]
        times = [SECOND + k * SECOND // 10 for k in range(1, 201)]
        for found in repeated('rosbag record', content, lambda rows: repr(rows).encode()):
            self.assertEqual(found, [('/ticks', f'{k} {at}', at) for k, at in enumerate(times, 1)])


class OutsideTest(unittest.TestCase):
    """Nodes that do not take part, and runs that are not in lockstep."""

    def start(self, ros, *participants):
        RUNS.ros = ros
        return ros.run('time_master', 'time_master', parameters=dict(
            mode='lockstep', participants=list(participants), note_of_start=os.path.join(ros.log_dir, 'started')))

    def begin(self, ros, *programs):
        """Start a time master and programs; return them all once the clock has started."""
        children = [self.start(ros, *('/' + program.name for program in programs)), *map(RUNS.start, programs)]
        wait_for('the note of the start', lambda: os.path.exists(os.path.join(ros.log_dir, 'started')))
        return children

    def test_where_the_time_master_is_not_in_lockstep_nothing_changes(self):
        with Loopback() as RUNS.ros:
            RUNS.ros.run('time_master', 'time_master', parameters={'factor': 50.0})
            child = RUNS.start(rate(ticks=20))
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertEqual(RUNS.parameters(rate())['done'], True)

    def test_a_call_from_outside_is_answered_and_labelled(self):
        with Loopback() as ros:
            master, server = self.begin(ros, Program('server', own('shim_calls'), work=0.5))
            answer = self.call(ros, '/trigger')
            self.assertIn('at 1500000000', answer)
            server.signal(signal.SIGINT)
            self.assertEqual(server.process.wait(GUARD), 0, read(server))
            self.assertIn('has reached /server from outside of lockstep', read(master))

    def test_a_call_by_one_who_keeps_time_standing_is_answered(self):
        with Loopback() as ros:
            self.start(ros, '/raw', '/server')
            RUNS.start(Program('server', own('shim_calls')))
            client = RawClient(address_at(ros.uri)).hello('/raw')
            self.addCleanup(client.close)
            client.grant()  # without a report, no further round can come
            self.assertIn('at 1000000000', self.call(ros, '/trigger'))

    def test_others_go_on_when_a_program_is_killed(self):
        with Loopback() as ros:
            master, listener, child = self.begin(ros, LISTENER, rate(frequency=1.0, ticks=20000))
            listener.signal(signal.SIGKILL)
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertIn("'/listener' died", read(master))

    def test_parameters_are_set_over_one_connection(self):
        with Loopback() as ros:
            _master, child = self.begin(ros, Program('board', own('shim_board')))
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertLess(closed_connections(ros.uri), 20)

    def test_a_program_ends_with_its_time_master_whether_that_is_killed_or_ends(self):
        for number in (signal.SIGKILL, signal.SIGTERM):
            with Loopback() as ros:
                master, child = self.begin(ros, rate(frequency=1.0, ticks=10 ** 7))
                master.signal(number)
                self.assertEqual(child.process.wait(GUARD), 1, read(child))  # although its main function returns 0
                self.assertRegex(read(child), 'FATAL.*the run is over for /rate')

    def test_sigint_ends_a_program_and_nobody_else(self):
        with Loopback() as ros:
            master, listener, child = self.begin(ros, LISTENER, rate(frequency=1.0, ticks=20000))
            listener.signal(signal.SIGINT)
            self.assertEqual(listener.process.wait(GUARD), 0, read(listener))
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertIsNone(master.process.poll())

    def test_a_program_whose_name_is_taken_says_so_and_ends_with_an_error(self):
        with Loopback() as ros:
            _master, child = self.begin(ros, rate(frequency=1.0, ticks=10 ** 7))
            take_name(ros, '/rate')
            self.assertEqual(child.process.wait(GUARD), 1, read(child))
            self.assertRegex(read(child), 'FATAL.*/rate: another node of its name has taken its place')

    def test_the_launcher_says_what_it_cannot_preload_into(self):
        with Loopback() as ros:
            self.start(ros, '/none')
            told = self.launch(ros, '/bin/ls')
            self.assertIn("'/bin/ls' is not a roscpp program: it needs ", told)
            self.assertIn('but not libroscpp.so', told)
            folder = tempfile.mkdtemp()
            self.addCleanup(shutil.rmtree, folder)
            path = shutil.copy(own('shim_rate'), folder)
            os.chmod(path, 0o4755)
            self.assertIn('the system does not preload', self.launch(ros, path))

    def test_what_the_library_exports_is_what_its_table_lists(self):
        table = os.path.join(SOURCES, 'machine', 'replaced.def')
        with open(table) as stream:
            listed = re.findall(r' (\w+)\)$', stream.read(), re.MULTILINE)
        library = ctypes.CDLL('libstdc++.so.6')  # Debian 11's waits for futures by the steady clock differ
        listed = [name for name in listed if not name.startswith('_ZNSt') or hasattr(library, name)]
        told = subprocess.run(['nm', '-D', '--defined-only', find_shim(os.environ)], check=True, text=True,
                              stdout=subprocess.PIPE).stdout
        ours = ['move_base_abstract_log_row']  # a function for the header of statements
        self.assertEqual(sorted(line.split()[-1] for line in told.splitlines()), sorted(listed + ours))

    def test_a_program_says_what_was_found_and_what_fits(self):
        with Loopback() as ros:
            _master, child = self.begin(ros, rate(ticks=3))
            self.assertEqual(child.process.wait(GUARD), 0, read(child))
            self.assertRegex(read(child), r'lockstep: /rate takes part with roscpp 1\.\d+\.\d+ and glibc 2\.\d+; '
                                          r'what fits: roscpp 1\.\d+ \(built with 1')

    def test_bad_parameters_are_refused_by_name(self):
        with Loopback() as ros:
            self.start(ros, '/rate')
            for key, value in (('lockstep_rank', 'first'), ('lockstep_charge', 'measured')):
                ros.set_param(f'/rate/{key}', value)
                told = self.launch(ros, own('shim_rate'), '__name:=rate')
                self.assertIn(f'parameter /rate/{key}: got ', told)
                self.assertIn('; allowed', told)
                ros.set_param(f'/rate/{key}', {'lockstep_rank': 3, 'lockstep_charge': 'none'}[key])

    def launch(self, ros, path, *arguments):
        done = subprocess.run([find_executable('lockstep'), path, *arguments], env=ros.environment, timeout=GUARD,
                              text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 1, done.stdout)
        return done.stdout

    def call(self, ros, service):
        wait_for(service, lambda: subprocess.run(['rosservice', 'info', service], env=ros.environment, check=False,
                                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0)
        return subprocess.run(['rosservice', 'call', service], env=ros.environment, timeout=GUARD, text=True,
                              check=True, stdout=subprocess.PIPE).stdout
