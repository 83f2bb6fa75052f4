"""Nodelets in lockstep: a manager with nodelets, and a nodelet by itself."""
import os
import unittest

import rospkg
import warm
from own_folder import OwnFolder

from move_base_abstract.runs.event_log import EventLog, labels_of
from move_base_abstract_ros.loopback import find_executable

GUARD = 100.0  # s, wall; only ends a run that would never end
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

    def run_it(self, log):
        environment = dict(os.environ, ROS_PACKAGE_PATH=self.folder + os.pathsep + os.environ['ROS_PACKAGE_PATH'])
        done = warm.run([find_executable('lockstep_launch'), '--until', '6', '--log-messages', '--event-log',
                         self.path(log), self.path('nodelets.launch')], environment, timeout=GUARD)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('4 of 4 nodes take part', done.stdout)
        with open(self.path(log), encoding='utf-8') as stream:
            read = EventLog(stream.readlines(), log)
        events = list(read)
        self.assertEqual(labels_of(read.end), [])
        return events

    def test_nodelets_work_at_their_instants_and_twice_the_same_with_the_bonds_to_their_manager(self):
        first, second = (self.run_it(name) for name in ('a.jsonl', 'b.jsonl'))
        self.assertEqual([event.compared for event in first], [event.compared for event in second])
        at = {topic: [event.time_ns for event in first if event.robot == topic and event.kind == 'message']
              for topic in ('/counter/out', '/plus/out', '/manager/bond')}
        self.assertEqual(at['/counter/out'][:3], [1100000000, 1200000000, 1300000000])
        self.assertEqual(at['/plus/out'], at['/counter/out'])
        self.assertTrue(any(time > 3 * 10 ** 9 for time in at['/manager/bond']))  # its timers go by the wall clock
