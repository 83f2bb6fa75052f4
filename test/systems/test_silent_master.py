"""Waits for a ROS master that does not answer, as one that is stopped, have a limit, and say who is waited for."""
import os
import signal
import socket
import subprocess
import unittest

from own_folder import OwnFolder, OwnPackage
from waiting import children_of, wait_for

from move_base_abstract_ros.launching import ros_master
from move_base_abstract_ros.loopback import find_executable

LAUNCH = '<launch><node pkg="study_of_others" type="{0}" name="{0}" output="screen"/></launch>'
EVER = """#!/usr/bin/env python3
import rospy
rospy.init_node('ever')
while not rospy.is_shutdown():
    rospy.sleep(1.0)
"""


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


class StoppedMasterTest(OwnPackage, unittest.TestCase):
    FILES = {'never': '#!/bin/sh\nexec sleep 1000\n', 'ever': EVER}

    def test_a_master_that_is_stopped_while_nodes_start_or_run_is_named(self):
        for program, sign in (('never', 'never-2]: started'), ('ever', 'the clock starts at')):
            with self.subTest(program):
                self._stop(program, sign)

    def _stop(self, program, sign):
        file = self.write('a.launch', LAUNCH.format(program))
        with open(self.path('said'), 'w+') as said:
            run = subprocess.Popen([find_executable('lockstep_launch'), '--participant', '/' + program, file],
                                   stdout=said, stderr=subprocess.STDOUT, env=self.environment)
        self.addCleanup(run.wait)
        self.addCleanup(run.terminate)

        def has_said(text):
            with open(self.path('said')) as stream:
                return text in stream.read()
        wait_for('the nodes', lambda: has_said(sign))
        master = children_of(children_of(run.pid)[0])[0]  # a guard's child is the program, which starts this first
        os.kill(master, signal.SIGSTOP)
        self.addCleanup(os.kill, master, signal.SIGCONT)
        wait_for('the word', lambda: has_said('has not answered for 3 s; the nodes that start or ask it wait for it'))
