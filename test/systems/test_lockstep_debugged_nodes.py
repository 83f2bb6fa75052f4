"""pdb in nodes of a run in lockstep: where it stops, what it shows, and that passed breakpoints change nothing."""
import os
import re
import select
import shutil
import subprocess
import tempfile
import time
import unittest

from own_folder import OwnPackage, events_of
from waiting import GUARD, wait_for

from move_base_abstract.runs.event_log import labels_of
from move_base_abstract_ros.debugging.node_sessions import NodeSessions
from move_base_abstract_ros.loopback import find_executable

TALKER = """#!/usr/bin/env python3
import rospy
from std_msgs.msg import Int32, String
rospy.init_node('talker')
rospy.Subscriber('/told', String, str)
rospy.Subscriber('/fired', String, str)
publisher = rospy.Publisher('/numbers', Int32, queue_size=10)
rate = rospy.Rate(10)
n = 0
while not rospy.is_shutdown():
    publisher.publish(n)
    n += 1
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        break
"""
LISTENER = """#!/usr/bin/env python3
import threading
import rospy
from std_msgs.msg import Int32, String
import arithmetic

class Robot:
    pass

class Listener:
    def __init__(self):
        self.total, self.is_ready = 0, False
        self.robots = [Robot() for _ in range(5)]
        self.out = rospy.Publisher('/told', String, queue_size=10)
        rospy.Subscriber('/numbers', Int32, self.hear)
        threading.Thread(target=self.work, daemon=True).start()

    def hear(self, message):
        import late_arithmetic
        self.total += arithmetic.double(message.data)
        self.total = late_arithmetic.plus(self.total)
        self.is_ready = self.total > 20

    def work(self):
        count = 0
        while not self.is_ready:
            pass
        while not rospy.is_shutdown():
            count += 1
            try:
                rospy.sleep(0.7)
            except rospy.ROSInterruptException:
                break
            self.out.publish('{} {} {}'.format(count, self.total, sorted(map(repr, set(self.robots[:count])))))

rospy.init_node('listener')
listener = Listener()
rospy.spin()
"""
ARITHMETIC = """def double(x):
    return x + x
"""
LATE = """def plus(x):
    y = x + 1
    return y
"""
#: as catkin makes one for the devel space
RELAY = """#!/usr/bin/env python3
python_script = '{}'
with open(python_script, 'r') as fh:
    context = {{'__builtins__': __builtins__, '__doc__': None, '__file__': python_script, '__name__': __name__}}
    exec(compile(fh.read(), python_script, 'exec'), context)
"""
NODES = '<node pkg="study_of_others" type="talker.py" name="talker"/>' \
        '<node pkg="study_of_others" type="listener.py" name="listener">{}</node>'


def line_of(text, words):
    """Return the number of the line of a text that has these words."""
    return next(number for number, line in enumerate(text.splitlines(), 1) if words in line)


HEAR = line_of(LISTENER, 'arithmetic.double')
SHOW = line_of(LISTENER, 'self.out.publish')
AFTER_WAIT = line_of(LISTENER, 'while not rospy')


