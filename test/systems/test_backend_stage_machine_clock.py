"""A robot for Stage or Gazebo reports that it was started without /use_sim_time.

GUARD [s, wall] only ends a test that would never end.
"""
import os
import subprocess
import threading
import unittest

import rospkg
import rospy

LAUNCH_FILE = '<launch/>'
OWN_NODE = 'backend_stage_machine_clock_test'

GUARD = 30.0
FAKE_GAZEBO = os.path.join(rospkg.RosPack().get_path('move_base_abstract'), 'test', 'data', 'gazebo_fake')


class MachineClock(unittest.TestCase):
    def said(self, backend, word):
        """Return the first line of a robot with ``backend`` that holds ``word``."""
        environment = dict(os.environ, PYTHONPATH=FAKE_GAZEBO + ':' + os.environ['PYTHONPATH'])
        command = ['rosrun', 'move_base_abstract', 'move_base', '_backend:=' + backend, '__ns:=/' + backend]
        process = subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT)
        guard = threading.Timer(GUARD, process.kill)
        guard.start()
        try:
            lines = []
            for line in process.stdout:
                lines.append(line)
                if word in line:
                    return line
            self.fail("'{}' was not said:\n{}".format(word, ''.join(lines)))
        finally:
            guard.cancel()
            process.terminate()
            process.communicate()

    def test_a_robot_for_a_simulator_with_a_clock_of_its_own_warns(self):
        self.assertFalse(rospy.get_param('/use_sim_time', False))
        for backend, simulator in (('stage_ros', 'Stage'), ('gazebo', 'Gazebo')):
            line = self.said(backend, '/use_sim_time')
            self.assertIn("goes by the machine's clock. {} publishes /clock".format(simulator), line)
            self.assertIn('start {} first'.format(simulator), line)
