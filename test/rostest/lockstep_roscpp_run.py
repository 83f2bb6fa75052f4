"""Runs of unmodified roscpp binaries in lockstep, for the tests of the shim: the event log has every message.

    RUNS = Runs()
    run = RUNS.run([Program('rate', own('shim_rate'), frequency=7.0), Program('relay', RELAY, '/ticks', '/relayed')])
    run.texts('/ticks')                               # what std_msgs/String messages said, in order
"""

import json
import os
import signal
import subprocess
import sys
import time

import rosgraph

from move_base_abstract_ros.loopback import Loopback, find_executable

GUARD = 40.0  # s, wall
#: keeps both cores busy
LOAD = 'while True:\n    sum(range(1000))\n'


def own(name):
    """Return the path of a node of test/cpp_nodes."""
    return find_executable(name)


class Program:
    """A binary, its node name, its arguments and its private parameters."""

    def __init__(self, name, path, *arguments, options=(), remaps=(), **parameters):
        self.name = name
        self.path = path
        self.arguments = list(arguments)
        self.options = list(options)  # of the launcher
        self.remaps = list(remaps)
        self.parameters = parameters


class Run:
    """What came out of a run: the event log up to the moment when the first program had ended."""

    def __init__(self, path, code, outputs):
        with open(path, encoding='utf-8') as log:
            records = [json.loads(line) for line in log]
        self.end = records[-1]
        self.code = code
        self.outputs = outputs
        self.events = [(record['time_ns'], record['robot'], record['kind'], record['values'])
                       for record in records[1:-1]]

    def until(self, seconds):
        """Return the events before a simulated time."""
        return [event for event in self.events if event[0] < seconds * 1e9]

    @property
    def labels(self):
        return self.end.get('not_repeatable', [])


class Runs:
    """Runs one after the other, each under a ROS master of its own."""

    def __init__(self):
        self.ros = None
        self.count = 0

    def run(self, programs, load=False, **parameters):
        """Run until the first program has ended by itself; the others are ended then."""
        with Loopback() as self.ros:
            path = os.path.join(self.ros.log_dir, 'events.jsonl')
            master = self.ros.run('time_master', 'time_master', parameters={
                'mode': 'lockstep', 'participants': [f'/{program.name}' for program in programs], 'event_log': path,
                'log_messages': True, **parameters})
            burners = [subprocess.Popen([sys.executable, '-c', LOAD]) for _ in range(2 if load else 0)]
            try:
                children = [self.start(program) for program in programs]
                code = wait_for_end(children)
                self.values = rosgraph.Master('/run', master_uri=self.ros.uri).getParam('/' + programs[0].name)
            finally:
                for burner in burners:
                    burner.kill()
                    burner.wait()
            for child in children:
                child.signal(signal.SIGINT)  # as Ctrl-C and roslaunch do; roscpp knows no SIGTERM
            for child in [*children, master]:
                child.process.wait(GUARD) if child is not master else None
                self.ros.end(child)
            return Run(path, code, [read(child) for child in children])

    def start(self, program):
        for key, value in program.parameters.items():
            self.ros.set_param(f'/{program.name}/{key}', value)
        return self.ros.spawn('/' + program.name, [
            find_executable('lockstep'), *program.options, program.path, *program.arguments, *program.remaps,
            f'__name:={program.name}'])


def wait_for_end(children):
    deadline = time.monotonic() + GUARD
    while children[0].process.poll() is None:
        if time.monotonic() > deadline:
            told = '\n'.join(f'{child.name}:\n{read(child)}' for child in children)
            raise AssertionError(f'{children[0].name} has not ended within {GUARD} s. What the nodes printed:\n{told}')
        time.sleep(0.01)
    return children[0].process.returncode


def read(child):
    """Return what a node has printed."""
    with open(child.log_path, errors='replace') as log:
        return log.read()
