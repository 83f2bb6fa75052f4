"""Unchanged launch files in lockstep, by lockstep_launch: participants, onlookers, and the ends of runs."""
import hashlib
import json
import math
import os
import re
import signal
import subprocess
import time
import unittest

import warm
from own_folder import GUARD, OwnPackage, events_of
from own_nodes import NODES

from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import read_scenario
from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
SYSTEM = os.path.join(NODES, 'foreign', 'system.launch')  # its prefix is left empty here
KINDS = """<launch>
  <group ns="one">
    <node pkg="move_base_abstract" type="shim_listener" name="relay" args="/a /b"/>
    <node pkg="move_base_abstract" type="move_base" name="move_base" respawn="true"/>
    <node pkg="move_base_abstract" type="fleet" name="fleet" launch-prefix="nice -n 3"/>
  </group>
  <node pkg="study_of_others" type="flags.py" name="flags" launch-prefix="nice -n 3"/>
  <node pkg="study_of_others" type="asker.py" name="asker" launch-prefix="/usr/bin/python3 -u"/>
  <node pkg="rostopic" type="rostopic" name="echo" args="echo /a"/>
  <node pkg="study_of_others" type="answerer.py" name="$(anon answerer)"/>
  <node pkg="rosbag" type="record" name="recorder" args="-a"/>
  <node pkg="move_base_abstract" type="shim_listener" name="again" args="/a /c" respawn="true"/>
  <node pkg="move_base_abstract" type="shim_listener" name="elsewhere" args="/a /d" machine="robot"/>
  <node pkg="move_base_abstract" type="shim_listener" name="near" args="/a /f" machine="desk"/>
  <node pkg="move_base_abstract" type="shim_listener" name="watched" args="/a /e"
        launch-prefix="$(find study_of_others)/gdb -ex run --args"/>
  <node pkg="study_of_others" type="options.py" name="no_node"/>
  <node pkg="study_of_others" type="both" name="both"/>
  <node pkg="study_of_others" type="wrapped" name="wrapped"/><node pkg="study_of_others" type="binary" name="binary"/>
  <node pkg="study_of_others" type="records" name="records"/>
  <node pkg="study_of_others" type="starts_recorder" name="starts_recorder"/>
  <node pkg="rosbag" type="play" name="player" args="x.bag"/>
  <machine name="desk" address="localhost"/><machine name="robot" address="192.0.2.1" env-loader="/opt/env.sh"/>
</launch>
"""
TICKING = """<launch>
  <node pkg="study_of_others" type="ticks.py" name="walk"/>
  {more}
</launch>
"""
SHELL = """<launch>
  <node pkg="study_of_others" type="both" name="both" args="a"/>
  <node pkg="study_of_others" type="wrapped" name="wrapped"/>
  <node pkg="study_of_others" type="child" name="child" ns="robot"/>
</launch>
"""
# Shell scripts as people write them: one finds its Python, one sets things up, one waits for its child. The machine may
# have no gdb.
SCRIPTS = {
    'gdb': '#!/bin/sh\n',
    'options.py': """#!/usr/bin/env python3
import argparse
parser = argparse.ArgumentParser(description='is no node')
parser.add_argument('--jobs')
parser.parse_args()
""",
    'both': """#!/bin/sh
'''exec' python3 -u -- "$0" "$@"
'''
import os
import sys
import rospy
from std_msgs.msg import String
rospy.init_node('x')
pub = rospy.Publisher('~said', String, queue_size=5)
for topic in ('~said', '/ticks', '/robot/ticks'):
    rospy.Subscriber(topic, rospy.AnyMsg, lambda message: None)
for number in range(3):
    rospy.sleep(1.5)
    pub.publish('%s %d %s' % (sys.argv[1], number, os.environ.get('PYTHONPATH', '').find('follow')))
rospy.spin()
""", 'wrapped': """#!/usr/bin/env bash
set -e
python3 -c 'import sitecustomize' 2> /dev/null || true
exec rosrun study_of_others ticks.py "$@"
""", 'child': """#!/bin/bash
"$(rospack find study_of_others)/ticks.py" "$@"
""", 'binary': """#!/bin/sh
exec rosrun move_base_abstract shim_listener /a /b "$@"
""", 'records': """#!/bin/sh
exec rosbag record -a "$@"
""", 'starts_recorder': """#!/bin/sh
rosrun rosbag record -a &
sleep 1000
"""}
LEAVING = '<launch><node pkg="study_of_others" type="leaves.py" name="leaves" required="true"/></launch>'
FATE = '<node pkg="study_of_others" type="fates.py" name="{0}" args="{0}" {1}/>'
FATES = """<launch>
  <node pkg="study_of_others" type="ticks.py" name="again" respawn="true" launch-prefix="sh -c 'exit 7'"/>
  <node pkg="study_of_others" type="ticks.py" name="ticks"/>
  <node pkg="move_base_abstract" type="move_base" name="move_base" ns="robot"/>
  <node pkg="move_base_abstract" type="shim_calls" name="calls"/>
  {}
</launch>
"""
# {node: the message about its crash}; there is no message about the others.
CRASHES = {
    '/callback': r'at 3\.0+ s: KeyError in a callback of /ticks, fates.py, line \d+',
    '/client': r'at \d\.\d+ s: AttributeError in a callback of /robot/move_base/(result|status), fates.py, line \d+',
    '/server': r'at 1\.\d+ s: KeyError in an action\'s execute callback, fates.py, line \d+',
    '/service': r'at 3\.0+ s: KeyError in the handler of service /service/ask, fates.py, line \d+',
    '/calls': r'at 1\.0+ s: std::exception in the handler of service /refuse',
    '/timer': r'at 3\.50+ s: KeyError in a callback of rospy.Timer, fates.py, line \d+',
    '/thread': r'at 4\.0+ s: KeyError in a thread, fates.py, line \d+',
    '/daemon': r'at 4\.0+ s: KeyError in thread pump, fates.py, line \d+',
    '/jobs': r'at 2\.0+ s: KeyError in a job whose outcome was never asked for, fates.py, line \d+ \(and 13 more\)',
    '/derived': r'at 3\.0+ s: Stop in a callback, fates.py, line \d+ \(and 3 more\)',
    '/items': r'at 1\.0+ s: KeyError in a job whose outcome was never asked for, fates.py, line \d+ \(and 1 more\)',
    '/saves': r'at 3\.0+ s: exit code 1',
    '/odd': r'at 2\.0+ s: TypeError in a callback of /ticks, an unknown place \(and \d+ more\)',
    '/unsaved': r'at 3\.0+ s: KeyError in a function of rospy.on_shutdown, fates.py, line \d+',
    '/raises': r'at 3\.0+ s: exit code 1; KeyError in the main thread, fates.py, line \d+',
    '/wrapped': r'at 3\.0+ s: exit code 139 \(in a shell, this means SIGSEGV\)',
    '/within': r'at 3\.0+ s: its connection was lost',
    '/interrupts': r'at 3\.0+ s: exit code 130 \(in a shell, this means SIGINT\)',
    '/exits': r'at 3\.0+ s: exit code 3', '/vanishes': r'at 3\.0+ s: exit code 4',
    '/faults': r'at 3\.0+ s: ended by SIGSEGV', '/killed': r'at 3\.0+ s: ended by SIGKILL',
    '/last_round': r'at \d+\.\d+ s: exit code 1; KeyError in the main thread, fates.py, line \d+',
    '/again': r': exit code 7', '/looks_on': r': \[ERROR\] bad callback: <function .*>'}


