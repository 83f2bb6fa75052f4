"""What an onlooker has not said is input, too: this package's own nodes take part, others are waited for."""
import unittest
from types import SimpleNamespace

from own_folder import OwnPackage

from move_base_abstract.msg import TimeState
from move_base_abstract_ros.debugging import state_words
from move_base_abstract_ros.launching import roles
from move_base_abstract_ros.loopback import PACKAGE
from move_base_abstract_ros.nodes import help as helps

ASKER = """#!/usr/bin/env python3
import rospy
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
rospy.init_node('asker')
grid = rospy.wait_for_message('/map', OccupancyGrid, timeout=5)
print('a map of %d cells, made at %.3f s, heard at %.3f s' % (
    len(grid.data), grid.info.map_load_time.to_sec(), rospy.get_time()), flush=True)
rospy.wait_for_service('/static_map', timeout=5)
answer = rospy.ServiceProxy('/static_map', GetMap)()
print('said the same:', answer.map.data == grid.data, rospy.get_time(), flush=True)
"""
MAPPED = """<launch>
  <node pkg="move_base_abstract" type="map_server" name="map_server"
        args="$(find move_base_abstract)/test/data/blocks.yaml" {}/>
  <node pkg="study_of_others" type="asker.py" name="asker" output="screen"/>
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <rosparam>
      defaults: {{use_map: true}}
      robots: [{{name: robot_0}}]
    </rosparam>
  </node>
  {}
</launch>
"""
SERVES = """#!/usr/bin/env python3
import sys
import time
import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger, TriggerResponse
rospy.init_node('serves', disable_rostime=True)
time.sleep(0.5)
said = rospy.Publisher('/said', String, queue_size=1, latch=True)
said.publish('a word')
if 'late' in sys.argv:
    time.sleep(1000)
rospy.Service('/asked', Trigger, lambda request: TriggerResponse(True, 'an answer'))
rospy.spin()
"""
HEARER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
from std_srvs.srv import Trigger
rospy.init_node('hearer')
rospy.Timer(rospy.Duration(0.1), lambda event: None)
print('heard', rospy.wait_for_message('/said', String, timeout=3).data, rospy.get_time(), flush=True)
rospy.wait_for_service('/asked', timeout=3)
print('got', rospy.ServiceProxy('/asked', Trigger)().message, rospy.get_time(), flush=True)
"""
CLIENT = """<node pkg="move_base_abstract" type="shim_calls" name="client">
  <param name="client" value="true"/><param name="hears" value="true"/></node>"""
HELD = """<launch>
  <node pkg="study_of_others" type="serves.py" name="serves" args="{}" respawn="true"/>
  <node pkg="study_of_others" type="hearer.py" name="hearer" output="screen" required="true"/>
  {}
