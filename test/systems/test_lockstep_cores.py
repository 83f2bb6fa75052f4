"""The cores on which a run works: processes that are kept on one core, those that are left alone, and the end.

The test itself takes part, by the socket for participants on this computer.
"""

import os
import socket
import subprocess
import threading
import unittest

from in_lockstep import InLockstep
from lockstep_launcher_run import run_programs
from lockstep_raw_client import RawClient, address_at
from waiting import ask_why, wait_for
from warm import Loopback

from move_base_abstract_ros.lockstep.exchange.connection import Connection
from move_base_abstract_ros.loopback import find_executable

OWN = os.sched_getaffinity(0)
ROUNDS = 60
SLOW_ROUNDS = 10
STEP_NS = 10 ** 6
COORDINATOR = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'lockstep_nodes', 'coordinator.py')
ROBOTS, GOALS = 4, 60


class LocalClient(RawClient):
    """A participant whose process id the time master can see."""

    def __init__(self, address):
        super().__init__(address)
        self.address = address
        self.socket.close()
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.connect('\0move_base_abstract/' + address)

    def turns(self):
        """Take turns for ever, and yield in the middle of each."""
        while True:
            grant = self.grant()
            yield
            self.report(grant, next_ns=grant.time_ns + STEP_NS)


@unittest.skipIf(len(OWN) < 2, 'this computer lets the tests use one core only')
class CoresTest(unittest.TestCase):
    def setUp(self):
        self.addCleanup(os.sched_setaffinity, 0, OWN)

    def join(self, cores, others=(), **clock):
        """Start a time master; return its Loopback, its Child and a participant that has said hello."""
        ros = Loopback()
        ros.__enter__()
        self.addCleanup(ros.close)
        child = ros.run('time_master', 'time_master', parameters={
            'mode': 'lockstep', 'participants': ['/raw', *others], 'cores': cores, **clock})
        client = LocalClient(address_at(ros.uri))
        self.addCleanup(client.close)
        return ros, child, client.hello('/raw')

    def test_one_core_of_those_that_a_process_may_use_and_all_back_when_it_leaves(self):
        ros, _child, client = self.join('one')
        turns = client.turns()
        next(turns)
        one = os.sched_getaffinity(0)
        self.assertEqual(len(one), 1)
        self.assertLess(one, OWN)
        self.assertIn(f'cores of this computer: one (core {min(one)}', ask_why(ros))
        sleeper = subprocess.Popen(['sleep', '600'])  # inherits the core of the thread that starts it
        self.addCleanup(sleeper.wait)
        self.addCleanup(sleeper.kill)
        wait_for('a child has all cores', lambda: next(turns) or os.sched_getaffinity(sleeper.pid) == OWN)
        client.leave()
        client.close()
        wait_for('all cores are back', lambda: os.sched_getaffinity(0) == OWN)

    def test_a_thread_that_has_its_own_core_keeps_it_and_others_join_on_it(self):
        asked, go_on, masks = threading.Event(), threading.Event(), []

        def work():
            os.sched_setaffinity(0, {min(OWN)})
            asked.set()
            go_on.wait()
            masks.append(os.sched_getaffinity(0))
        thread = threading.Thread(target=work)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(go_on.set)
        asked.wait()
        _ros, _child, client = self.join('one')
        for _turn, _number in zip(client.turns(), range(ROUNDS)):
            pass
        go_on.set()
        thread.join()
        self.assertEqual(masks, [{min(OWN)}])

    def test_a_long_round_has_all_cores_for_its_rest_and_who_chooses_himself_is_left_alone(self):
        _ros, _child, client = self.join('one')
        turns = client.turns()
        for _ in range(2):
            next(turns)
            one = os.sched_getaffinity(0)
            self.assertEqual(len(one), 1)
            wait_for('all cores', lambda: os.sched_getaffinity(0) == OWN)
        other = {min(OWN - one)}
        os.sched_setaffinity(0, other)
        for _turn, _number in zip(turns, range(ROUNDS)):
            self.assertEqual(os.sched_getaffinity(0), other)

    def test_two_runs_have_a_core_each_if_no_others_are_on_this_computer(self):
        masks, said = [], ''
        for _ in range(2):
            ros, _child, client = self.join('one')
            next(client.turns())
            masks.append(os.sched_getaffinity(0))
            said += ask_why(ros)
            wait_for('all cores for a long round', lambda: os.sched_getaffinity(0) == OWN)
        self.assertEqual([len(mask) for mask in masks], [1, 1])
        self.assertTrue(masks[0].isdisjoint(masks[1]) or 'shared with other runs' in said, (masks, said))

    def test_with_a_lookahead_or_with_all_nothing_is_bound(self):
        for cores, lookahead in (('one', STEP_NS / 1e9), ('all', 0.0)):
            with self.subTest(cores, lookahead=lookahead):
                ros, _child, client = self.join(cores, lookahead=lookahead)
                for _turn, _number in zip(client.turns(), range(ROUNDS)):
                    self.assertEqual(os.sched_getaffinity(0), OWN)
                self.assertIn('cores of this computer: all', ask_why(ros))

    def test_why_says_that_all_cores_would_help_nodes_that_compute_at_once(self):
        for at_once in (False, True):
            with self.subTest(at_once):
                ros, _child, client = self.join('one', ['/other'])
                other = LocalClient(client.address).hello('/other')
                self.addCleanup(other.close)
                first, second = client.grant(), other.grant()
                client.report(first, next_ns=first.time_ns + STEP_NS)
                other.report(second, next_ns=second.time_ns + (STEP_NS if at_once else STEP_NS + STEP_NS // 2))
                for _ in range(SLOW_ROUNDS):
                    first, second = client.grant(), other.grant() if at_once else None
                    said = ask_why(ros)  # this takes long enough to be work
                    client.report(first, next_ns=first.time_ns + STEP_NS)
                    second = second or other.grant()
                    other.report(second, next_ns=second.time_ns + STEP_NS)
                self.assertEqual('`cores: all` may be faster' in said, at_once, said)
                client.close()
                other.close()

    def test_at_the_end_of_the_run_all_is_given_back_before_it_is_told(self):
        _ros, child, client = self.join('one')
        next(client.turns())
        self.assertEqual(len(os.sched_getaffinity(0)), 1)
        child.process.terminate()
        client.end()
        self.assertEqual(os.sched_getaffinity(0), OWN)

    def test_the_end_of_a_connection_gives_all_back_whoever_ends_it(self):
        listener = socket.socket(socket.AF_UNIX)
        self.addCleanup(listener.close)
        listener.bind('\0move_base_abstract/127.0.0.1:0')  # no time master has port 0
        listener.listen()
        connection = Connection('127.0.0.1', 0, 1.0)
        os.sched_setaffinity(0, {max(OWN)})
        connection.close()
        self.assertEqual(os.sched_getaffinity(0), OWN)

    def test_the_log_is_the_same_on_one_core_and_on_all(self):
        for lookahead in (0.0, 0.05):
            with self.subTest(lookahead):
                logs = [self.log(cores, lookahead) for cores in ('one', 'all', 'auto')]
                self.assertGreater(logs[0].count('"ended"'), GOALS - 1)
                self.assertEqual(set(logs), {logs[0]})

    def test_a_program_in_cpp_sees_its_own_cores_and_what_it_starts_has_them(self):
        run = run_programs({'cores': [find_executable('shim_cores')]}, until=5.0, clock={'cores': 'one'})
        alone, many = ' 1', f' {len(OWN)}'
        self.assertEqual(run.printed('cores'), ['has' + alone] + [
            what + many for what in ('sees', 'thread_sees', 'fork', 'system', 'popen', 'spawn')] + [
            'has' + alone, 'chose' + many, 'chose' + alone])

    def log(self, cores, lookahead):
        """Return the event log of a run of a fleet and a coordinator."""
        with InLockstep(['/fleet', '/coordinator'], cores=cores, lookahead=lookahead) as run:
            run.ros.run('fleet', 'fleet', parameters={
                'defaults': {'max_speed': 10.0}, 'robots': [{'name': f'robot_{i}'} for i in range(ROBOTS)]})
            run.ros.set_param('/coordinator', {'robots': ROBOTS, 'goals': GOALS, 'seed': 1, 'patient': True})
            run.end_of(run.ros.spawn('/coordinator', ['/usr/bin/python3', COORDINATOR, '__name:=coordinator']))
            with open(os.path.join(run.ros.log_dir, '01-time_master.out'), encoding='utf-8') as stream:
                self.assertEqual('cores: auto measures no more and means one' in stream.read(), cores == 'auto')
        return run.text