def nearest_idle(seed):
    """Return the trace of a fleet in plain Python in which each task of a seed goes to the nearest idle robot."""
    at, idle, waiting, doing = {'robot_0': (0.0, 0.0), 'robot_1': (0.0, 4.0)}, ['robot_0', 'robot_1'], [], {}

    def assign():
        while waiting and idle:
            pose = waiting[0].pose
            robot = min(idle, key=lambda one: math.hypot(at[one][0] - pose.x, at[one][1] - pose.y))
            idle.remove(robot)
            doing[robot], at[robot] = waiting.pop(0), (pose.x, pose.y)
            fleet.robot(robot).send(pose.x, pose.y, pose.yaw)

    def arrives(task):
        waiting.append(task)
        assign()

    def worked(robot, *_):
        idle.append(robot)
        assign()

    scenario = read_scenario(os.path.join(HERE, os.pardir, os.pardir, 'config', 'tasks_scenario.yaml'))
    fleet = Fleet(scenario, on_end=lambda robot, *_: fleet.robot(robot).send_task(doing[robot]), on_worked=worked)
    for task in scenario.tasks(seed):
        fleet.at(fleet.now_ns + task.arrival_ns, lambda _, task=task: arrives(task))
    fleet.run()
    return fleet.trace


def without_goal(kind, values):
    """Return an event's values without the goal's id, which the client chooses."""
    return list(values[1:] if kind in ('goal', 'ended') or kind.startswith(('task', 'waiting', 'works')) else values)


