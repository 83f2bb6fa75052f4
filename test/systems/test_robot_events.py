"""The topic ~events has the rows of the event log in its order, and programs that react to it repeat exactly."""
import json
import os
import unittest

from lockstep_launcher_run import Scenario, run_scenario

READER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'robot_event_reader.py')
KINDS = ('goal', 'departed', 'stands', 'ended', 'battery')


class RobotEventsTest(Scenario, unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.runs = run_scenario({'event_reader': [READER]}, until=40.0, fleet=[
            {'name': 'robot_0', 'battery_capacity': 0.5, 'battery_thresholds': [0.9999, 0.9998]},
            {'name': 'robot_1', 'start_y': 4.0}])

    def test_it_has_the_rows_of_the_event_log_in_their_order(self):
        rows = []
        for line in self.runs[0].log.decode().splitlines()[1:-1]:
            row = json.loads(line)
            if row['kind'] in KINDS:
                texts = [value for value in row['values'] if isinstance(value, str)]
                numbers = [float(value) for value in row['values'] if not isinstance(value, str)]
                rows.append('{} {} {} {} {}'.format(row['time_ns'], row['robot'], row['kind'], texts, numbers))
        heard = self.runs[0].printed('event_reader')
        self.assertEqual(heard, rows[:len(heard)])
        self.assertLess(len(rows) - len(heard), 4)  # the events at the very end were not heard
        self.assertEqual({line.split()[2] for line in heard}, set(KINDS))
        self.assertEqual({line.split()[1] for line in heard}, {'robot_0', 'robot_1'})
