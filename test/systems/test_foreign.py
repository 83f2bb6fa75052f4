"""tools/foreign: what it says of systems that are the same, that differ, that are labelled, and that are not here.

The systems are tiny packages of these tests, in git repositories of their own.
"""
import importlib.util
import os
import subprocess
import sys
import unittest
from pathlib import Path

import pytest
import yaml
from own_folder import GUARD, MANIFEST, OwnFolder

ROOT = Path(__file__).resolve().parents[2]
TOOL = ROOT / 'tools' / 'foreign'
PAGE = ROOT / 'docs' / 'compatibility.md'
LAUNCH = '<launch><node pkg="{0}" type="node.py" name="{0}" output="screen"/>{1}</launch>'
HEARS = '<node pkg="{}" type="hears.py" name="hears"/>'
#: a node that says something at 1 s and ends; ``what`` is an expression
NODE = """#!/usr/bin/env python3
import os, time, rospy
from std_msgs.msg import String
rospy.init_node('node')
said = rospy.Publisher('said', String, queue_size=1)
rospy.sleep(1.0)
said.publish(str({what}))
rospy.sleep(1.0)
{end}
"""
HEARER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import String
rospy.init_node('hears')
rospy.Subscriber('said', String, lambda said: None)
rospy.spin()
"""
FOLDER = 'os.getcwd()'  # the working folder, which has another name in each run, and is no label
NAMES = ('plain', 'one core')
NIGHT_GUARD = 7200.0  # s, wall


def the_tool():
    spec = importlib.util.spec_from_file_location('foreign_tool', TOOL / '__main__.py')
    tool = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = tool
    spec.loader.exec_module(tool)
    return tool


class ForeignSuite(OwnFolder, unittest.TestCase):

    def setUp(self):
        super().setUp()
        self.environment.update(GIT_AUTHOR_NAME='a', GIT_AUTHOR_EMAIL='a@example.org', GIT_COMMITTER_NAME='a',
                                GIT_COMMITTER_EMAIL='a@example.org', GIT_CONFIG_COUNT='1',
                                GIT_CONFIG_KEY_0='url.{}/.insteadOf'.format(self.path('server')),
                                GIT_CONFIG_VALUE_0='https://github.com/')

    def git(self, name, *words):
        done = subprocess.run(['git', '-C', self.path('server/study/' + name), *words], check=True, text=True,
                              env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        return done.stdout.strip()

    def publish(self, name, what, end='', node=NODE):
        """Put a package into a repository of its own; return its row for the table."""
        for file, text, mode in (('package.xml', MANIFEST.replace('study_of_others', name), 0o644),
                                 ('node.py', node.format(what=what, end=end), 0o755), ('hears.py', HEARER, 0o755),
                                 ('it.launch', LAUNCH.format(name, HEARS.format(name)), 0o644)):
            self.write('server/study/{}/{}'.format(name, file), text, mode)
        self.git(name, 'init', '-q')
        self.git(name, 'add', '.')
        self.git(name, 'commit', '-q', '-m', 'first')
        return {'name': name, 'commits': {'study/' + name: self.git(name, 'rev-parse', 'HEAD')}, 'packages': [name],
                'ran': 'all', 'robots': 'none', 'launch': name + ' it.launch', 'options': ['--until', '4']}

    def suite(self, *rows, words=('--conditions', ','.join(NAMES)), code=0):
        """Run the tool with a table of these rows; return {system: its row of the page}, and what else it said."""
        table = self.write('systems.yaml', yaml.safe_dump(list(rows)))
        done = subprocess.run([sys.executable, str(TOOL), '--fetch', '--table', table, '--sources',
                               self.path('sources'), *words], check=False, env=self.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=GUARD)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        printed = [[cell.strip() for cell in line.split('|')[1:-1]] for line in done.stdout.splitlines()[2:]]
        return {row[0].partition(']')[0][1:]: row for row in printed}, done.stderr

    def test_a_system_that_differs_though_called_repeatable_is_false_and_one_that_tells_of_it_is_labelled(self):
        rows = [self.publish('differs', FOLDER, end='{}[1]'), self.publish('tells', "os.getpid() and 'it'")]
        found, said = self.suite(*rows, code=1)
        self.assertRegex(said, r'next: ROS_PACKAGE_PATH=\S+ rosrun move_base_abstract verify --crashes allow --until 4 '
                         'differs it.launch')
        self.assertEqual([row[1:5] for row in found.values()], [['all', 'none', '3 s', count] for count in '21'])
        self.assertEqual(found['tells'][0], '[tells](https://github.com/study/tells) `{}`'.format(
            rows[1]['commits']['study/tells'][:7]))
        self.assertRegex(found['differs'][-1], r'^FALSE: called repeatable, but not like plain: one core '
                         r'\(other bytes\); but /differs crashed at 3\.0.* KeyError')
        self.assertRegex(found['tells'][-1], r'^labelled \(.*os\.getpid in .*node\.py, line 7.*\): the same bytes '
                         r'\(plain, one core\)$')

    def test_the_words_for_what_the_runs_of_a_system_were(self):
        tool = the_tool()

        def said(*runs):
            """Return the verdict on runs (bytes of the log, label), or on the error that stands in their place."""
            outcomes = []
            for name, run in zip(NAMES, runs):
                end = None if isinstance(run, str) else {'not_repeatable_because': run[1:], 'degraded_because': []}
                outcomes.append(tool.Outcome(name, error=run) if end is None else tool.Outcome(
                    name, tool.launched.Run(*[0.0] * 5, 9.0, 1, 1, end, run[0], [])))
            return tool.verdict(outcomes)
        self.assertEqual(said(['a'], ['a']), ('repeatable: the same bytes (plain, one core)', True))
        self.assertEqual(said(['a', 'why'], ['a', 'why']), ('labelled (why): the same bytes (plain, one core)', True))
        self.assertEqual(said(['a', 'why'], ['b', 'why']), ('labelled (why): not like plain: one core (other bytes)',
                                                            True))
        self.assertEqual(said(['a', 'why'], ['b']), ('FALSE: called repeatable, but not like plain: one core (other '
                                                     'bytes)', False))
        self.assertEqual(said(['a'], 'not over'), ('FALSE: called repeatable, but not like plain: one core (not over)',
                                                   False))
        self.assertEqual(said(['a', 'why'], 'not over'), ('labelled (why): not like plain: one core (not over)', False))
        self.assertEqual(said('not over', 'not over'), ('not over (plain, one core)', False))

    def test_what_is_not_here_is_left_out_and_no_failure(self):
        rows = [self.publish(name, "'it'") for name in ('gone', 'changed', 'other', 'unbuilt', 'missing')]
        rows.append(self.publish('broken', '', node='#!/usr/bin/env python3\nimport nowhere, rospy\n'
                                                    "rospy.init_node('broken')\n"))
        rows[0]['commits'] = {'study/nowhere': 40 * '0'}
        rows[3]['launch'] = self.write('unbuilt.launch', LAUNCH.replace('node.py', 'node').format(
            'unbuilt', HEARS.format('unbuilt')))
        rows[4]['launch'] = 'missing no_such.launch'
        for name in ('changed', 'other'):
            subprocess.run(['git', 'clone', '-q', self.path('server/study/' + name), self.path('sources/' + name)],
                           check=True, env=self.environment)
        self.write('sources/changed/node.py', '#!/usr/bin/env python3\n', 0o755)
        rows[2]['commits'] = {'study/other': 40 * '1'}
        found, said = self.suite(*rows)
        self.assertEqual(found, {})
        changed, other = (self.path('sources/' + name) for name in ('changed', 'other'))
        for words in ('gone: left out: https://github.com/study/nowhere at commit 0000', ' cannot be fetched: fatal: ',
                      'changed: left out: {} is not as published: M node.py'.format(changed),
                      'other: left out: {} is at commit '.format(other), 'missing: left out: it cannot be run: ',
                      'unbuilt: left out: it cannot be run: lockstep_launch: nothing is started, because '
                      'programs are not here: /unbuilt: there is no program ',
                      'broken: left out: it cannot be run: lockstep_launch: /broken ended (exit code 1) before it took',
                      'foreign: 0 systems were run, 6 were left out'):
            self.assertIn(words, said)

    def test_a_run_that_does_not_end_is_told(self):
        row = self.publish('hangs', "'it'", end='while True: time.sleep(0.01)')
        found, said = self.suite(row, words=('--time-limit', '6', '--conditions', 'plain'), code=1)
        self.assertEqual(found['hangs'][-1], 'not over after 6 s (plain)')
        self.assertIn('hangs: plain: not over after 6 s', said)

    def test_a_table_that_cannot_be_used_is_named(self):
        row = self.publish('equal', "'it'")
        row['commits'] = {'study/equal': 'main'}
        _found, said = self.suite(row, code=2)
        self.assertIn("systems.yaml: equal: the commit of study/equal must have 40 hexadecimal digits, got 'main'",
                      said)

    @pytest.mark.night
    def test_the_public_systems_that_are_here_are_what_they_say(self):
        done = subprocess.run([sys.executable, str(TOOL)], check=False, env=dict(os.environ), text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=NIGHT_GUARD)
        if 'foreign: 0 systems were run' in done.stderr:
            self.skipTest('no public system is here')
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_page_has_each_system_of_the_table_at_its_commit(self):
        page, own = PAGE.read_text(encoding='utf-8'), TOOL / '.systems'
        for row in yaml.safe_load((own / 'systems.yaml').read_text(encoding='utf-8')):
            name, commit = next(iter(row['commits'].items()))
            self.assertIn('[{}](https://github.com/{}) `{}`'.format(row['name'], name, commit[:7]), page)
            self.assertTrue((own / row['launch']).exists(), row['launch'])
