"""The node mapf_drive: the same rows as in plain Python, to the byte, with delays and moves that fail."""
import json
import os
import unittest

import numpy as np
import yaml
from own_folder import OwnFolder
from warm import Loopback

from move_base_abstract.msg import RobotEvent
from move_base_abstract_mapf.driving import drive
from move_base_abstract_mapf.layout import Grid, read_folder, write_folder
from move_base_abstract_mapf.movingai import Problem
from move_base_abstract_mapf.plans import read_plan
from move_base_abstract_ros.nodes.orders_run.mapf_drive_node import PlanNode

LAUNCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'launch', 'mapf.launch')
#: two agents that follow each other, one behind them, one that rests; (row, column), as EECBS writes them
PLAN = """Agent 0: (0,0)->(0,1)->(0,2)->(1,2)->(2,2)->
Agent 1: (0,1)->(0,2)->(0,3)->(0,3)->(0,4)->
Agent 2: (1,1)->(1,1)->(1,1)->(1,1)->(1,2)->
Agent 3: (4,4)->
"""


class MapfDriveTest(OwnFolder, unittest.TestCase):

    def setUp(self):
        super().setUp()
        self.plan = self.write('plan.txt', PLAN)

    def make_site(self, **defaults):
        grid, plan = Grid(np.zeros((5, 5), bool), 1.0), read_plan(self.plan)
        write_folder(self.path('site'), grid, [Problem(path[0], path[-1]) for path in plan.paths], 1.0, 'a test')
        path = self.path('site/scenario.yaml')
        with open(path) as stream:
            raw = yaml.safe_load(stream)
        raw['defaults'].update(defaults)
        with open(path, 'w') as stream:
            yaml.safe_dump(raw, stream)
        return self.path('site')

    def check_same(self, policy, **defaults):
        folder = self.make_site(**defaults)
        said, _, events = self.launch('run.jsonl', '--end-when-idle', LAUNCH, 'folder:=' + folder, 'plan:=' + self.plan,
                                      'policy:=' + policy)
        self.assertIn('all robots have come to their goals', said)
        site = read_folder(folder)
        plain = drive(site, read_plan(self.plan, site.grid.blocked), policy)
        self.assertTrue(plain.execution.is_over)
        self.assertEqual(events, [(entry.time_ns, entry.robot, entry.kind, json.dumps(list(entry.values)))
                                  for entry in plain.fleet.trace])
        return plain

    def test_a_plan_without_delays_is_driven_as_in_plain_python(self):
        self.assertEqual(self.check_same('order_kept').outcome(0.7).flow_time, 12)

    def test_so_is_one_with_delays_and_moves_that_fail(self):
        plain = self.check_same('cell_left', duration_distribution='lognormal', duration_cv=0.5, duration_factor=1.2,
                                failure_by_length=[[0.0, 0.3]])
        self.assertGreater(plain.execution.retries, 0)

    def test_a_plan_that_does_not_fit_ends_the_node_with_the_reason(self):
        folder = self.make_site()
        with open(self.plan, 'w') as stream:
            stream.write('Agent 0: (0,0)->(0,1)->\n')
        code, said = self.run_it('lockstep_launch', LAUNCH, 'folder:=' + folder, 'plan:=' + self.plan)
        self.assertNotEqual(code, 0)
        self.assertIn('the plan has 1 agents, but the scenario has 4 robots', said)

    def test_a_folder_that_is_not_given_is_named(self):
        with Loopback() as ros:
            self.environment = ros.environment
            code, said = self.run_it('lockstep', '--own', PlanNode.__module__, '__name:=drives')
        self.assertEqual(code, 1)
        self.assertIn('parameter /drives/folder: got none; allowed: the path of a folder that mapf import made', said)

    def test_an_event_that_no_robot_tells_so_changes_nothing(self):
        node = PlanNode.__new__(PlanNode)
        node._numbers = {'agent_0': 0}
        for execution in (None, self):  # self is no Execution, so a use of it would be an error
            node._execution = execution
            for texts in ([], ['agent_0-1'], ['agent_0-1', 'SUCCEEDED', '', '']):
                node._on_event(RobotEvent(kind='ended', robot='agent_0', texts=texts))