class LaunchTest(OwnPackage, unittest.TestCase):
    FILES = SCRIPTS
    COPIES = ('answerer.py', 'asker.py', 'fates.py', 'flags.py', 'leaves.py', 'ticks.py')

    def setUp(self):
        super().setUp()
        self.environment['ROSCONSOLE_STDOUT_LINE_BUFFERED'] = '1'

    def file(self, text):
        return self.write('system.launch', text)

    def command(self, *words):
        return [find_executable('lockstep_launch'), *words]

    def run_it(self, *words):
        return warm.run(self.command(*words), self.environment, timeout=GUARD)

    def log(self, name):
        return events_of(self.path(name))

    def test_a_whole_system_runs_as_its_launch_file_is_and_twice_the_same(self):
        logs, bags = [], []
        for name, options in (('a.jsonl', ()), ('b.jsonl', ('--speed-limit', '40'))):
            done = self.run_it('--log-messages', '--event-log', self.path(name), *options, SYSTEM,
                               'bag:=' + self.path(name), 'tasks:=12')
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertIn('9 of 9 nodes take part', done.stdout)
            log, events = self.log(name)
            logs.append(events)
            with open(self.path(name) + '.bag', 'rb') as stream:
                bags.append(hashlib.sha256(stream.read()).hexdigest())
            self.assertEqual([bag['sha256'] for bag in log.bags['/recorder']], bags[-1:])
            self.assertIn('lockstep_launch: bag of /recorder: {}.bag\n'.format(self.path(name)), done.stdout)
        self.assertEqual(*bags)
        self.assertEqual(log.end['not_repeatable_because'] + log.end['degraded_because'], [])
        self.assertIn("'/coordinator' left", log.end['reason'])  # only the required node
        self.assertGreater(len(logs[0]), 100)
        self.assertEqual(*logs)

    def test_the_coordinator_that_ships_does_all_tasks_as_in_plain_python_and_twice_the_same(self):
        logs = []
        for name in ('a.jsonl', 'b.jsonl'):
            done = self.run_it('--event-log', self.path(name), '--end-when-idle', 'move_base_abstract',
                               'coordinator.launch', 'seed:=5')
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertIn('3 of 3 nodes take part', done.stdout)
            self.assertEqual(done.stdout.count(': SUCCEEDED'), 20, done.stdout)
            log, events = self.log(name)
            logs.append(events)
        self.assertEqual(log.end['not_repeatable_because'] + log.end['degraded_because'], [])
        self.assertEqual(*logs)
        self.assertEqual(
            [(time_ns, robot, kind, without_goal(kind, json.loads(values)))
             for time_ns, robot, kind, values in logs[0]],
            [(entry.time_ns, entry.robot, entry.kind, without_goal(entry.kind, entry.values))
             for entry in nearest_idle(5)])

    def test_who_takes_part_and_why_others_do_not(self):
        done = self.run_it('--list', self.file(KINDS))
        self.assertEqual(done.returncode, 0, done.stdout)
        first, *others = done.stdout.splitlines()
        self.assertEqual(first.partition(': ')[2], '12 of 19 nodes take part: /one/relay, /one/move_base, /one/fleet, '
                         '/flags, /asker, /echo, /answerer_anonymous_1, /recorder, /near, /both, /wrapped, /records')
        for name, why in (('/player', 'only plays'), ('/starts_recorder', 'it is a shell script'),
                          ('/again', 'it is respawned'), ('/watched', "/gdb'"),
                          ('/elsewhere', "machine 'robot'"), ('/no_node', 'imports import rospy'),
                          ('/binary', 'it is a shell script')):
            line, = [line for line in others if line.startswith('lockstep_launch: {} looks on'.format(name))]
            self.assertIn(why, line)
        self.assertIn('lockstep_launch: /recorder records no /clock, /rosout, /rosout_agg, /time_master/...: they go '
                      'past lockstep', others)
        self.assertIn("lockstep_launch: the bag of '/starts_recorder' is not covered: it looks on: it is a shell",
                      done.stdout)

    def test_options_say_otherwise(self):
        done = self.run_it('--list', '--no-respawn', '--onlooker', 'flags', '--onlooker', 'recorder', '--leave-out',
                           '/one/relay', '--participant', '/no_node', '--participant', '/player', '--replace',
                           'rosbag/play=move_base_abstract/shim_listener', self.file(KINDS))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('/again', done.stdout.splitlines()[0])
        self.assertNotIn('/recorder', done.stdout.splitlines()[0])
        self.assertIn("the bag of '/recorder' is not covered: it looks on: as it was asked for", done.stdout)
        self.assertIn('/no_node', done.stdout.splitlines()[0])
        self.assertIn('/player', done.stdout.splitlines()[0])
        self.assertIn('/flags looks on', done.stdout)
        self.assertIn('/one/relay is not started', done.stdout)

    def test_what_cannot_be_run_is_refused_with_the_reason(self):
        simulator = '<launch><node pkg="stage_ros" type="stageros" name="stage"/></launch>'
        nobody = '<launch><node pkg="rosbag" type="play" name="player"/></launch>'
        for words, text in (((self.path('none.launch'),), 'none.launch'), ((), 'a launch file must be given'),
                            (('--until', '-1', SYSTEM), '--until: got -1.0; allowed: a number in 1e-9..2147483647 [s'),
                            (('--list', '--until', 'x', SYSTEM), "got 'x'"),
                            (('--onlooker', '/x', SYSTEM), 'no node of this'),
                            (('--replace', 'a/b=c', SYSTEM), "a/b: got 'c'; allowed: PACKAGE/TYPE, such as"),
                            (('--chaos-delay', '1', SYSTEM), "need a 'chaos_seed'"),
                            (('--param', '/time_master/event_log=3', SYSTEM), 'event_log: got 3; allowed: the path'),
                            (('--param', '/time_master/participants=[1]', SYSTEM), 'participants[0]: got 1; allowed'),
                            (('--network', 'nofile', SYSTEM), 'cannot be read: No such file or directory\n')):
            done = self.run_it(*words, 'bag:=x')
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(text, done.stdout)
        with open(self.path('ticks.py'), 'a') as stream:
            stream.write("\n\ndef as_a_simulator():\n    return rospy.Publisher('clock', Int32, queue_size=1)\n")
        for text, why in ((simulator, 'publishes /clock itself'), (TICKING.format(more=''), 'publishes /clock itself'),
                          (nobody, 'no node of this launch file can'),
                          ('<launch><node/></launch>', 'node'),
                          ('<launch>\n<group if="$(eval 1/0)"/></launch>',
                           '.launch, line 2: invalid <group> tag: ZeroDivisionError: division by zero\n'),
                          ('<launch>\n\n<param name="x" value="$(eval 1 +)"/></launch>',
                           '.launch, line 3: invalid <param>'),
                          ('<launch>\n<param name="x" value="$(eval __import__(1))"/></launch>',
                           '.launch, line 2: $(eval ...) may not contain double underscore expressions\n'),
                          ('<launch>\n<param name="x" value="$(env NO_SUCH)"/></launch>',
                           ".launch, line 2: environment variable 'NO_SUCH' is not set. If")):
            done = self.run_it(self.file(text))
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(why, done.stdout)

        for words, more in ((('--participant', '/walk'), ''), ((), '<remap from="/clock" to="/its_clock"/>')):
            text = TICKING.format(more='').replace('/>\n', '>{}</node>\n'.format(more), 1)
            done = self.run_it('--list', *words, self.file(text))
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertIn('1 of 1 nodes take part', done.stdout)

    def test_the_run_ends_at_the_instant_that_was_asked_for(self):
        log = self.path('a.jsonl')
        done = self.run_it('--until', '50', '--log-messages', '--event-log', log, self.file(TICKING.format(more='')))
        self.assertEqual(done.returncode, 0, done.stdout)
        with open(log) as stream:
            end = json.loads(stream.readlines()[-1])['end']
        self.assertEqual((end['reason'], end['repeatable']), ('the run was to end at 50 s', True))

    def test_shell_scripts_are_followed_to_the_python_program_that_they_become(self):
        done = self.run_it('--until', '6.2', '--log-messages', '--event-log', self.path('a.jsonl'), '--start-order',
                           'reversed', self.file(SHELL))
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn('3 of 3 nodes take part', done.stdout)
        self.assertEqual(re.findall("'(.*)' takes part", done.stdout), ['/robot/child', '/wrapped', '/both'])
        with open(self.path('a.jsonl')) as stream:
            _head, *lines, end = [json.loads(line) for line in stream]
        self.assertEqual(end['end']['not_repeatable_because'] + end['end']['degraded_because'], [])
        said = [(line['time_ns'], line['robot']) for line in lines if line['kind'] == 'message']
        self.assertEqual([at for at, topic in said if topic == '/both/said'], [2500000000, 4000000000, 5500000000])
        for topic in ('/ticks', '/robot/ticks'):
            self.assertEqual([at for at, its in said if its == topic], [second * 10 ** 9 for second in range(2, 7)])

    def test_what_a_run_leaves_in_its_temporary_folder_does_not_change_the_next_one(self):
        self.environment['TMPDIR'] = self.folder
        for name in ('a.jsonl', 'b.jsonl'):
            done = self.run_it('--log-messages', '--event-log', self.path(name), self.file(LEAVING))
            self.assertEqual(done.returncode, 0, done.stdout)
            left = re.search('files that the programs left in their temporary folder are in (.*)', done.stdout).group(1)
            file, = os.listdir(left)
            with open(os.path.join(left, file)) as stream:
                self.assertEqual(stream.read(), 'kept')
            self.assertEqual(self.log(name)[0].end['not_repeatable_because'], [], name)
        self.assertEqual(self.log('a.jsonl')[1], self.log('b.jsonl')[1])
        self.assertIn('/left', ' '.join(map(str, self.log('a.jsonl')[1])))

    def test_a_node_that_ends_before_it_takes_part_ends_the_run_and_is_named(self):
        for word, told in (('--help', 'code 0.*--onlooker /early'), ('--no', '2.*said last:\n.*\n    [^\n]*--no ')):
            early = '<node pkg="study_of_others" type="options.py" name="early" args="{}"/>'.format(word)
            done = self.run_it('--participant', '/early', self.file(TICKING.format(more=early)))
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertRegex(done.stdout, '(?s)lockstep_launch: /early ended .*' + told)

    def test_a_node_that_crashes_is_named_with_how_and_when(self):
        nodes = [FATE.format(name, 'required="true"' if name == 'last_round' else '') for name in (
            'callback', 'client', 'server', 'service', 'asks', 'timer', 'thread', 'daemon', 'jobs', 'asked', 'unsaved',
            'derived', 'items', 'taken', 'saves', 'odd', 'raises', 'exits', 'interrupts', 'vanishes', 'faults',
            'killed', 'last_round', 'looks_on', 'shut_down', 'ends', 'waits')]
        nodes.append(FATE.format('killed', 'launch-prefix="sh -c \'&quot;$@&quot;; exit 0\' sh"').replace(
            'name="killed"', 'name="within"'))
        nodes.append(FATE.format('faults', 'launch-prefix="sh -c \'&quot;$@&quot;; exit $?\' sh"').replace(
            'name="faults"', 'name="wrapped"'))
        done = self.run_it('--onlooker', '/looks_on', self.file(FATES.format('\n'.join(nodes))))
        said = dict(re.findall(r'^lockstep_launch: crash: (\S+) crashed ?(.*)$', done.stdout, re.MULTILINE))
        for name in sorted({*CRASHES, *said}):
            self.assertRegex(said.get(name, 'nothing'), '^{}$'.format(CRASHES.get(name, 'nothing')), done.stdout)
        self.assertEqual(done.returncode, 3, done.stdout)

    def test_a_crash_in_the_last_moment_counts_and_may_be_allowed(self):
        log = self.path('last.jsonl')
        for fate, words, code in (('raises', (), 3), ('raises', ('--crashes', 'allow'), 0), ('shut_down', (), 0),
                                  ('interrupts', (), 3)):
            done = self.run_it('--end-when-idle', '--event-log', log, *words, self.file(
                '<launch>' + FATE.format(fate, '') + '</launch>'))
            self.assertEqual((done.returncode, f'crash: /{fate} ' in done.stdout), (code, fate != 'shut_down'))
            self.assertTrue(events_of(log)[0].end['repeatable'], done.stdout)
            os.remove(log)

    def test_a_required_node_that_looks_on_and_fails_is_a_crash(self):  # roslaunch is the first to see that it is gone
        looks_on = self.file(TICKING.format(more=FATE.format('exits', 'required="true"')))
        for words, code in (((), 3), (('--crashes', 'allow'), 0)):
            done = self.run_it('--onlooker', '/exits', *words, looks_on)
            self.assertEqual((done.returncode, 'crash: /exits crashed' in done.stdout), (code, True), done.stdout)

    def test_a_required_node_is_named_as_by_roslaunch_and_the_others_did_not_die(self):
        more = FATE.format('ends', 'required="true"') + FATE.format('waits', '')
        done = self.run_it(self.file(TICKING.format(more=more)))
        self.assertRegex(done.stdout, r'REQUIRED process \[ends-\d+\] has died!\nprocess has finished cleanly\nlog')
        self.assertEqual(re.findall(r'\[(\w+)-\d+\] (?:process )?has died', done.stdout), ['ends'], done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_an_interrupt_ends_the_run_in_order(self):
        log = self.path('a.jsonl')
        words = ['--event-log', log, '--notes', self.folder, '--speed-limit', '10', self.file(TICKING.format(more=''))]
        process = subprocess.Popen(self.command(*words), env=self.environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.stdout.close)
        while not os.path.exists(self.path('start')) and process.poll() is None:
            time.sleep(0.2)  # after this it is somewhere in the run; the test does not depend on where
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read()
        self.assertEqual(process.wait(GUARD), 0, rest)
        with open(log) as stream, open(self.path('end')) as told:
            end, note = json.loads(stream.readlines()[-1])['end'], json.load(told)
        self.assertEqual({**note, **{key: end[key] for key in ('ended_by', 'at_ns')}}, note)
        self.assertEqual(sorted(note), ['at_ns', 'ended_by', 'leaps', 'messages', 'rounds'])
        self.assertIn('cut_ns', end)  # another run may be ended at another instant
        self.assertEqual(end['not_repeatable_because'] + end['degraded_because'], [])
        self.assertFalse(re.search('Traceback', rest), rest)
