"""Robots in lockstep: the event log is the plain fleet's trace, with one process, three, or a node for each robot."""
import itertools
import json
import os
import sys
import time
import unittest

import rosgraph
from in_lockstep import InLockstep
from lockstep_fleet_client import NS_PER_S, YARD, plan_of
from roslib import packages
from waiting import GUARD, ask_why, wait_for
from warm import Loopback

from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.map_files import load_map, read_description
from move_base_abstract.scenario import make_scenario

HERE = os.path.dirname(os.path.abspath(__file__))
BLOCKS = os.path.join(HERE, '..', 'data', 'blocks.yaml')
YARD_MAP = os.path.join(HERE, '..', '..', 'maps', 'farm_yard.yaml')
TWELVE = ['robot_{}'.format(number) for number in range(12)]
TWO = TWELVE[:2]
MAX_SPEED = {'max_speed': 2.0}
REACHED = ['SUCCEEDED', 'Goal reached.']


#: a node that takes no part and makes the frame 'dock' known, 5 m along the map's x axis
DOCK = """
import rospy, tf2_ros
from geometry_msgs.msg import TransformStamped
rospy.init_node('dock')
dock = TransformStamped(child_frame_id='dock')
dock.header.frame_id, dock.transform.translation.x, dock.transform.rotation.w = 'map', 5.0, 1.0
tf2_ros.StaticTransformBroadcaster().sendTransform(dock)
rospy.spin()
"""


class Run(InLockstep):
    """One run of a plan to its end."""

    def __init__(self, plan, names, hosts, outside=(), awaited=None, of_all=None):
        """Run a plan to its end.

        hosts: {node: (executable, namespace, parameters)}; outside: commands of nodes that do not take part; awaited: a
        topic that they must publish before the robots start; of_all: parameters below /.
        """
        super().__init__([*hosts, '/client'])
        with self as run:
            for name, value in (of_all or {}).items():
                run.ros.set_param('/' + name, value)
            for name, command in enumerate(outside):
                run.ros.spawn('/outside_{}'.format(name), command)
            if awaited:
                master = rosgraph.Master('/test', run.ros.uri)
                wait_for(awaited, lambda: awaited in dict(master.getSystemState()[0]))
            for node, (executable, namespace, parameters) in hosts.items():
                run.ros.run(executable, node.rsplit('/', 1)[-1], namespace, parameters)
            run.end_of(run.ros.spawn('/client', [
                sys.executable, os.path.join(HERE, 'lockstep_fleet_client.py'), plan, *names]))

    def of(self, robot):
        """Return the events of one robot, or of the client, as (kind, values)."""
        return [event[2:] for event in self.events if event[1] == robot]


BATTERY = {'battery_capacity': 0.2, 'charging_current': 9.0, 'battery_start': 0.8,
           'battery_thresholds': [0.75, 0.7, 0.65, 0.6, 0.5, 0.4]}
#: all failures of a robot that do not end its goals
WEAR = {'failure_kind': 'stall', 'failures_per_km': 60.0, 'failures_per_hour': 200.0, 'repair_time': 3.0,
        'repair_distribution': 'lognormal', 'repair_cv': 0.5,
        'failure_times': [{'at': 5.0, 'kind': 'silent', 'repair': 4.0}], **BATTERY}
#: settings with which nothing is published at rates
SILENT = {'feedback_freq': 0.0, 'pose_update_freq': 0.0, 'tf_heartbeat_freq': 0.0}


def fleet(names, parts=1, own=None, **parameters):
    """Return the hosts of one fleet in ``parts`` processes; ``own``: parameters of all robots."""
    nodes = ['/fleet'] if parts == 1 else ['/fleet_{}'.format(part) for part in range(parts)]
    robots = [{'name': name, 'start_y': 2.0 * number} for number, name in enumerate(names)]
    return {node: ('fleet', '/', dict(parameters, defaults=dict(MAX_SPEED, **(own or {})), robots=robots, part=part,
                                      parts=parts)) for part, node in enumerate(nodes)}


