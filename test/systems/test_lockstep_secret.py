"""A run with a secret: roscpp and rospy nodes have it, and strangers do not get in."""

import os
import sys
import unittest

import rosgraph
from lockstep_raw_client import RawClient, address_at
from own_folder import OwnPackage
from waiting import GUARD, read, wait_for
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

ROSPY_NODE = """
import rospy
from move_base_abstract_ros import lockstep
rospy.init_node('rospy_node')
lockstep.join()
rospy.spin()
"""
#: looks at the secret that a run's starter has made, and tries to take part without it
STRANGER = """#!/usr/bin/env python3
import os
import sys
import rospy
sys.path.insert(0, os.environ['TEST_FOLDER'])
from lockstep_raw_client import RawClient, address_at
rospy.init_node('stranger')
try:
    with open(os.environ['TEST_SAID'], 'a') as said:
        status = os.stat(rospy.get_param('/time_master/lockstep_secret_file', 'no file'))
        print('mode {:o}, {} bytes'.format(status.st_mode & 0o777, status.st_size), file=said)
        try:
            RawClient(address_at(os.environ['ROS_MASTER_URI'])).hello('/fleet')
        except AssertionError as error:
            print('refused:', error, file=said)
finally:
    rospy.set_param('/is_told', True)
rospy.spin()
"""
WAITER = """#!/usr/bin/env python3
import rospy
rospy.init_node('waiter')
while not rospy.has_param('/is_told'):
    rospy.sleep(0.1)
"""
EXPERIMENT = """
experiment: both
launch: both.launch
onlooker: [/stranger]
until: {idle: true}
"""
NAMES = ('/shimmed', '/rospy_node')
#: the test reads the output of the time master while it runs
os.environ['ROSCONSOLE_STDOUT_LINE_BUFFERED'] = '1'


class OwnSecretTest(OwnPackage, unittest.TestCase):
    FILES = {'stranger': STRANGER, 'waiter': WAITER}

    def test_launch_files_and_trials_are_run_with_a_secret_that_only_their_user_can_read(self):
        self.environment.update(TEST_FOLDER=os.path.dirname(os.path.abspath(__file__)), TEST_SAID=self.path('said'))
        file = self.write('both.launch', '<launch>{}</launch>'.format(''.join(
            '<node pkg="study_of_others" type="{0}" name="{0}" required="{1}"/>'.format(*one)
            for one in (('stranger', 'false'), ('waiter', 'true')))))
        experiment = self.write('both.yaml', EXPERIMENT)
        for words in (('lockstep_launch', '--onlooker', '/stranger', file),
                      ('experiment', 'run', experiment, '-o', self.path('out'), '--workers', '1')):
            code, output = self.run_it(*words)
            self.assertEqual(code, 0, output)
            with open(self.path('said')) as stream:
                said = stream.read()
            os.remove(self.path('said'))
            self.assertIn('mode 600, 48 bytes', said)
            self.assertIn('refused: ', said)
            self.assertIn("HELLO must have the secret of the run, got none from '/fleet'", said)


class SecretTest(unittest.TestCase):
    def setUp(self):
        self.ros = Loopback()
        self.ros.__enter__()
        self.addCleanup(self.ros.close)

    def secret_file(self, mode=0o600):
        path = os.path.join(self.ros.log_dir, 'secret')
        with open(path, 'w') as stream:
            stream.write('open sesame\n')
        os.chmod(path, mode)
        return path

    def start(self, **parameters):
        return self.ros.run('time_master', 'time_master', parameters=dict(
            parameters, mode='lockstep', participants=[*NAMES, '/raw']))

    def test_roscpp_and_rospy_nodes_read_it_and_strangers_are_kept_out(self):
        for parameters in ({'lockstep_secret_file': self.secret_file()}, {'lockstep_secret': 'open sesame'}):
            note = os.path.join(self.ros.log_dir, 'started by ' + min(parameters))
            master = self.start(note_of_start=note, **parameters)
            address = address_at(self.ros.uri)
            stranger = RawClient(address)
            self.addCleanup(stranger.close)
            with self.assertRaisesRegex(AssertionError, "must have the secret of the run, got none from '/raw'"):
                stranger.hello('/raw')
            nodes = [
                self.ros.spawn('/shimmed', [find_executable('lockstep'), find_executable('shim_listener'),
                                            '__name:=shimmed']),
                self.ros.spawn('/rospy_node', [sys.executable, '-c', ROSPY_NODE])]
            insider = RawClient(address).hello('/raw', secret=b'open sesame')
            insider.turn()  # time has started, so all three are there
            wait_for('the start', lambda note=note: os.path.exists(note))
            self.assertIn("a connection was refused: HELLO must have the secret of the run, got none from '/raw'",
                          read(master))
            insider.close()
            for child in [*nodes, master]:
                self.ros.end(child)
            rosgraph.Master('/test', master_uri=self.ros.uri).deleteParam('/time_master')

    def test_a_file_that_others_can_read_is_fatal_for_all(self):
        path = self.secret_file(0o644)
        master = self.start(lockstep_secret_file=path)
        self.assertEqual(master.process.wait(GUARD), 1)
        words = 'others may use it too; chmod 600 changes that'
        self.assertRegex(read(master), f'FATAL.*/time_master/lockstep_secret_file must be .*{words}')
