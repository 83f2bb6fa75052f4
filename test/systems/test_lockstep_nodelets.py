"""Nodelets in lockstep: a manager with nodelets, and a nodelet by itself."""
import os
import unittest

import rospkg
from own_folder import OwnFolder

from move_base_abstract.runs.event_log import labels_of

MANIFEST = """<package format="2">
  <name>shim_nodelets</name><version>0.0.1</version><description>Nodelets of a test</description>
  <maintainer email="nobody@localhost">nobody</maintainer><license>BSD</license>
  <depend>nodelet</depend>
  <export><nodelet plugin="${prefix}/nodelets.xml"/></export>
</package>
"""
PLUGINS = """<library path="lib/libshim_nodelets">
  <class name="shim_nodelets/Counter" type="shim_nodelets::Counter" base_class_type="nodelet::Nodelet"/>
  <class name="shim_nodelets/Plus" type="shim_nodelets::Plus" base_class_type="nodelet::Nodelet"/>
</library>
"""
LAUNCH = """<launch>
  <node pkg="nodelet" type="nodelet" name="manager" args="manager"/>
  <node pkg="nodelet" type="nodelet" name="counter" args="load shim_nodelets/Counter manager"/>
  <node pkg="nodelet" type="nodelet" name="plus" args="load shim_nodelets/Plus manager">
    <remap from="~in" to="/counter/out"/>
  </node>
  <node pkg="nodelet" type="nodelet" name="alone" args="standalone shim_nodelets/Plus">
    <remap from="~in" to="/plus/out"/>
  </node>
</launch>
"""


def are_built():
    """Return whether this computer has nodelet, and the test's nodelets were built."""
    try:
        rospkg.RosPack().get_path('nodelet')
    except rospkg.ResourceNotFound:
        return False
    return any(os.path.exists(os.path.join(folder, 'lib', 'libshim_nodelets.so'))
               for folder in os.environ.get('CMAKE_PREFIX_PATH', '').split(os.pathsep))


@unittest.skipUnless(are_built(), 'nodelet is not installed (libnodeletlib-dev, libnodeletlib-tools)')
class LockstepNodeletsTest(OwnFolder, unittest.TestCase):
    def setUp(self):
        super().setUp()
        for name, text in (('package.xml', MANIFEST), ('nodelets.xml', PLUGINS), ('nodelets.launch', LAUNCH)):
            self.write(name, text)
        self.environment['ROS_PACKAGE_PATH'] = os.pathsep.join([self.folder, os.environ['ROS_PACKAGE_PATH']])

    def run_once(self, log):
        said, read, events = self.launch(log, '--until', '6', '--log-messages', self.path('nodelets.launch'))
        self.assertIn('4 of 4 nodes take part', said)
        self.assertEqual(labels_of(read.end), [])
        return events

    def test_nodelets_work_at_their_instants_and_twice_the_same_with_the_bonds_to_their_manager(self):
        first, second = (self.run_once(name) for name in ('a.jsonl', 'b.jsonl'))
        self.assertEqual(first, second)
        at = {topic: [time_ns for time_ns, robot, kind, _ in first if (robot, kind) == (topic, 'message')]
              for topic in ('/counter/out', '/plus/out', '/manager/bond')}
        self.assertEqual(at['/counter/out'][:3], [1100000000, 1200000000, 1300000000])
        self.assertEqual(at['/plus/out'], at['/counter/out'])
        self.assertTrue(any(time > 3 * 10 ** 9 for time in at['/manager/bond']))  # its timers go by the wall clock