def nodes(names):
    """Return the hosts for a move_base node for each robot."""
    return {'/{}/move_base'.format(name): ('move_base', '/' + name, dict(MAX_SPEED, start_y=2.0 * number))
            for number, name in enumerate(names)}


def oracle(names, own=None, scenario=None):
    """Return the trace of the plain fleet for the client's plan ``goals``; ``own`` as in fleet(), or a scenario."""
    robots = next(iter(globals()['fleet'](names, own=own).values()))[2]
    scenario = scenario or {key: robots[key] for key in ('defaults', 'robots')}
    return plain(scenario, plan_of(names), lambda at, send: (
        at(3, lambda fleet: fleet.robot(names[0]).cancel()), at(3, lambda fleet: send(names[1], 30.0, 0.0))))


def yard_oracle(scenario):
    """Return the trace of the plain Python fleet for the client's plan ``yard``."""
    goals = {name: list(places) for name, places in YARD.items()}
    return plain(scenario, goals, lambda at, _send: at(9, lambda fleet: fleet.robot('robot_1').cancel()),
                 occupancy=load_map(read_description(YARD_MAP)))


def plain(scenario, goals, meanwhile, **options):
    """Return the trace of the plain fleet: each robot goes to its ``goals`` from 2 s on.

    meanwhile(at, send) has more done: at(s, function of the fleet), send(name, *place).
    """
    counts = {name: itertools.count(1) for name in goals}

    def send(name, *place):
        fleet.robot(name).send(*place, goal_id='{}-{}'.format(name, next(counts[name])))

    def next_goal(name, *_details):
        if goals[name]:
            send(name, *goals[name].pop(0))

    def at(seconds, action):
        fleet.at(seconds * NS_PER_S, action)
    fleet = Fleet(make_scenario(scenario), on_end=next_goal, **options)
    for name in goals:
        at(2, lambda _fleet, name=name: next_goal(name))
    meanwhile(at, send)
    fleet.run()
    return [(*entry[:3], json.loads(json.dumps(entry.values))) for entry in fleet.trace]


