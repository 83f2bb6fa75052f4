"""What is not started: displays, which count nowhere, and programs that are not here."""
import json
import os
import unittest

from own_folder import MANIFEST, OwnFolder, OwnPackage

ABORTS = '#!/bin/sh\necho $0 >> "$STARTED"\nkill -ABRT $$\n'
OF_RQT = """#!/usr/bin/env python3
import os
with open(os.environ['STARTED'], 'a') as stream:
    print(__file__, file=stream)
os.abort()
from rqt_gui.main import Main
"""
RUNS = """#!/usr/bin/env python3
import rospy
rospy.init_node('runs')
for _ in range(3):
    rospy.sleep(1.0)
"""
FILE = """<launch>
  <node pkg="rviz" type="rviz" name="rviz" output="screen" {0}/>
  <node pkg="rqt_graph" type="rqt_graph" name="graph"/>
  <node pkg="rqt_gui" type="rqt_gui" name="gui"/>
  <node pkg="image_view" type="image_saver" name="saver"/>
  <node pkg="rqt_fleet" type="fleet.py" name="fleet" required="true"/>
  {1}
</launch>
"""
PROGRAMS = {'rviz/rviz': ABORTS, 'rqt_graph/rqt_graph': OF_RQT, 'image_view/image_saver': RUNS,
            'rqt_fleet/fleet.py': RUNS, 'others/looks': ABORTS}
EXPERIMENT = 'experiment: seen\nlaunch: of_others.launch\nuntil: {idle: true}\n'
#: (package, type, name) of nodes whose programs are not here, and what is said of them
LOST = {('move_base', 'move_base', 'move_base'): 'there is no program move_base/move_base (ours: --replace move_base/'
                                                 'move_base=move_base_abstract/move_base)',
        ('study_of_others', 'gone.py', 'gone'): 'there is no program study_of_others/gone.py',
        ('of_nobody', 'x', 'other'): 'there is no program of_nobody/x',
        ('study_of_others', 'for_nobody', 'asks'): '{}/for_nobody is a program for /usr/bin/no_such_interpreter, which'}
NODE = '<node pkg="{}" type="{}" name="{}" required="true"/>'
WITH_LOST = '<launch>{}'.format(''.join(NODE.format(*words) for words in LOST))
SOME_HERE = ''.join(NODE.format('study_of_others', name + '.py', name) for name in ('runs', 'old')) + '</launch>'


class MissingTest(OwnPackage, unittest.TestCase):
    FILES = {'runs.py': RUNS, 'old.py': RUNS.replace('python3', 'python2.1'),
             'for_nobody': '#!/usr/bin/no_such_interpreter\n'}

    def test_a_file_whose_programs_are_not_here_ends_with_all_of_them(self):
        path = self.write('lost.launch', WITH_LOST + SOME_HERE)
        for program, *words in (('lockstep_launch',), ('lockstep_launch', '--list'),
                                ('lockstep_launch', '--onlooker', '/gone'), ('chaos', '--seeds', '1'), ('verify',)):
            code, said = self.run_it(program, *words, path)
            self.assertEqual(code, 2, said)
            for (_package, _type, name), why in LOST.items():
                self.assertIn('/{}: {}'.format(name, why.format(self.folder)), said)
            self.assertNotIn('/old', said)  # the launcher has a Python for it
            self.assertIn('--tolerant all of these', said)
            self.assertEqual('If the file was written for' in said, program != 'chaos')

    def test_a_tolerant_run_leaves_them_out_if_anything_is_left(self):
        said, log, _ = self.launch('a.jsonl', '--tolerant', self.write('lost.launch', WITH_LOST + SOME_HERE))
        self.assertIn('2 of 2 nodes take part: /runs, /old\n', said)
        self.assertIn('lockstep_launch: /gone is left out: there is no program study_of_others/gone.py; it is '
                      'required, so the run would have ended with it: --end-when-idle or --until S ends it\n', said)
        self.assertTrue(log.end['repeatable'])
        code, said = self.run_it('lockstep_launch', '--tolerant', self.write('lost.launch', WITH_LOST + '</launch>'))
        self.assertEqual(code, 2, said)
        for text in ('nothing is started, because nothing is left: ', '/gone is left out: there is no program study'):
            self.assertIn(text, said)

    def test_an_experiment_ends_with_them_before_its_first_trial(self):
        for text, why, more in (
                (WITH_LOST + SOME_HERE, '/gone: there is no program study_of_others/gone.py', ''),
                (WITH_LOST + '</launch>', '/gone is left out: there is no program study_of_others', 'tolerant: true\n'),
                ('<launch><include file="$(find of_nobody)/a.launch"/></launch>', 'the package of_nobody is not found',
                 '')):
            self.write('lost.yaml', EXPERIMENT.replace('of_others', 'lost') + more)
            self.write('lost.launch', text)
            code, said = self.run_it('experiment', 'run', 'lost.yaml', '-o', 'out', '--workers', '1')
            self.assertEqual((code, why in said, os.path.exists(self.path('out'))), (2, True, False), said)