class LockstepDebuggedNodesTest(OwnPackage, unittest.TestCase):
    FILES = {'talker.py': TALKER, 'listener.py': LISTENER, 'arithmetic.py': ARITHMETIC, 'late_arithmetic.py': LATE}

    def setUp(self):
        super().setUp()
        self.launch_file = self.write('two.launch', '<launch>{}</launch>'.format(NODES.format('')))
        self.shown, self.stops, self.news, self.at_first_stop = [], [], [], None

    def plain(self):
        """Return the bytes of the log of a run without a debugger."""
        self.launch('plain.jsonl', '--until', '5', '--log-messages', self.launch_file)
        with open(self.path('plain.jsonl'), 'rb') as stream:
            return stream.read()

    def debugged(self, places, commands, wanted='', launch_file='', typed_in='/listener'):
        """Run with breakpoints; type ``commands`` in the node ``typed_in``, else continue. Return the log's bytes.

        ``wanted``: the name of a node that stops at its first line. A command None is the end of the commands.
        """
        commands = list(commands)

        def read(node):
            return commands.pop(0) if commands and node == typed_in else 'continue'
        self.shown, self.stops, self.news = [], [], []
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            sessions = NodeSessions(folder, places)
            if wanted:
                sessions.stop_in(wanted)
            self.addCleanup(sessions.close)
            with open(self.path('output'), 'wb') as output:
                run = subprocess.Popen(
                    [find_executable('lockstep_launch'), '--event-log', self.path('debugged.jsonl'), '--until', '5',
                     '--log-messages', launch_file or self.launch_file],
                    env={**self.environment, **sessions.environment}, stdin=subprocess.DEVNULL, stdout=output,
                    stderr=output, cwd=self.folder)
            self.addCleanup(run.wait)
            self.addCleanup(run.kill)
            deadline = time.monotonic() + GUARD
            while run.poll() is None:
                self.assertLess(time.monotonic(), deadline, self.news)
                select.select([sessions], [], [], 0.1)
                for one in sessions.news():
                    self.news.append(one)
                    if one.kind == 'stopped':
                        self.stops.append(one.text)
                        if self.at_first_stop is not None:
                            self.at_first_stop(sessions)
                            self.at_first_stop = None
                        sessions.talk(one.node, lambda _prompt, node=one.node: read(node), self.shown.append)
        with open(self.path('output')) as said:
            self.assertEqual(run.returncode, 0, said.read())
        self.assertEqual(commands, [])
        with open(self.path('debugged.jsonl'), 'rb') as stream:
            return stream.read()

    @property
    def text(self):
        return ''.join(self.shown)

    def places_of_stops(self):
        return [stop.split(' in ')[0].rpartition('/')[2] for stop in self.stops]

    def test_passed_breakpoints_leave_the_log_as_it_is(self):
        plain = self.plain()
        places = [('listener.py', HEAR, ''), ('listener.py', SHOW, '/listener'), ('listener.py', AFTER_WAIT, ''),
                  ('arithmetic.py', 2, ''), ('late_arithmetic.py', 3, ''), ('talker.py', 11, '/listener'),
                  (self.path('talker.py'), 12, '')]
        found = self.debugged(places, ['where', 'p self.robots', 'p self.robots[3] in set(self.robots)', 'args'])
        self.assertEqual(found, plain)
        stops = self.places_of_stops()
        self.assertEqual({*stops}, {'listener.py:{}'.format(line) for line in (HEAR, SHOW, AFTER_WAIT)} | {
            'arithmetic.py:2', 'late_arithmetic.py:3', 'talker.py:12'})
        self.assertEqual([stops.count(one) for one in ('arithmetic.py:2', 'late_arithmetic.py:3', 'talker.py:12')],
                         [40, 40, 41])
        self.assertIn('Robot object at 0x', self.text)
        self.assertEqual([one for one in self.news if one.kind in ('touched', 'refused')], [])
        self.assertEqual(labels_of(events_of(self.path('debugged.jsonl'))[0].end), [])

    def test_steps_of_all_kinds_leave_the_log_as_it_is(self):
        plain = self.plain()
        commands = ['next', 'step', 'step', 'return', 'next', 'step', 'step', 'up', 'down', 'until', 'next', 'next',
                    'step', 'step', 'tbreak {}'.format(SHOW), 'list', 'continue', 'clear', 'frames all', 'step',
                    'where', 'continue']
        self.assertEqual(self.debugged([('listener.py', HEAR - 1, '/listener')], commands), plain)
        self.assertIn('/late_arithmetic.py(1)plus()', self.text)
        self.assertFalse([stop for stop in self.stops if '/move_base_abstract' in stop or '<frozen' in stop])

    def test_a_node_stops_at_its_first_line_and_goes_on_without_a_debugger(self):
        plain = self.plain()
        for commands in (['next', 'next', 'quit'], ['next', None]):
            self.assertEqual(self.debugged([('listener.py', HEAR, '')], commands, '/listener'), plain)
            self.assertEqual(self.places_of_stops()[0], 'listener.py:2')
            self.assertEqual(len(self.stops), len(commands))

    def test_a_relay_of_a_devel_space_stops_in_the_real_file(self):
        self.write('real/listener.py', LISTENER)
        self.write('listener.py', RELAY.format(self.path('real/listener.py')), 0o755)
        for name in ('arithmetic.py', 'late_arithmetic.py'):
            os.rename(self.path(name), self.path('real/' + name))
        self.environment['PYTHONPATH'] = os.pathsep.join([self.path('real'), os.environ.get('PYTHONPATH', '')])
        self.debugged([('real/listener.py', HEAR, '')], ['p message.data', 'quit'])
        self.assertEqual(self.places_of_stops(), ['listener.py:{}'.format(HEAR)])

    def test_what_changes_the_run_is_told_and_does_so(self):
        plain = self.plain()
        commands = ['!self.total = 100', 'clear', 'continue']
        self.assertNotEqual(self.debugged([('listener.py', HEAR, '')], commands), plain)
        self.assertEqual([(one.node, one.text.split(' was')[0]) for one in self.news if one.kind == 'touched'],
                         [('/listener', "'!self.total = 100'")])

    def test_a_node_that_charges_what_it_measures_is_not_debugged(self):
        charge = '<param name="lockstep_charge" value="measured"/>'
        launch_file = self.write('charged.launch', '<launch>{}</launch>'.format(NODES.format(charge)))
        self.debugged([('listener.py', HEAR, ''), ('talker.py', 12, '')], ['clear'], '', launch_file, '/talker')
        self.assertEqual(self.places_of_stops(), ['talker.py:12'])
        refused = [one.text for one in self.news if one.kind == 'refused']
        self.assertEqual(len(refused), 1)
        self.assertIn('/listener charges the time that it measures (lockstep_charge: measured)', refused[0])

    @unittest.skipUnless(shutil.which('gdb'), 'gdb is not installed')
    def test_a_roscpp_node_stops_in_gdb_and_the_log_is_as_without(self):
        node = '<node pkg="move_base_abstract" type="shim_timer" name="timers"/>'
        self.launch_file = self.write('timers.launch', '<launch>{}{}</launch>'.format(NODES.format(''), node))
        plain, gdb = self.plain(), []

        def attach(sessions):
            """Attach gdb while the talker stands at a breakpoint, so that time cannot go on before it is there."""
            note, found = self.path('attached'), sessions.nodes['/timers']
            self.assertEqual((found.is_python, os.path.basename(found.path)), (False, 'shim_timer'))
            with open(self.path('gdb'), 'wb') as output:
                gdb.append(subprocess.Popen(
                    ['gdb', '-q', '-batch', '-p', str(found.pid), '-ex', 'break ros::Publisher::publish', '-ex',
                     'shell : > ' + note, *['-ex', 'continue'] * 3, '-ex', 'bt', '-ex', 'info threads'], stdout=output,
                    stderr=output, stdin=subprocess.DEVNULL))
            wait_for('gdb', lambda: os.path.exists(note) or gdb[0].poll() is not None)
        self.at_first_stop = attach
        self.assertEqual(self.debugged([('talker.py', 12, '')], ['quit'], typed_in='/talker'), plain)
        gdb[0].wait(GUARD)
        with open(self.path('gdb')) as stream:
            said = stream.read()
        self.assertIn('nodeMain', said)
        self.assertIn('lockstep_watch', said)
        self.assertEqual(len(re.findall('^Thread .* hit Breakpoint 1', said, re.MULTILINE)), 3, said)

    def at_prompt(self, *commands, code=0):
        """Return what the program debug answers to commands."""
        ended, said = self.run_it('debug', '--commands', self.write('commands', '\n'.join(commands)), '--until', '5',
                                  self.launch_file)
        self.assertEqual(ended, code, said)
        return said

    def test_the_prompt_sets_breakpoints_talks_with_pdb_and_keeps_breakpoints_on_the_way_back(self):
        said = self.at_prompt(
            'break no_such.py', 'break /no/such.py:3', 'pdb nobody', 'gdb listener', 'clear x.py:1',
            'break listener.py:{} /listener'.format(HEAR), 'run 0.5', 'p ("first", message.data)', 'clear', 'continue',
            'back 1', 'run 0.5', 'p ("again", message.data)', '!self.total = 7', 'quit', 'pdb talker', 'run 0.5',
            'p ("talker", n)', 'quit', 'clear', 'break', code=1)
        for words in ("a breakpoint is FILE:LINE [NODE], such as planner.py:120 /planner; got 'no_such.py'",
                      "there is no file '/no/such.py'", "got 'nobody'",
                      '/listener is a Python program; use pdb or break', 'there is no breakpoint x.py:1',
                      "('first', 1)", "('again', 1)",
                      "('talker', ", "'!self.total = 7' was typed at a prompt", 'there are no breakpoints'):
            self.assertIn(words, said)

    @unittest.skipUnless(shutil.which('gdb'), 'gdb is not installed')
    def test_the_prompt_attaches_gdb_while_time_stands_and_the_run_stops_when_gdb_ends(self):
        node = '<node pkg="move_base_abstract" type="shim_timer" name="timers"/>'
        self.launch_file = self.write('timers.launch', '<launch>{}{}</launch>'.format(NODES.format(''), node))
        said = self.at_prompt('pdb timers', 'gdb timers', 'break ros::Publisher::publish', 'continue', 'bt', 'quit',
                              'where', code=1)
        self.assertIn('/timers is a C++ program; use gdb', said)
        self.assertIn('hit Breakpoint 1', said)
        self.assertIn('gdb has ended (exit code 0)', said)

    def test_without_a_debug_program_that_listens_the_run_is_a_plain_one(self):
        plain = self.plain()
        self.environment['MOVE_BASE_ABSTRACT_DEBUG'] = self.path('nobody')
        self.assertEqual(self.plain(), plain)