class LockstepFleet(unittest.TestCase):
    """Each test starts all that it needs."""

    maxDiff = 4000

    def assert_repeatable(self, run):
        """Assert that the run has no labels up to its end from outside; the fleet would go on for ever."""
        self.assertEqual((run.end['not_repeatable_because'], run.end['degraded_because']), ([], []))

    def test_the_event_log_of_a_fleet_is_the_trace_of_the_plain_fleet_in_one_process_and_in_three(self):
        expected = oracle(TWELVE)
        self.assertEqual(sum(event[2] == 'ended' for event in expected), 12 * 4 + 1)
        one = Run('goals', TWELVE, fleet(TWELVE))
        self.assertEqual(one.events, expected)
        self.assert_repeatable(one)
        three = Run('goals', TWELVE, fleet(TWELVE, parts=3))
        self.assertEqual(three.text, one.text)

    def test_how_robots_travel_is_in_the_log_if_a_parameter_asks_for_it_and_chance_is_the_plain_fleets(self):
        own = {'acceleration': 0.5, 'turn_rate': 1.0}
        expected = oracle(TWO, dict(own, log_motion=True))
        chance = dict(own, seed=2, goal_overhead=0.7, duration_distribution='gamma', duration_cv=0.3,
                      failure_by_length=[[0.0, 0.0], [16.0, 0.8]], **WEAR, log_motion=True)
        self.assertEqual(expected[1], (NS_PER_S, 'robot_1', 'motion', [0.0, 2.0, 0.0, 2.0, 0.5, 1.0, 0.0, 0.0]))
        self.assertEqual(Run('goals', TWO, fleet(TWO, own=dict(own, log_motion=True))).events, expected)
        drawn = oracle(TWO, chance)
        self.assertEqual({event[3][1] for event in drawn if event[2] == 'ended'}, {'PREEMPTED', 'SUCCEEDED', 'ABORTED'})
        self.assertEqual({(event[2], *event[3]) for event in drawn if event[2] in ('failed', 'repaired')}, {
            ('failed', 'stall', 'km'), ('failed', 'stall', 'hour'), ('failed', 'silent', 'script'), ('repaired',)})
        chance.pop('log_motion')
        self.assertGreater(sum(event[2] == 'battery' for event in drawn), 5)
        asked = Run('goals', TWO, fleet(TWO, parts=2, own=chance), of_all={'log_motion': True})
        self.assertEqual(asked.events, drawn)
        alone = Run('goals', TWO, nodes(TWO), of_all={'log_motion': True})
        self.assertEqual([event for event in alone.events if event[2] not in ('motion', 'pieces')], oracle(TWO))
        self.assertEqual([event[1:3] for event in alone.events[:2]], [(name, 'motion') for name in TWO])

    def test_the_log_of_robots_as_they_were_recorded_is_the_trace_of_the_plain_fleet(self):
        scenario = {'seed': 3, 'defaults': {'calibration': 'move_base_dwa_stage'},
                    'robots': [{'name': name, 'start_y': 2.0 * number} for number, name in enumerate(TWO)]}
        run = Run('goals', TWO, {'/fleet': ('fleet', '/', scenario)})
        self.assertEqual(run.events, oracle(TWO, scenario=scenario))
        self.assertLessEqual({'recorded', 'beyond'}, {event[2] for event in run.events})
        self.assert_repeatable(run)

    def test_what_robots_send_at_one_instant_comes_in_the_order_of_their_indices(self):
        one = Run('backwards', TWELVE, fleet(TWELVE))
        self.assertEqual(one.of('client'), [('results', TWELVE)])
        self.assertEqual(Run('backwards', TWELVE, fleet(TWELVE, parts=3)).text, one.text)

    def test_two_move_base_nodes_write_the_same_log_in_every_run(self):
        first = Run('goals', TWO, nodes(TWO))
        self.assertEqual(first.events, oracle(TWO))
        self.assertEqual(Run('goals', TWO, nodes(TWO)).text, first.text)

    def test_a_run_that_ends_before_it_has_begun_is_no_error_of_the_program(self):
        with Loopback() as ros:
            master = ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'participants': ['/robots', '/never']})
            robots = ros.run('fleet', 'robots', parameters={'robots': [{'name': 'robot_0'}]})

            def waits_for_the_other_one():
                told = ask_why(ros)
                return '/never owes' in told and '/robots owes' not in told
            wait_for('a round that only /never does not end', waits_for_the_other_one)
            ros.end(master)
            robots.process.wait(GUARD)
            self.assertIn('the time master has ended lockstep', robots.last_lines())
            self.assertNotIn('please report', robots.last_lines())

    def test_nothing_is_told_on_the_way_unless_it_is_asked_for_and_then_all_of_it(self):
        silent = Run('telling', TWO, fleet(TWO, own=SILENT))
        self.assertEqual(silent.of('client'), [('pose', [0.0]), ('pose', [0.0]), ('pose', [2.0])])
        told = Run('telling', TWO, fleet(TWO, own={'feedback_freq': 100.0, 'pose_update_freq': 50.0}))
        grid = [number / 50.0 for number in range(100)]
        feedback = [values[0] for kind, values in told.of('client') if kind == 'feedback']
        self.assertEqual([round(x, 9) for x in feedback], [*grid, 2.0])
        poses = [values[0] for kind, values in told.of('client') if kind == 'pose']
        # the latched pose, the departure, the series from the departure on, the arrival
        self.assertEqual([round(x, 9) for x in poses], [0.0, 0.0] + grid[::2] + [2.0])
        in_vain = [values for kind, values in silent.of('robot_0') if kind == 'listens_in_vain']
        self.assertEqual(in_vain, [['/client', '/robot_0/robot_pose', 'pose_update_freq'],
                                   ['/client', '/robot_0/move_base/feedback', 'feedback_freq']])
        self.assertEqual(told.of('robot_0'), [record for record in silent.of('robot_0') if record[1] not in in_vain])

    def test_who_begins_to_listen_to_tf_learns_where_all_robots_are_and_then_each_event(self):
        def pairs(stamp, *places):
            return ['tf', [value for name, x in places for value in (
                name + '/odom', 0.0, stamp, name + '/base_link', x, stamp)]]

        def told(run):
            return [[kind, list(itertools.chain.from_iterable(values))] for kind, values in run.of('client')]
        one = Run('tf', TWO, fleet(TWO, own=SILENT))
        here, begin = 100 * NS_PER_S, 101 * NS_PER_S
        events = [pairs(begin + at * NS_PER_S, (name, 2.0 * at)) for at in (0, 1) for name in TWO]
        self.assertEqual(told(one), [pairs(here, *((name, 0.0) for name in TWO)), *events])
        two = Run('tf', TWO, fleet(TWO, parts=2, own=SILENT))
        self.assertEqual(told(two), [*(pairs(here, (name, 0.0)) for name in TWO), *events])

    def test_goals_in_frames_from_outside_in_unknown_ones_and_from_rviz(self):
        run = Run('frames', TWO[:1], fleet(TWO[:1]), [[sys.executable, '-c', DOCK]], '/tf_static')
        (_, dock), (_, reached), (_, moon), (_, home) = [row for row in run.of('robot_0') if row[0] in (
            'departed', 'ended')][:4]
        self.assertEqual((dock, reached), ([6.0, 0.0, 0.0], ['robot_0-1', *REACHED]))
        self.assertEqual(moon[:2], ['robot_0-2', 'ABORTED'])
        self.assertEqual(home, [0.0, 0.0, 0.0])
        times = [time_ns for time_ns, _, kind, _ in run.events if kind == 'ended']
        # the robot waited for the frame of the second goal in simulated time
        self.assertEqual(times, [5 * NS_PER_S, 6 * NS_PER_S, 23 * NS_PER_S])
        self.assert_repeatable(run)

    def test_goals_in_another_robots_frame_wait_for_its_pose_at_their_stamp(self):
        run = Run('ahead', TWO, fleet(TWO), [[sys.executable, '-c', DOCK]], '/tf_static')
        self.assertEqual([values[1:] for kind, values in run.of('robot_0') if kind == 'ended'], [REACHED] * 4)
        self.assert_repeatable(run)

    def test_a_stamp_of_the_wall_clock_is_no_leap_and_a_label(self):
        label = "'/fleet': the stamp of a goal for /robot_0/move_base is of the wall clock"
        for stamp, labels in ((time.time(), [label]), (1.6e9, [])):  # that of a recording is the same in each run
            run = Run('wall', TWO[:1], fleet(TWO[:1]), of_all={'stamp': stamp})
            self.assertEqual([(time_ns, values[1]) for time_ns, _, kind, values in run.events if kind == 'ended'], [
                (2 * NS_PER_S, 'ABORTED'), (2_500_000_000, 'SUCCEEDED')])
            self.assertEqual(run.end['not_repeatable_because'], labels)

    def test_a_map_is_there_before_time_begins_though_its_server_starts_late(self):
        server = packages.find_node('move_base_abstract', 'map_server')[0]
        late = ['/bin/sh', '-c', 'sleep 1; exec {} {}'.format(server, BLOCKS)]
        run = Run('map', TWO[:1], fleet(TWO[:1], use_map=True), [late])
        self.assertEqual([values[1] for kind, values in run.of('robot_0') if kind == 'ended'],
                         ['ABORTED', 'SUCCEEDED'])
        self.assert_repeatable(run)

    def test_the_log_of_robots_that_go_around_buildings_is_the_trace_of_the_plain_fleet(self):
        names = list(YARD)
        own = {'use_map': True, 'routes': 'grid', 'robot_radius': 0.4, 'acceleration': 0.7, 'turn_rate': 1.0,
               'start_x': 10.0, 'log_motion': True}
        hosts = fleet(names, own=own)
        for robot, corners in zip(hosts['/fleet'][2]['robots'], ('keep', 'stop', 'keep')):
            robot.update(start_y=4.0, corners=corners)
        expected = yard_oracle({key: hosts['/fleet'][2][key] for key in ('defaults', 'robots')})
        # a straight leg has at most two turns, three pieces of its drive, and the rest
        self.assertEqual(sum(event[2] == 'pieces' and len(event[3]) > 6 for event in expected), 4)
        server = packages.find_node('move_base_abstract', 'map_server')[0]
        run = Run('yard', names, hosts, [[server, YARD_MAP]])
        self.assertEqual(run.events, expected)
        self.assert_repeatable(run)

    def test_robots_wait_for_zones_and_are_charged_as_in_plain_python(self):
        zones = [{'name': 'east', 'rectangle': [1, -1, 3, 30], 'capacity': 1},
                 {'name': 'west', 'rectangle': [-3, -1, -1, 30], 'capacity': 2},
                 {'name': 'dock', 'rectangle': [-0.5, -1, 0.5, 30], 'charger': True}]
        hosts = fleet(TWELVE, own=BATTERY, zones=zones)
        expected = oracle(TWELVE, scenario={key: hosts['/fleet'][2][key] for key in ('defaults', 'robots', 'zones')})
        for kind in ('held', 'charging_began', 'charging_ended', 'battery'):
            self.assertGreater(sum(event[2] == kind for event in expected), 5)
        run = Run('goals', TWELVE, hosts)
        self.assertEqual(run.events, expected)  # at one instant, too: one leaves a zone, then another enters
        kinds = [event[2] for event in run.events]
        self.assertIn(['left', 'entered', 'released'], [kinds[at:at + 3] for at in range(len(kinds))])
        self.assert_repeatable(run)

    def test_robots_meet_as_in_plain_python(self):
        scenario = {'seed': 3, 'encounters': 'calibrated', 'defaults': {'calibration': 'move_base_dwa_stage'},
                    'robots': [{'name': name, 'start_y': 2.0 * number} for number, name in enumerate(TWELVE)]}
        expected = oracle(TWELVE, scenario=scenario)
        for kind in ('encounter', 'held', 'released'):
            self.assertGreater(sum(event[2] == kind for event in expected), 5)
        run = Run('goals', TWELVE, {'/fleet': ('fleet', '/', scenario)})
        self.assertEqual(run.events, expected)
        self.assert_repeatable(run)

    def test_a_node_with_one_robot_refuses_to_have_it_meet_others(self):
        with Loopback() as ros:
            ros.run('time_master', 'time_master')
            robot = ros.run('move_base', 'move_base', parameters={'encounters': 'calibrated'})
            self.assertEqual(robot.process.wait(GUARD), 1)
            self.assertIn('robots of different processes, such as this node, cannot meet', robot.last_lines())

    def test_robots_are_added_and_removed_by_a_participant(self):
        run = Run('services', TWO, fleet(TWO))
        self.assertEqual(run.of('client'), [('added', [True, '']), ('removed', [True])])
        self.assertEqual(run.of('late')[:4], [('goal', ['late-1']), ('departed', [4.0, 8.0, 0.0]), ('stands', [
            4.0, 8.0, 0.0]), ('ended', ['late-1', *REACHED])])
        self.assertEqual(run.of('late')[-1][1][1], 'ABORTED')
        self.assert_repeatable(run)

    def test_backends_with_a_clock_of_their_own_are_refused(self):
        with Loopback() as ros:
            ros.run('time_master', 'time_master', parameters={'mode': 'lockstep'})
            robot = ros.run('move_base', 'move_base', parameters={'backend': 'stage_ros'})
            self.assertEqual(robot.process.wait(GUARD), 1)
            self.assertIn("got 'stage_ros', a simulator with a clock of its own; allowed in lockstep",
                          robot.last_lines())