class DisplaysTest(OwnFolder, unittest.TestCase):
    def setUp(self):
        super().setUp()
        for name, text in PROGRAMS.items():
            package = name.partition('/')[0]
            self.write(package + '/package.xml', MANIFEST.replace('study_of_others', package))
            self.write(name, text, 0o755)
        self.environment['ROS_PACKAGE_PATH'] = os.pathsep.join([self.folder, os.environ['ROS_PACKAGE_PATH']])
        self.environment.update(STARTED=self.path('started'), DISPLAY=':99')

    def file(self, of_rviz='required="true"', more=''):
        """Write the launch file; return its path."""
        return self.write('of_others.launch', FILE.format(of_rviz, more))

    def started(self):
        """Return the names of the displays that were started."""
        if not os.path.exists(self.path('started')):
            return []
        with open(self.path('started')) as stream:
            return sorted({os.path.basename(line.strip()) for line in stream})

    def test_without_a_screen_they_are_left_out_with_a_note(self):
        del self.environment['DISPLAY']
        said, log, _ = self.launch('a.jsonl', self.file())
        self.assertIn('2 of 2 nodes take part: /saver, /fleet\n', said)
        for name in ('/rviz', '/graph'):
            self.assertIn('{0} is not started: it only displays, and there is no screen here (DISPLAY is not set); '
                          '--onlooker {0} starts it\n'.format(name), said)
        self.assertIn('/gui is not started: it only displays, and it is not installed here\n', said)
        self.assertEqual((self.started(), log.end['repeatable']), ([], True))

    def test_with_a_screen_they_are_started_and_their_crashes_do_not_count(self):
        said, log, _ = self.launch('a.jsonl', self.file(''))
        self.assertIn('/rviz looks on: it only displays\n', said)
        self.assertNotIn('crash:', said)
        self.assertEqual((self.started(), log.end['repeatable']), (['rqt_graph', 'rviz'], True))

    def test_verify_and_chaos_start_none(self):
        for program, words in (('verify', ('--conditions', 'plain,again')), ('chaos', ('--seeds', '1'))):
            _code, said = self.run_it(program, *words, self.file())
            self.assertIn('next: ', said)
            self.assertEqual(self.started(), [], said)

    def test_trials_start_none_and_no_onlooker_makes_one_incomplete(self):
        self.file()
        self.write('seen.yaml', EXPERIMENT)
        code, said = self.run_it('experiment', 'run', 'seen.yaml', '-o', 'out', '--workers', '1')
        self.assertEqual((code, self.started()), (0, []), said)
        self.file(more='<node pkg="others" type="looks" name="looks" required="true"/>')
        self.write('seen.yaml', EXPERIMENT + 'onlooker: [/rviz]\n')
        code, said = self.run_it('experiment', 'run', 'seen.yaml', '-o', 'more', '--workers', '1')
        self.assertEqual((code, self.started()), (0, ['looks', 'rviz']), said)
        name, = os.listdir(self.path('more/trials'))
        with open(self.path('more/trials/{}/trial.json'.format(name))) as stream:
            trial = json.load(stream)
        self.assertEqual((trial['status'], trial['crashes'], trial['repeatable']), ('complete', [], True))
        self.assertEqual(trial['labels'], ['/looks crashed: ended by SIGABRT; it looks on'])
