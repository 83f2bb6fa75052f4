"""Twelve coordinators with one bug each: failures that chaos has found repeat, and do not occur without the bug.

test/.nodes/coordinators/found.json has what `chaos --until 300` found for each, after shrinking, with `--delay 0.05` or
`--starts 0.5`. counted.json has in how many seeds, by what is varied.
"""
import json
import os
import unittest

import pytest
from own_folder import OwnFolder
from own_nodes import NODES

FOLDER = os.path.join(NODES, 'coordinators')
LAUNCH = os.path.join(FOLDER, 'coordinators.launch')
MOST_DECISIONS = 3
NAMES = ('lost_result', 'two_goals', 'cancel_race', 'early_close', 'stale_pose', 'late_listener', 'double_assignment',
         'missing_lock', 'status_order', 'timeout_answer', 'early_call', 'one_shot')


def read(name):
    with open(os.path.join(FOLDER, name), encoding='utf-8') as stream:
        return json.load(stream)


class CoordinatorsTest(OwnFolder, unittest.TestCase):

    def check(self, name):
        """Replay the failure of a coordinator; run it without its bug in the stated order and with the same seed."""
        found = read('found.json')[name]
        self.assertLessEqual(len(found['only']), MOST_DECISIONS)
        file = self.write('found.json', json.dumps({
            'chaos': 3 if 'starts' in found else 1, 'launch': [LAUNCH, 'coordinator:=' + name],
            'document': {'until': 300.0}, 'text': '', 'sha256': '', **found}))
        code, said = self.run_it('chaos', '--replay', file)
        self.assertEqual(code, 1, said)
        for line in found['happened']:
            self.assertIn(line, said)
        self.assertIn('chaos: failed: {} crashed at '.format(found['failure'].split()[1]), said)
        seeds = '{0}:{0}'.format(found['seed'])
        code, said = self.run_it('chaos', '--delay', str(found['delay']), '--starts', str(found.get('starts', 0)),
                                 '--until', '300', '--workers', '1', '--seeds', seeds, LAUNCH,
                                 'coordinator:=' + name, 'correct:=true')
        self.assertEqual(code, 0, said)


    def test_each_is_found_by_what_is_varied_and_no_twin_fails(self):
        counted = read('counted.json')
        self.assertEqual([*read('found.json')], [*NAMES])
        self.assertEqual([*counted], [name for name in NAMES if name in counted])
        for name, one in counted.items():
            self.assertGreater(max(one[kind] for kind in ('order', 'delays', 'starts')), 0, name)
            self.assertEqual(one['twin'], 0, name)
        for name in ('early_call', 'one_shot'):
            self.assertEqual((counted[name]['order'], counted[name]['delays']), (0, 0), name)
            self.assertGreater(counted[name]['starts'], 0, name)

    @pytest.mark.night
    def test_no_twin_fails_in_50_seeds(self):
        for name in NAMES:
            with self.subTest(name):
                code, said = self.run_it('chaos', '--count', '--seeds', '1:50', '--until', '300', LAUNCH,
                                         'coordinator:=' + name, 'correct:=true')
                self.assertEqual(code, 0, said)


for each in NAMES:
    setattr(CoordinatorsTest, 'test_' + each, lambda self, name=each: self.check(name))
