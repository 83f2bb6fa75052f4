"""Runs of unmodified programs in lockstep, for the tests of the launcher.

    run = run_programs({'poller': ['poller.py', '--count', '3']}, until=30.0, fleet=[{'name': 'robot_0'}])
    run.log                                      # bytes of the event log, with all messages
    run.printed('poller')                        # lines that the program printed, without ROS's log

A program is a list of words, as they would follow `rosrun move_base_abstract lockstep`; the first one may be a list of
options of the launcher. A script without a folder is in unmodified/. A run ends at `until` [s, simulated], or when no
participant has anything left to do. Each run has a ROS master of its own, since a ROS master remembers too much.
"""

import json
import os
import re
import signal
import sys
import threading
import time
from types import SimpleNamespace

import in_lockstep
from in_lockstep import printed
from scenarios import Condition, repeated
from waiting import GUARD, read
from warm import Loopback

from move_base_abstract_ros.loopback import find_executable

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.join(HERE, 'unmodified')
_COLOURS = re.compile(r'\x1b\[[0-9;]*m')


class Run:
    """The results of a run."""

    def __init__(self, log, outputs, codes, state):
        self.log = log
        self.outputs = outputs
        self.codes = codes  # exit code; None for a program that had to be killed
        self.state = state  # the last state of the time master

    def printed(self, name):
        """Return the lines that a program printed, without ROS's log, which has wall times."""
        return printed(self.outputs[name])

    def logged(self, name, level):
        """Return ROS's log lines of a level, such as WARN."""
        lines = [_COLOURS.sub('', line) for line in self.outputs[name].splitlines()]
        return [line for line in lines if line.startswith('[{}]'.format(level))]


def run_programs(programs, until, fleet=(), parameters=None, clock=None, condition=Condition(), commands=None,
                 onlookers=(), others=None, ahead=0.0):
    """Run programs {name: words} in lockstep, and robots.

    parameters: {name: value} of ROS; clock: parameters of the time master; condition: what else happens meanwhile;
    commands: whole command lines of programs that are started in another way; onlookers: topics of texts to which an
    onlooker listens; others: {name: (command line, s)} of programs that take no part, and are stopped at their start
    for this long [s, wall];
    ahead: time by which programs start before the time master [s, wall].
    """
    with Loopback(is_warm=condition.is_warm) as ros:
        for name, value in (parameters or {}).items():
            ros.set_param(name, value)
        log = os.path.join(ros.log_dir, 'run.jsonl')
        names = ['/' + name for name in programs] + (['/fleet'] if fleet else [])
        children = _spawn_ahead(ros, ahead, programs, commands)
        master = ros.run('time_master', 'time_master', parameters=dict(
            {'mode': 'lockstep', 'participants': names, 'event_log': log, 'log_messages': True, 'start_paused': True,
             'state_rate': 50.0}, **condition.clock, **(clock or {})))
        with condition.around():
            for name, (words, pause) in (others or {}).items():
                _stop_for(pause, ros.spawn(name, [*words, *remaps(name.strip('/'))]))
            for topic in onlookers:
                ros.spawn('/onlooker', [sys.executable, os.path.join(HERE, 'onlooker.py'), topic])
            if fleet:
                children['fleet'] = ros.run('fleet', 'fleet', parameters={
                    'defaults': {'max_speed': 1.0}, 'robots': [dict(robot) for robot in fleet]})
            if not ahead:
                children.update(_spawn(ros, programs, commands))
            state = _wait(ros, until)
        ros.end(master)
        outputs, codes = _end(ros, children)
        if not state.is_over:
            raise AssertionError('the run has not ended within {} s: {}\n{}'.format(
                GUARD, state, '\n'.join('{}: ...{}'.format(name, text[-500:]) for name, text in outputs.items())))
        with open(log, 'rb') as stream:
            return Run(stream.read(), outputs, codes, state)


