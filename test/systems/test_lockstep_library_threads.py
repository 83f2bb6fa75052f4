"""Python nodes in lockstep: their threads take turns, and nodes end as they should."""

import os
import signal
import socket
import time
import unittest

from lockstep_library_run import Run, Runs, read, wait_for_end
from waiting import wait_for_words

from move_base_abstract_ros.lockstep.exchange.connection import Connection

RUNS = Runs()
WAITS = ('in_spin', 'in_sleep', 'in_loop', 'in_message', 'in_service', 'in_call', 'in_queue', 'in_event', 'in_join',
         'in_thread')


class ThreadsTest(unittest.TestCase):
    """Threads take turns, and their waits are in simulated time."""

    def test_times_out_are_simulated(self):
        run = RUNS.run('threads', 'waits')
        self.assertEqual(run.of('waits'), [
            (2.0, 'empty'), (2.5, 'got', 'in time'), (4.5, 'lock', False, True),
            (5.5, 'event', True, True, True, False), (5.5, 'joined', False), (6.25, 'condition', False)])

    def test_join_and_is_alive(self):
        run = RUNS.run('threads', 'joins')
        self.assertEqual(run.of('joins'), [(1.5, 'alive', True), (3.0, 'thread'), (3.1, 'ended'),
                                           (3.1, 'joined')])

    def test_other_threads_go_on_when_the_main_thread_has_ended(self):
        run = RUNS.run('threads', 'main_ends_first')
        self.assertEqual(run.of('main_ends_first'), [
            (1.0, 'main ends'), (1.75, 'timer'), (2.0, 'thread'), (2.5, 'timer'), (3.0, 'thread'), (3.25, 'timer'),
            (4.0, 'thread')])
        self.assertEqual(run.exit_codes, {'main_ends_first': 0})


class ConnectionTest(unittest.TestCase):
    """A participant waits for the time master without limit, whatever limit rospy sets for all sockets."""

    def test_a_wait_has_no_limit(self):
        self.addCleanup(socket.setdefaulttimeout, socket.getdefaulttimeout())
        socket.setdefaulttimeout(60.0)
        with socket.socket() as master, socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as local:
            master.bind(('127.0.0.1', 0))
            master.listen(1)
            port = master.getsockname()[1]
            self.assertIsNone(self._limit(port), 'over the network')
            local.bind('\0move_base_abstract/127.0.0.1:{}'.format(port))
            local.listen(1)
            self.assertIsNone(self._limit(port), 'on this computer')

    def _limit(self, port):
        connection = Connection('127.0.0.1', port, 5.0)
        self.addCleanup(connection.close)
        return connection._socket.gettimeout()


class EndsTest(unittest.TestCase):
    """Nodes end in their last round with their exit codes, and when they are ended from outside."""

    def test_the_last_word_of_a_node_is_heard(self):
        run = RUNS.run('threads', 'hears_the_end', 'stops_at_its_end')
        self.assertEqual(run.of('stops_at_its_end'), [(3.0, 'main ends')])
        self.assertEqual(run.of('hears_the_end'), [(3.0, 'hears', 'stop')])
        self.assertTrue(run.end['repeatable'], run.end)
        self.assertEqual(run.end['degraded_because'], [])

    def test_an_interrupt_labels_nothing_but_a_last_word(self):
        for role, words in (('in_spin', []), ('speaks_at_its_end', [(1.0, 'hears', 'stop')])):
            run = self._interrupted(role)
            self.assertEqual(run.of('listens'), words, role)
            self.assertEqual(run.end['repeatable'], not words, (role, run.end))

    def _interrupted(self, role):
        """Return a run in which one node is interrupted in its wait and another one listens."""
        names = [role, 'listens']
        master, path = RUNS.start_master(names)
        nodes = {name: RUNS.start_node('threads', name) for name in names}
        for node in nodes.values():
            self._wait_for_start(node)
        os.kill(nodes[role].pid, signal.SIGINT)
        wait_for_end(nodes[role], nodes)
        for child in (*nodes.values(), master):
            RUNS.ros.end(child)
        return Run(path, {}, {name: read(node) for name, node in nodes.items()})

    def test_exit_codes(self):
        run = RUNS.run('threads', 'exits', 'fails', 'shuts_down', 'speaks_too_late')
        self.assertEqual(run.exit_codes, {'exits': 7, 'fails': 1, 'shuts_down': 0, 'speaks_too_late': 0})
        self.assertIn("KeyError: 'the end'", run.outputs['fails'])
        self.assertEqual(run.of('shuts_down'), [])
        self.assertEqual(run.of('speaks_too_late'), [])
        self.assertEqual(run.end['degraded_because'], [])

    def test_an_interrupt_ends_a_node_in_every_wait(self):
        for role in WAITS:
            self._end_of(role, lambda _master, node: os.kill(node.pid, signal.SIGINT))

    def test_the_end_of_the_time_master_ends_a_node_in_every_wait(self):
        for role in WAITS:
            self._end_of(role, lambda master, _node: os.killpg(master.pid, signal.SIGKILL))

    def test_a_node_that_loses_the_time_master_says_so_and_ends_with_an_error(self):
        for number, words in ((signal.SIGKILL, 'closed the connection'), (signal.SIGINT, 'was told to end')):
            node = self._end_of('in_spin', lambda master, _node, number=number: master.signal(number))
            self.assertEqual(node.process.returncode, 1)
            self.assertRegex(self.output, 'FATAL.*/in_spin: the time master has ended lockstep: .*' + words)

    def test_of_two_nodes_of_one_name_the_first_says_so_and_ends_with_an_error(self):
        node = self._end_of('in_spin', lambda _master, _node: RUNS.start_node('threads', 'in_spin'))
        self.assertEqual(node.process.returncode, 1)
        self.assertRegex(self.output, 'FATAL.*/in_spin: another node of its name has taken its place')

    def test_threads_that_only_wait_do_not_keep_a_node_alive(self):
        # In a fork the main thread is shown, too: it waits for the others in a function of ours.
        RUNS.ros.is_warm = False
        self.addCleanup(setattr, RUNS.ros, 'is_warm', True)
        node = self._end_of('stuck', lambda _master, node: os.kill(node.pid, signal.SIGINT))
        self.assertEqual(node.process.returncode, 1)
        self.assertRegex(self.output, 'only threads that wait for others .* it is ended: waits for ever '
                         r'\(.*library_threads.py, line [0-9]+\)')

    def test_a_thread_that_works_may_end_its_work(self):
        node = self._end_of('works_on', lambda _master, node: os.kill(node.pid, signal.SIGINT))
        self.assertEqual(node.process.returncode, 0)
        self.assertIn('has ended its work', self.output)

    def _end_of(self, role, act):
        """Start a node, let it wait, call act(time master, node); the node must end. End what act() returns."""
        RUNS.ros.set_param('/time_master/lockstep_address', '')
        master, _path = RUNS.start_master([role])
        node = RUNS.start_node('threads', role)
        try:
            self._wait_for_start(node)
            another = act(master, node)
            if another is not None:  # it has the same name, and would take part in the next run
                self.addCleanup(RUNS.ros.end, another)
            try:
                wait_for_end(node, {role: node})
            except AssertionError as error:
                raise AssertionError(f'{role}: {error}') from None
            self.output = read(node)
            return node
        finally:
            RUNS.ros.end(node)
            RUNS.ros.end(master)

    def _wait_for_start(self, node):
        wait_for_words(node, 'joined')
        time.sleep(0.2)  # until it waits
