"""Runs of unmodified programs in lockstep, for the tests of the launcher.

    PROGRAMS = Programs()                        # one ROS master for all runs of a test file
    run = PROGRAMS.run({'poller': ['poller.py', '--count', '3']}, until=30.0, fleet=['robot_0'])
    run.log                                      # bytes of the event log, all messages included
    run.printed('poller')                        # lines that the program printed, without ROS's log

A program is a list of words, as they would follow `rosrun move_base_abstract lockstep` (options of the launcher: a list
in the first place); a script without a folder is one of unmodified/. A run ends at `until` [s, simulated], whatever the
programs do then, or when nobody has anything left to do.
"""

import os
import re
import subprocess
import sys
import time
from contextlib import contextmanager

import rospy

from move_base_abstract.msg import TimeState
from move_base_abstract_ros.loopback import Loopback, find_executable
from move_base_abstract_ros.time_master_client import TimeMasterClient

GUARD = 60.0  # s, wall; only ends a run that would never end
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'unmodified')
_ROS_LOG = re.compile(r'^(\x1b\[[0-9;]*m)?\[(DEBUG|INFO|WARN|ERROR|FATAL)\]')
_COLOURS = re.compile(r'\x1b\[[0-9;]*m')
_OVER = ('paused', 'idle', 'deadlock', 'zero_delay_loop', 'ended')


class Run:
    """What came out of a run."""

    def __init__(self, log, outputs, codes, state):
        self.log = log
        self.outputs = outputs
        self.codes = codes  # exit code, or None of a program that was still there at the end
        self.state = state  # the time master's last word

    def printed(self, name):
        """Return the lines that a program printed, without ROS's log, in which wall times are."""
        return [line for line in self.outputs[name].splitlines() if line.strip() and not _ROS_LOG.match(line)
                and line not in ('\x1b[0m',)]

    def logged(self, name, level):
        """Return ROS's log lines of a level."""
        lines = [_COLOURS.sub('', line) for line in self.outputs[name].splitlines()]
        return [line for line in lines if line.startswith('[{}]'.format(level))]


class Programs:
    """Runs one after the other under a ROS master of their own."""

    def __init__(self):
        self.ros = Loopback()
        self.ros.__enter__()
        self.ros.adopt()
        rospy.init_node('launcher_test', disable_rostime=True, disable_signals=True)
        self._count = 0

    def close(self):
        rospy.signal_shutdown('the tests are over')
        self.ros.close()

    def run(self, programs, until, fleet=(), parameters=None, clock=None, load=0, commands=None, wall_limit=None):
        """Run programs {name: words} in lockstep, and robots; clock: parameters of the time master.

        commands: whole command lines of programs that are started in another way; wall_limit [s]: the run is over then.
        """
        self.forget_clock()
        for name, value in (parameters or {}).items():
            self.ros.set_param(name, value)
        self._count += 1
        path = os.path.join(self.ros.log_dir, 'run_{}.jsonl'.format(self._count))
        names = ['/' + name for name in programs] + (['/fleet'] if fleet else [])
        master = self.ros.run('time_master', 'time_master', parameters=dict(
            {'mode': 'lockstep', 'participants': names, 'event_log': path, 'log_messages': True, 'start_paused': True,
             'speed_limit': 0.0, 'state_rate': 50.0}, **(clock or {})))
        children = {}
        try:
            with busy(load):
                state = self._run(programs, fleet, children, until, commands or {}, wall_limit)
        finally:
            self.ros.end(master)
            outputs, codes = self._end(children)
        with open(path, 'rb') as stream:
            log = stream.read()
        return Run(log, outputs, codes, state)

    @staticmethod
    def forget_clock():
        """Remove the parameters of the last run's time master."""
        if rospy.has_param('/time_master'):
            rospy.delete_param('/time_master')

    def _run(self, programs, fleet, children, until, commands, wall_limit):
        """Start everything and wait for the end; return the time master's state then."""
        if fleet:
            children['fleet'] = self.ros.run('fleet', 'fleet', parameters={
                'defaults': {'max_speed': 1.0}, 'robots': [dict(robot) for robot in fleet]})
        for name, words in programs.items():
            children[name] = self.ros.spawn('/' + name, commands.get(name) or command(words, name))
        TimeMasterClient().run_until(until)
        began = time.monotonic()
        while True:
            state = rospy.wait_for_message('/time_master/state', TimeState, timeout=GUARD)
            took = time.monotonic() - began
            if state.phase in _OVER and not (state.phase == 'paused' and state.sim_time.to_sec() < until) or (
                    wall_limit is not None and took > wall_limit):
                return state
            if took > GUARD:
                outputs, _ = self._end(children)
                children.clear()
                raise AssertionError('the run has not ended within {} s; it is {} at {} s:\n{}\n{}'.format(
                    GUARD, state.phase, state.sim_time.to_sec(), state, outputs))
            time.sleep(0.02)

    def _end(self, children):
        """End what has not ended by itself; give what ended in simulated time the wall time to do so."""
        deadline = time.monotonic() + 3.0
        while time.monotonic() < deadline and any(child.process.poll() is None for child in children.values()):
            time.sleep(0.02)
        outputs, codes = {}, {}
        for name, child in children.items():
            codes[name] = child.process.poll()
            self.ros.end(child)
            with open(child.log_path, errors='replace') as log:
                outputs[name] = log.read()
        return outputs, codes

    def same(self, *args, **kwds):
        """Run twice under load at full speed and once limited to 50 times real time; return the runs."""
        return [self.run(*args, load=os.cpu_count(), **kwds), self.run(*args, load=1, **kwds),
                self.run(*args, clock={'speed_limit': 50.0}, **kwds)]


def command(words, name):
    """Return the command line that runs a program under the launcher."""
    options, words = split(words)
    if words[0].endswith('.py') and '/' not in words[0]:
        words = [os.path.join(FOLDER, words[0])] + words[1:]
    return [sys.executable, find_executable('lockstep'), *options, *words, *remaps(name)]


def remaps(name):
    """Return the words that give a node its name and namespace."""
    namespace, _, base = name.rpartition('/')
    return ['__name:=' + base] + (['__ns:=/' + namespace] if namespace else [])


def split(words):
    """Return the launcher's options (a list in the first place) and the rest."""
    return (words[0], words[1:]) if isinstance(words[0], list) else ([], words)


@contextmanager
def busy(count):
    """Keep ``count`` cores busy meanwhile."""
    processes = [subprocess.Popen([sys.executable, '-c', 'while True: pass']) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def assert_same(case, runs):
    """All runs have one event log, to the byte, and their programs print the same."""
    first = runs[0]
    for other in runs[1:]:
        for number, (line, its) in enumerate(zip(first.log.split(b'\n'), other.log.split(b'\n')), 1):
            case.assertEqual(line, its, 'line {} of the event log'.format(number))
        case.assertEqual(first.log, other.log)
        for name in first.outputs:
            case.assertEqual(first.printed(name), other.printed(name), name)
