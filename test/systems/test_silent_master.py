"""Waits for a ROS master that does not answer, as one that is stopped, have a limit, and say who is waited for."""
import os
import socket
import unittest

from own_folder import OwnFolder

from move_base_abstract_ros.launching import ros_master


class SilentMasterTest(OwnFolder, unittest.TestCase):

    def setUp(self):
        super().setUp()
        silent = socket.socket()  # the kernel takes connections, and nobody answers, as with a stopped process
        self.addCleanup(silent.close)
        silent.bind(('127.0.0.1', 0))
        silent.listen(8)
        self.uri = 'http://127.0.0.1:{}/'.format(silent.getsockname()[1])

    def test_why_ends(self):
        self.environment['ROS_MASTER_URI'] = self.uri
        code, said = self.run_it('why', '--timeout', '1')
        self.assertEqual(code, 1, said)
        self.assertIn('no ROS master at {} answers within 1 s; a run of lockstep_launch has one'.format(self.uri), said)

    def test_parameters_and_registrations_are_not_waited_for_without_end(self):
        before, ros_master._ANSWER_S = ros_master._ANSWER_S, 0.5
        self.addCleanup(setattr, ros_master, '_ANSWER_S', before)
        for call in (lambda: ros_master.set_parameters(self.uri, [('/a', 1)]),
                     lambda: ros_master.set_parameters(self.uri, [], ['/a']),
                     lambda: ros_master.await_registered(self.uri, os.getpid(), '/n', {})):
            with self.assertRaisesRegex(ros_master.MasterError, 'the ROS master at {} does not answer: timed out; '
                                                                'allowed: one that answers'.format(self.uri)):
                call()
