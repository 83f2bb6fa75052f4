"""The launch file with which a test file begins, on a ROS master of its own; the test's process is a node of it.

    LAUNCH_FILE = '<launch> ... </launch>'   # in a test file: started before its first test, ended after its last
    FACTOR = 20                              # of a time master that is started first; without it there is none
    OWN_NODE = 'name'                        # the name of the test's own node; without it there is none
"""
import os
import time
from contextlib import contextmanager

import rosgraph
import rospy
from roslaunch.core import setup_env
from roslaunch.node_args import create_local_process_args
from waiting import GUARD
from warm import Loopback

from move_base_abstract_ros.launching import plan, roles, ros_master

QUIET = 0.5  # s, wall
FOLDER = os.path.dirname(os.path.abspath(__file__))
TIME_MASTER = ('<include file="$(find move_base_abstract)/launch/time_master.launch">'
               '<arg name="factor" value="{}"/></include>')


class Launched(Loopback):
    """A Loopback with the nodes of a launch file."""

    def __init__(self):
        super().__init__(use_sim_time=False)
        self._given = {}  # environment variables of the node that is being started

    @property
    def environment(self):
        """The environment for a process that uses this master."""
        return {**super().environment, **self._given}

    def launch(self, text):
        """Start what a launch file names, in its order. ``text``: its XML; $(dirname) is the folder of the tests."""
        path = os.path.join(self.log_dir, 'test.launch')
        with open(path, 'w', encoding='utf-8') as stream:
            stream.write(text.replace('$(dirname)', FOLDER))
        config = plan.read([path])
        ros_master.set_parameters(self.uri, [(one.key, one.value) for one in config.params.values()])
        for node in config.nodes:
            self._given = {name: value for name, value in setup_env(node, node.machine, self.uri).items()
                           if os.environ.get(name) != value}
            self.spawn(roles.name_of(node), create_local_process_args(node, node.machine))
            self._given = {}
        self._wait_until_up({roles.name_of(node) for node in config.nodes})

    def _wait_until_up(self, names):
        """Wait until all nodes have registered, and the ROS master has heard nothing new for QUIET.

        rospy makes a second connection to a publisher if that registers while the first one is being made, and drops
        what is under way on the first.
        """
        master = rosgraph.Master('/launched', master_uri=self.uri)
        deadline, state, since = time.monotonic() + GUARD, None, 0.0
        while state is None or time.monotonic() < since + QUIET:
            now = master.getSystemState()
            there = {node for kind in now for _, nodes in kind for node in nodes}
            if now != state or not names <= there:
                state, since = now, time.monotonic()
            self.check()
            assert time.monotonic() < deadline, 'not up within {} s: {}'.format(GUARD, sorted(names - there))
            time.sleep(0.05)


@contextmanager
def launched(text, node, factor=None):
    """Give a ROS master of this process, with what a launch file names, after a time master with ``factor``, or none.

    ``node``: the name of the process's own node, or None.
    """
    if factor is not None:
        text = text.replace('<launch>', '<launch>' + TIME_MASTER.format(factor), 1)
    with Launched() as ros:
        ros.adopt()
        ros.launch(text)
        if node:
            rospy.init_node(node)
        yield ros
        ros.check()
