"""The node dispatcher: the same rows as in plain Python, to the byte; faulty orders; a user's policy."""
import json
import os
import unittest

from own_folder import MANIFEST, OwnFolder

from move_base_abstract.fleet import Dispatch
from move_base_abstract.orders.policies import POLICIES
from move_base_abstract.scenario import read_scenario

HERE = os.path.dirname(os.path.abspath(__file__))
LAUNCH = os.path.join(HERE, '..', '..', 'launch', 'orders.launch')
FAILS = ', failure_kind: KIND, failures_per_km: 3.0, repair_time: 25.0'
SCENARIO = """
seed: 3
defaults: {max_speed: 1.0, acceleration: 0.5, battery_capacity: 0.4, charging_current: 3.0""" + FAILS + """}
robots: [{name: robot, count: 4, step_x: 2.0}]
zones:
  - {name: dock, rectangle: [-4.0, -4.0, -2.0, -2.0], charger: true, capacity: 1}
places:
  - {name: shelf_1, x: 6.0, duration: 5.0}
  - {name: shelf_2, x: 9.0, yaw: 1.0, duration: 5.0, duration_distribution: gamma, duration_cv: 0.5}
  - {name: gate, y: 9.0, yaw: -2.0, duration: 6.0, capacity: 1, queue: 2, preemption: true}
orders:
  - {name: picks, rate_per_hour: 220.0, count: 40, deadline: 90.0,
     stops: [{places: ['shelf_*'], action: load}, {place: gate, action: unload}]}
  - {name: rounds, every: 60.0, count: 12, priority: 1,
     stops: [{x: 3.0, y: 3.0, yaw: 0.7}, {area: [0.0, 0.0, 6.0, 6.0], duration: 4.0}]}
dispatcher: {policy: nearest, charge_below: 0.5, charge_until: 0.8, charge_when_idle: 0.7}
"""
#: a net of 3 x 3 nodes, lanes for one robot each in both directions
NET = json.dumps({
    'nodes': [{'name': 'n{}'.format(one), 'x': 10.0 * (one % 3), 'y': 10.0 * (one // 3)} for one in range(9)],
    'edges': [{'from': 'n{}'.format(one), 'to': 'n{}'.format(other), 'capacity': 1}
              for one in range(9) for other in (one + 1, one + 3) if other < 9 and (other - one == 3 or other % 3)]})
NARROW = """
seed: 2
lanes: net.yaml
deadlock: retreat
defaults: {max_speed: 1.0, acceleration: 0.5, routes: lanes}
robots: [{name: robot, count: 6, step_x: 10.0}]
zones: [{name: slow, rectangle: [3.0, -3.0, 7.0, 30.0], max_speed: 0.4}]
places: []
orders:
  - {name: picks, rate_per_hour: 900.0, count: 40,
     stops: [{area: [0.0, 0.0, 20.0, 20.0]}, {area: [0.0, 0.0, 20.0, 20.0]}]}
  - {name: rounds, every: 30.0, count: 10, priority: 1, stops: [{x: 20.0, y: 20.0}, {x: 0.0, y: 20.0}]}
dispatcher: {policy: nearest}
"""
POLICY = """
class Last:
    def choose(self, question):
        return [(question.robots[-1].name, question.orders[-1].order.order_id)]


class Wrong:
    def choose(self, question):
        return [('nobody', 'nothing')]
"""
GOOD = """
robots: [{name: a}]
places: [{name: p, x: 3.0, duration: 3.0}]
orders: [{name: good, every: 10.0, count: 5, stops: [{place: p}]}]
dispatcher: {}
"""
#: publishes an order that cannot be done, and one that can
PUBLISHER = """#!/usr/bin/env python3
import rospy
from move_base_abstract.msg import Order, OrderStop
rospy.init_node('any')
out = rospy.Publisher('orders', Order, queue_size=2)
rospy.sleep(1.0)
for name, x in (('bad', 1e308), ('last', 1.0)):
    stop = OrderStop()
    stop.pose.position.x, stop.pose.orientation.w = x, 1.0
    out.publish(Order(id=name, stops=[stop]))
"""


class DispatcherTest(OwnFolder, unittest.TestCase):

    def setUp(self):
        super().setUp()
        self.write('own_policies.py', POLICY)
        self.environment['PYTHONPATH'] = os.pathsep.join([self.folder, os.environ['PYTHONPATH']])

    def scenario(self, text=SCENARIO, kind='abort'):
        return self.write('scenario.yaml', text.replace('KIND', kind))

    def orders(self, scenario, *words, launch=LAUNCH, code=0):
        """Run the orders of a scenario; return (output, events)."""
        said, log, events = self.launch('run.jsonl', '--end-when-idle', launch, 'scenario:=' + scenario, *words,
                                        code=code)
        self.assertEqual(log.remarks()[bool(code):], [])  # the first says how it ended
        return said, events

    def check_rows(self, scenario, kinds, *words, **plainly):
        """Check that the rows are those of a Dispatch, and that there are these kinds; return the rows."""
        dispatch = Dispatch(read_scenario(scenario), **plainly)
        dispatch.run()
        plain = [(entry.time_ns, entry.robot, entry.kind, json.dumps(list(entry.values)))
                 for entry in dispatch.fleet.trace]
        self.assertEqual(self.orders(scenario, *words)[1], plain)
        self.assertLessEqual(kinds, {row[2] for row in plain})
        return plain

    def check_same(self, policy, kind):
        self.check_rows(self.scenario(kind=kind), {
            'order_returned', 'charge_assigned', 'failed', 'waiting_began', 'order_done'},
            'policy:=' + policy, policy=policy)

    def test_the_rows_of_a_run_are_those_of_plain_python(self):
        self.check_same('nearest', 'abort')

    def test_they_are_also_for_an_auction_and_robots_that_stall(self):
        self.check_same('auction', 'stall')

    def test_they_are_also_where_robots_give_way_to_one_another_have_priorities_and_drive_slowly(self):
        self.write('net.yaml', NET)
        plain = self.check_rows(self.scenario(NARROW), {'gave_way', 'priority', 'entered', 'held', 'order_done'})
        self.assertEqual(sum(row[2] == 'order_done' for row in plain), 50)

    def test_they_are_also_where_robots_look_ahead(self):
        text = SCENARIO
        for old, new in ((FAILS, ''), ('capacity: 0.4, charging_current: 3.0', 'capacity: 0.2, charging_current: 20.0'),
                         ('duration: 6.0', 'duration: 60.0'), ('charge_below: 0.5', 'charge_below: 0.1'),
                         ('charge_when_idle: 0.7', 'charge_full: 0.9, charge_reserve: 0.05')):
            self.assertIn(old, text)
            text = text.replace(old, new)
        plain = self.check_rows(self.scenario(text), {'charge_assigned', 'order_returned', 'order_done'})
        self.assertIn('charge too low', str([row for row in plain if row[2] == 'order_returned']))

    def test_a_users_policy_is_taken_by_its_name_and_a_wrong_one_moves_nobody(self):
        scenario = self.scenario(kind='abort')
        _, events = self.orders(scenario, 'policy:=own_policies:Last')
        self.assertEqual(next(event[1] for event in events if event[2] == 'order_assigned'), 'robot_3')
        self.assertGreaterEqual(sum(event[2] == 'order_done' for event in events), 50)
        said, events = self.orders(scenario, 'policy:=own_policies:Wrong', code=1)
        self.assertIn("'/dispatcher' has 1 waiting thread (waits for the end of orders: picks_1 with nobody; ", said)
        self.assertIn("the policy Wrong chose 'nothing' for 'nobody'; allowed: a robot of question.robots", said)
        kinds = {kind for _, _, kind, _ in events}
        self.assertLessEqual({'order_arrived', 'policy_failed'}, kinds)
        self.assertNotIn('order_assigned', kinds)

    def test_an_order_that_cannot_be_done_is_refused_starves_no_other_and_the_exit_code_is_not_0(self):
        self.write('package.xml', MANIFEST)
        self.write('any', PUBLISHER, 0o755)
        self.environment['ROS_PACKAGE_PATH'] = os.pathsep.join([self.folder, os.environ['ROS_PACKAGE_PATH']])
        both = self.write('both.launch', '<launch><arg name="scenario"/><include file="{}" pass_all_args="true"/>'
                          '<node pkg="study_of_others" type="any" name="any"/></launch>'.format(LAUNCH))
        for policy in POLICIES:
            said, events = self.orders(self.scenario(GOOD + 'seed: 0'), 'policy:=' + policy, launch=both, code=1)
            self.assertIn('order bad is refused: stops[0]: pose: pose: x must be within +-1e9 m, got 1e+308', said)
            self.assertIn('waits for the end of orders: bad refused', said)
            done = [json.loads(values)[0] for _, _, kind, values in events if kind == 'order_done']
            self.assertEqual(sorted(done), ['good_1', 'good_2', 'good_3', 'good_4', 'good_5', 'last'])

    def test_parameters_that_cannot_be_used_end_the_node_with_the_reason(self):
        code, said = self.run_it('lockstep_launch', LAUNCH, 'scenario:=' + self.scenario(), 'policy:=best')
        self.assertNotEqual(code, 0)
        self.assertIn("/dispatcher/policy: got 'best'; allowed: nearest, ", said)
