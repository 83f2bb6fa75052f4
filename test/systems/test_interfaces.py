"""Running nodes have exactly the topics, services and actions that docs/nodes/interfaces.yaml lists."""
import os
import unittest

import rosgraph
import rospkg
import rosservice
import yaml
from waiting import wait_for

LAUNCH_FILE = """
<launch>  <!-- topics, services and actions of running nodes are those of docs/nodes/interfaces.yaml -->
  <include file="$(find move_base_abstract)/launch/time_master.launch"/>
  <node pkg="move_base_abstract" type="map_server" name="map_server"
        args="$(find move_base_abstract)/maps/farm_yard.yaml"/>
  <node ns="robot" pkg="move_base_abstract" type="move_base" name="move_base"/>
  <node ns="driven" pkg="move_base_abstract" type="velocity_robot" name="velocity_robot">
    <rosparam>{battery_capacity: 1.0, failure_kind: stall, scan_rate: 1.0, use_map: true, tf_prefix: driven}</rosparam>
  </node>
  <node pkg="move_base_abstract" type="fleet" name="fleet">
    <rosparam>
      defaults: {battery_capacity: 1.0, failure_kind: abort, scan_rate: 1.0, use_map: true}
      robots: [{name: r1}]
      zones: [{name: gate, rectangle: [1.0, 1.0, 2.0, 2.0]}]
      places: [{name: dock, x: 1.0, duration: 1.0}]
    </rosparam>
  </node>
  <node pkg="move_base_abstract" type="task_server" name="task_server">
    <rosparam>
      robots: [r2]
      places: [{name: dock, duration: 1.0}]
    </rosparam>
  </node>
  <node pkg="move_base_abstract" type="task_source" name="task_source">
    <rosparam>
      places: [{name: dock, duration: 1.0}]
      arrivals: [{place: dock, rate: 0.1}]
    </rosparam>
  </node>
</launch>
"""
OWN_NODE = 'interfaces_test'

PACKAGE = rospkg.RosPack().get_path('move_base_abstract')
IGNORED = ('/rosout', '/get_loggers', '/set_logger_level')
PARTS = (('goal', 'ActionGoal', 'in'), ('cancel', '', 'in'), ('status', '', 'out'),
         ('feedback', 'ActionFeedback', 'out'), ('result', 'ActionResult', 'out'))
OTHERS = {'cancel': 'actionlib_msgs/GoalID', 'status': 'actionlib_msgs/GoalStatusArray'}
CLOCK = {'use_sim_time'}
ROBOT = {*CLOCK, 'battery_capacity', 'failure_kind', 'scan_rate', 'use_map'}
FLEET = {*ROBOT, 'places', 'zones'}
#: {node: [(entry, namespace of a robot, meaning of ~, features that are on, names of the entry that are left out)]}
NODES = {
    '/robot/move_base': [('move_base', '/robot', '/robot/move_base', CLOCK, ())],
    '/driven/velocity_robot': [('velocity_robot', '/driven', '/driven/velocity_robot', ROBOT, ())],
    '/fleet': [('move_base', '/r1', '/r1/move_base', {*ROBOT, 'zones'}, ('~events',)),
               ('fleet', '/r1', '/fleet', FLEET, ())],
    '/task_server': [('task_server', '/r2', '/task_server', (), ())],
    '/task_source': [('task_source', '', '/task_source', (), ())],
    '/map_server': [('map_server', '', '/map_server', (), ())],
    '/time_master': [('time_master', '', '/time_master', (), ())],
}
WORDS = (('<global planner>', 'NavfnROS'), ('<local planner>', 'TrajectoryPlannerROS'), ('<task>', 'work'))


def rows(entry, namespace, own, on, left_out):
    """Yield (kind, full name, type) for each row of an entry; the kind is in, out or service."""
    for part in ('actions', 'topics', 'services'):
        for row in entry.get(part, ()):
            if 'when' in row and not set(row['when'].split(' or ')) & set(on):
                continue
            for name in row['names']:
                if name not in left_out:
                    yield from of_row(part, row, full(name, namespace, own))


def full(name, namespace, own):
    """Return the full name of a topic, service or action."""
    for word, meant in WORDS:
        name = name.replace(word, meant)
    name = name.replace('~', own + '/').replace('<ns>', namespace)
    return name if name[0] == '/' else '/' + name


def of_row(part, row, name):
    if part == 'actions':
        for last, kind, direction in PARTS:
            yield direction, name + '/' + last, row['type'][:-len('Action')] + kind if kind else OTHERS[last]
    elif part == 'topics':
        for direction in {'in', 'out'} & set(row['direction'].replace(',', '').split()):
            yield direction, name, row['type']
    else:
        yield 'service', name, row['type']


class Interfaces(unittest.TestCase):
    """Compares the file with the nodes."""

    def setUp(self):
        with open(os.path.join(PACKAGE, 'docs', 'nodes', 'interfaces.yaml'), encoding='utf-8') as stream:
            self.entries = yaml.safe_load(stream)
        self.master = rosgraph.Master('/interfaces_test')

    def there(self, node):
        """Return {(kind, name)} for all that a node has registered."""
        return {(kind, name) for kind, listed in zip(('out', 'in', 'service'), self.master.getSystemState())
                for name, nodes in listed if node in nodes and not name.endswith(IGNORED)}

    def said(self, node):
        """Return {(kind, name): type} for a node, from the file; without tf, which it hears for 2 s at a time only."""
        return {(kind, name): type_ for entry, *rest in NODES[node]
                for kind, name, type_ in rows(self.entries[entry], *rest)
                if (kind, name) not in (('in', '/tf'), ('in', '/tf_static'))}

    def test_every_entry_is_looked_at(self):
        self.assertEqual(set(self.entries), {entry for listed in NODES.values() for entry, *_ in listed})

    def said_when_there(self, node):
        """Return what is said of a node, when it has it all."""
        said = self.said(node)
        wait_for(lambda: '{}: {}'.format(node, sorted(set(said) - self.there(node))),
                 lambda: not set(said) - self.there(node))
        return said

    def test_names_are_those_of_the_nodes_both_ways(self):
        for node in NODES:
            with self.subTest(node):
                said = set(self.said_when_there(node))
                # A node publishes goals of RViz on its own goal topic, each node hears /clock, a robot hears tf for
                # 2 s from each new publisher.
                extra = {one for one in self.there(node) - said
                         if not one[1].endswith(('/move_base/goal', '/clock', '/tf', '/tf_static'))}
                self.assertEqual((sorted(said - self.there(node)), sorted(extra)), ([], []))

    def test_types_are_those_of_the_nodes(self):
        compared = 0
        for node in NODES:
            said = self.said_when_there(node)
            types = dict(self.master.getTopicTypes())
            for (kind, name), type_ in sorted(said.items()):
                found = rosservice.get_service_type(name) if kind == 'service' else types.get(name, '*')
                if found != '*':  # the ROS master may not know the type of a topic without publishers
                    compared += 1
                    self.assertEqual((name, found), (name, type_))
        self.assertGreater(compared, 100)
