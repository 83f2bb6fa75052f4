"""Statements of nodes in Python, in C++ and by topic become the same rows; a broken one fails the run."""
import json
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import psutil
from own_folder import GUARD, OwnPackage

from move_base_abstract_ros.loopback import find_executable

IN_PYTHON = """#!/usr/bin/env python3
import rospy
from move_base_abstract.properties import always, never_again, sometimes
rospy.init_node('x')
for k in range(5):
    rospy.sleep(1.0)
    always(k < 3, 'k stays small', k=k, **{'a\\n"b"': 0.5})
    sometimes(k > 10, 'k gets large')
    sometimes(k > 1, 'k gets past 1')
    never_again(k % 2 == 1, 'k is odd once')
"""
ENDLESS = """#!/usr/bin/env python3
import rospy
rospy.init_node('endless')
while not rospy.is_shutdown():
    rospy.sleep(1.0)
"""
BY_TOPIC = """#!/usr/bin/env python3
import json
import rospy
from std_msgs.msg import String
rospy.init_node('x')
said = rospy.Publisher('/properties', String, queue_size=10)
for k in range(5):
    rospy.sleep(1.0)
    for kind, holds, text, details in (
            ('always', k < 3, 'k stays small', {'k': k, 'a\\n"b"': 0.5}), ('sometimes', k > 10, 'k gets large', {}),
            ('sometimes', k > 1, 'k gets past 1', {}), ('never_again', k % 2 == 1, 'k is odd once', {})):
        said.publish(json.dumps({'kind': kind, 'holds': holds, 'text': text, 'details': details}))
    said.publish('{"kind": "always", "holds": 1}')
"""
LAUNCH = """<launch>
  <node pkg="study_of_others" type="stater" name="stater"/>
  <node pkg="study_of_others" type="topic" name="topic"/>
  <include file="$(find move_base_abstract)/launch/properties.launch"/>
  <node pkg="move_base_abstract" type="shim_statements" name="shim"/>
</launch>
"""
ROWS = [
    [2, ['always', 'k stays small', 'stated']], [2, ['sometimes', 'k gets large', 'stated']],
    [2, ['sometimes', 'k gets past 1', 'stated']], [2, ['never_again', 'k is odd once', 'stated']],
    [4, ['sometimes', 'k gets past 1', 'held']],
    [5, ['always', 'k stays small', 'broken', 'a "b"=0.5', 'k=3']], [5, ['never_again', 'k is odd once', 'broken']]]


class PropertiesTest(OwnPackage, unittest.TestCase):
    FILES = {'stater': IN_PYTHON, 'topic': BY_TOPIC, 'system.launch': LAUNCH}

    def test_statements_are_the_same_rows_whoever_makes_them_and_breaks_are_told(self):
        said, _, events = self.launch('events.jsonl', '--check', self.path('system.launch'), code=4)
        for node in ('/stater', '/topic', '/shim'):
            self.assertEqual([[time_ns // 10 ** 9, json.loads(values)] for time_ns, robot, kind, values in events
                              if kind == 'property' and robot == node], ROWS, node + said)
            self.assertIn('broken: always: at 5.000000000 s, {}: k stays small (a "b"=0.5, k=3)'.format(node), said)
        self.assertRegex(said, 'a message of /topic on /properties is not a statement: got .*; allowed: an object with')

    def test_a_run_that_breaks_something_fails_as_a_test_in_words(self):
        results = self.path('results.xml')
        file = self.write('system.launch', '<launch><node pkg="study_of_others" type="stater" name="stater"/></launch>')
        code, said = self.run_it('run_checked', file, '--gtest_output=xml:' + results, '__name:=x')
        self.assertEqual(code, 1, said)
        cases = {case.get('name'): [one.get('message') for one in case] for case in ElementTree.parse(results).iter(
            'testcase')}
        self.assertEqual({name: told for name, told in cases.items() if told}, {
            'always: /stater: k stays small':
                ['always: at 5.000000000 s, /stater: k stays small (a "b"=0.5, k=3)'],
            'never_again: /stater: k is odd once': ['never_again: at 5.000000000 s, /stater: k is odd once']})
        self.assertEqual(len(cases), 1 + 7 + 2)

    def test_only_of_a_run_that_ran_and_of_what_was_asked_for_kept_is_said(self):
        self.write('early', '#!/usr/bin/env python3\nimport sys, rospy\nsys.exit(3)\n', 0o755)
        early, good = (self.write(name + '.launch', '<launch><node pkg="study_of_others" type="{}" name="x"/></launch>'
                                  .format(name)) for name in ('early', 'stater'))
        for words, cases in ((['--check', '--wrongopt', good], 0), (['--check', early], 0),
                             (['--property', 'charged', '--end-when-idle', good], 2)):
            code, said = self.run_it('lockstep_launch', *words, '--gtest_output=xml:' + self.path('r.xml'), '__name:=x')
            self.assertEqual((code, said.count(': kept')), (0 if cases else 1, cases), said)
            self.assertEqual(len(list(ElementTree.parse(self.path('r.xml')).iter('testcase'))), max(cases, 1))

    def test_a_test_that_is_ended_leaves_nothing_behind(self):
        self.write('endless', ENDLESS, 0o755)
        words = ['--check', '--gtest_output=xml:' + self.path('result.xml'), self.write(
            'endless.launch', '<launch><node pkg="study_of_others" type="endless" name="endless"/></launch>')]
        with subprocess.Popen([sys.executable, find_executable('lockstep_launch'), *words], env=self.environment,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as test:
            told = next((line for line in test.stdout if 'process[endless' in line), None)
            family = psutil.Process(test.pid).children(recursive=True)
            test.terminate()
            said = test.stdout.read()
        self.assertTrue(told)
        self.assertIn('the run comes to its end: broken', said)
        self.assertGreaterEqual(len(family), 3, family)
        _gone, alive = psutil.wait_procs(family, timeout=GUARD)
        self.assertEqual(alive, [])