def _spawn(ros, programs, commands):
    return {name: ros.spawn('/' + name, (commands or {}).get(name) or command(words, name))
            for name, words in programs.items()}


def _spawn_ahead(ros, ahead, programs, commands):
    """Start the programs and wait for ``ahead`` [s, wall]; return them. With 0, start nothing."""
    if not ahead:
        return {}
    ros.set_param('/time_master/mode', 'lockstep')
    children = _spawn(ros, programs, commands)
    time.sleep(ahead)
    return children


def _stop_for(pause, child):
    """Stop a process at once, and let it go on after ``pause`` [s, wall]."""
    if pause:
        child.signal(signal.SIGSTOP)
        threading.Timer(pause, child.signal, [signal.SIGCONT]).start()


def _wait(ros, until):
    """Let the run go on to its end; return the time master's state then."""
    child = ros.spawn('/launcher_clock', [
        sys.executable, os.path.join(HERE, 'lockstep_launcher_clock.py'), str(until), str(GUARD)])
    child.process.wait(2.0 * GUARD)
    text = read(child)
    try:
        return SimpleNamespace(**json.loads(text.splitlines()[-1]))
    except (IndexError, ValueError):
        raise AssertionError('the time master has not told its state: {}'.format(text)) from None


def _end(ros, children):
    """End processes that do not end after the time master; return ({name: output}, {name: exit code})."""
    deadline = time.monotonic() + 10.0  # wall; a busy machine needs long to end a process
    while time.monotonic() < deadline and any(child.process.poll() is None for child in children.values()):
        time.sleep(0.02)
    outputs, codes = {}, {}
    for name, child in children.items():
        codes[name] = child.process.poll()
        ros.end(child)
        outputs[name] = read(child)
    return outputs, codes


def run_scenario(programs, until, before=None, name='', **kwds):
    """Run programs as a scenario, and return the runs; see run_programs. before() is called before each run."""
    def run(condition):
        if before is not None:
            before()
        return run_programs(programs, until, condition=condition, **kwds)
    shown = '; '.join(' '.join(os.path.basename(str(word)) for word in words) for words in programs.values())
    return repeated(name or shown, run, lambda one: one.log)


class Scenario:
    """A mix-in for a TestCase: its programs run as a scenario, once for all of its tests; see run_scenario."""

    programs, until, settings = {}, 0.0, {}
    labelled = ()  # see assert_same

    @classmethod
    def setUpClass(cls):
        """Run the scenario."""
        cls.runs = run_scenario(cls.programs, cls.until, **cls.settings)

    def printed(self, name):
        """Return the lines that a program printed in the first run."""
        return self.runs[0].printed(name)

    def test_all_runs_are_the_same(self):
        assert_same(self, self.runs, self.labelled)


def command(words, name):
    """Return the command line that runs a program under the launcher."""
    options, words = (words[0], words[1:]) if isinstance(words[0], list) else ([], words)
    if words[0].endswith('.py') and '/' not in words[0]:
        words = [os.path.join(FOLDER, words[0])] + words[1:]
    return [sys.executable, find_executable('lockstep'), *options, *words, *remaps(name)]


def remaps(name):
    """Return the words that give a node its name and namespace."""
    namespace, _, base = name.rpartition('/')
    return ['__name:=' + base] + (['__ns:=/' + namespace] if namespace else [])


def assert_same(case, runs, labelled=()):
    """Assert that all runs have the same event log, to the byte, and the same output, and no unexpected labels.

    labelled: parts of the expected labels, in order.
    """
    first = runs[0]
    for run in runs:
        in_lockstep.assert_same(case, first.log.split(b'\n'), run.log.split(b'\n'), 'line of the event log')
        for name in first.outputs:
            case.assertEqual(first.printed(name), run.printed(name), name)
        labels = list(run.state.not_repeatable_because) + list(run.state.degraded_because)
        case.assertEqual(len(labels), len(labelled), labels)
        for label, text in zip(labels, labelled):
            case.assertIn(text, label)
