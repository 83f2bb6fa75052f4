"""Ten coordinators with one bug each: failures that chaos has found repeat, and do not occur without the bug.

test/.nodes/coordinators/found.json has what `chaos --delay 0.05 --until 300` found for each, after shrinking.
"""
import json
import os
import unittest

from own_folder import OwnFolder
from own_nodes import NODES

FOLDER = os.path.join(NODES, 'coordinators')
LAUNCH = os.path.join(FOLDER, 'coordinators.launch')
MOST_DECISIONS = 3


class CoordinatorsTest(OwnFolder, unittest.TestCase):

    def check(self, name):
        """Replay the failure of a coordinator; run it without its bug in the stated order and with the same seed."""
        with open(os.path.join(FOLDER, 'found.json'), encoding='utf-8') as stream:
            found = json.load(stream)[name]
        self.assertLessEqual(len(found['only']), MOST_DECISIONS)
        file = self.write('found.json', json.dumps({
            'chaos': 1, 'launch': [LAUNCH, 'coordinator:=' + name], 'document': {'until': 300.0}, 'text': '',
            'sha256': '', **found}))
        code, said = self.run_it('chaos', '--replay', file)
        self.assertEqual(code, 1, said)
        for line in found['happened']:
            self.assertIn(line, said)
        self.assertIn('chaos: failed: {} crashed at '.format(found['failure'].split()[1]), said)
        seeds = '{0}:{0}'.format(found['seed'])
        code, said = self.run_it('chaos', '--delay', str(found['delay']), '--until', '300', '--workers', '1', '--seeds',
                                 seeds, LAUNCH, 'coordinator:=' + name, 'correct:=true')
        self.assertEqual(code, 0, said)


for each in ('lost_result', 'two_goals', 'cancel_race', 'early_close', 'stale_pose', 'late_listener',
             'double_assignment', 'missing_lock', 'status_order', 'timeout_answer'):
    setattr(CoordinatorsTest, 'test_' + each, lambda self, name=each: self.check(name))