</launch>
"""
MISSING = '<node pkg="study_of_others" type="{}" name="missing"/>'
#: {program of this package: how it takes part, or why it does not}
NODES = {
    **dict.fromkeys(('dispatcher', 'fleet', 'map_server', 'move_base', 'move_base_abstract_actionserver', 'task_server',
                     'task_source', 'velocity_robot'), 'itself'),
    **dict.fromkeys(('calibrate', 'chaos', 'compare', 'debug', 'demo', 'experiment', 'fleet_report', 'help', 'lockstep',
                     'lockstep_launch', 'mapf', 'old', 'replay', 'scenario', 'verify'),
                    'it is a command of this package, and no node'),
    'why': 'it only displays'}
#: the same of modules that launch files start by `lockstep --own`
MODULES = {
    'move_base_abstract_ros.nodes.property_monitor_node': 'itself', 'soil_mapping.ros.soil_coordinator': 'itself',
    'move_base_abstract_ros.nodes.orders_run.mapf_drive_node': 'itself',
    'move_base_abstract_ros.nodes.message_recorder_node': 'itself',
    'move_base_abstract_ros.nodes.end_at_message_node': 'itself', roles.DEPUTY: 'itself',
    'move_base_abstract_ros.nodes.radio_markers_node': 'it only displays'}


def role(kind, args='', kept_out=()):
    """Return the Role of a program of this package, as a node /node."""
    return roles.role_of(SimpleNamespace(package=PACKAGE, type=kind, name='node', namespace='/', machine_name=None,
                                         respawn=False, launch_prefix=None, args=args), kept_out=kept_out)


def how(kind, args=''):
    """Return how a program of this package takes part, or why it does not."""
    found = role(kind, args)
    return found.kind or found.why


class OwnNodesTest(unittest.TestCase):
    def test_each_program_of_the_package_takes_part_or_says_why_not(self):
        names = sorted(name for name in helps.scripts() if not name.startswith('old/'))
        self.assertEqual({name: how(name) for name in names},
                         {name: said for name, said in NODES.items() if name in names})
        self.assertEqual({name: how('lockstep', '--own ' + name) for name in MODULES}, MODULES)

    def test_one_that_looks_on_as_it_was_asked_for_is_waited_for_at_the_start(self):
        for name, said in NODES.items():
            self.assertEqual(role(name, kept_out=('/node',)).may_provide, said == 'itself', name)

GIVES_UP = """#!/usr/bin/env python3
import rospy
raise SystemExit(1)
rospy.init_node('missing')
"""


class MapTest(OwnPackage, unittest.TestCase):
    FILES = {'asker.py': ASKER, 'by_env': '#!/usr/bin/env -S sh -e\n', 'by_path': '#!/usr/bin/env own_sh\n',
             'own_sh': '#!/bin/sh\n', 'gives_up.py': GIVES_UP}

    def _run(self, *words, own='', more=''):
        path = self.write('mapped.launch', MAPPED.format(own, more))
        said, log, events = self.launch('a.jsonl', '--log-messages', '--until', '6', *words, path)
        return said, log.end, events

    def test_the_package_s_own_map_server_takes_part(self):
        runs = [self._run() for _ in range(2)]
        for said, end, _ in runs:
            self.assertIn('3 of 3 nodes take part', said)
            self.assertIn('a map of 96 cells, made at 1.000 s, heard at 1.000 s', said)
            self.assertIn('said the same: True 1.0', said)
            self.assertEqual(end['not_repeatable_because'] + end['degraded_because'], [])
        self.assertEqual(runs[0][2], runs[1][2])

    def test_the_same_with_a_lookahead(self):
        said, end, _ = self._run('--lookahead', '0.05')
        self.assertIn('a map of 96 cells, made at 1.000 s, heard at 1.100 s', said)
        self.assertEqual(end['not_repeatable_because'], [])

    def test_a_run_that_ends_before_it_starts_is_no_error_of_the_package_s_own_nodes(self):
        path = self.write('mapped.launch', MAPPED.format('', MISSING.format('gives_up.py')))
        code, said = self.run_it('lockstep_launch', '--until', '6', path)
        self.assertEqual(code, 1, said)
        self.assertIn('/missing ended (exit code 1) before it took part', said)
        self.assertNotIn('please report it', said)

    def test_an_interpreter_may_be_found_by_the_environment(self):
        own_path = MISSING.format('by_path').replace('/>', '><env name="PATH" value="{}:$(env PATH)"/></node>'.format(
            self.folder))
        for more in (MISSING.format('by_env'), own_path):
            self.assertEqual(self._run(more=more)[1]['not_repeatable_because'], [])


class WhyTest(unittest.TestCase):
    def test_why_says_what_time_stands_for_at_the_start_and_not_that_somebody_has_paused_it(self):
        said = state_words.lines(TimeState(mode='lockstep', phase='paused', paused=True, reason='/map is awaited'))
        self.assertEqual(said[0], 'time stands still')
        self.assertIn('/map is awaited', said)
        self.assertNotIn('resume', ' '.join(said))


class HeldTest(OwnPackage, unittest.TestCase):
    FILES = {'serves.py': SERVES, 'hearer.py': HEARER}

    def test_what_an_onlooker_has_at_the_start_is_waited_for(self):
        said, log, _ = self.launch('a.jsonl', self.write('held.launch', HELD.format('', '')))
        self.assertIn('/serves looks on: it is respawned', said)
        self.assertIn('heard a word 1.0\n', said)
        self.assertIn('got an answer 1.0\n', said)
        self.assertIn('a message on /said came from /serves', str(log.end['not_repeatable_because']))

    def test_a_wait_that_ends_without_it_is_a_label(self):
        said, log, _ = self.launch('a.jsonl', self.write('held.launch', HELD.format('late', CLIENT)), code=3)
        self.assertIn('heard a word 1.0\n', said)
        self.assertIn('timeout exceeded while waiting for service /asked', said)
        why = str(log.end['not_repeatable_because'])
        self.assertIn('time has started without the service /nobody, the service /asked', why)
        for node, what in (('hearer', 'service /asked'), ('client', 'service /nobody'),
                           ('client', 'a message on /silence')):
            self.assertIn(f"'/{node}': {what} was waited for in vain; it may be of a node that looks on: "
                          '/serves', why)
