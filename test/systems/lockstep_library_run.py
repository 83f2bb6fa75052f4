"""Runs of small Python nodes in lockstep, for the tests of the library; the event log has what each node logged.

    RUNS = Runs()                                     # one ROS master for all runs of a test file
    run = RUNS.run('times', 'sleeper', 'ticker')      # roles of lockstep_nodes/library_times.py, as nodes of that name
    run.events                                        # [(s, 'sleeper', 'kind', [values]), ...]
"""

import os
import shutil
import sys
from functools import cached_property

from in_lockstep import Logged
from scenarios import Condition
from waiting import read, wait_for_end
from warm import Loopback

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'lockstep_nodes')


class Run(Logged):
    """The results of a run."""

    def __init__(self, path, exit_codes, outputs):
        self.read_log(path)
        self.all = [(time_ns / 1e9, *event) for time_ns, *event in self.events]
        # those that the nodes logged themselves, without messages, arrivals and departures
        self.events = [event for event in self.all if event[1] in outputs]
        self.exit_codes = exit_codes
        self.outputs = outputs

    def of(self, robot):
        """Return [(s, kind, values...), ...] of one node."""
        return [(time_s, kind, *values) for time_s, name, kind, values in self.events if name == robot]


class Runs:
    """Runs one after the other under a ROS master of their own, which begins with the first of them."""

    def __init__(self):
        self._count = 0

    @cached_property
    def ros(self):
        """The ROS master and its processes."""
        return Loopback().__enter__()

    def close(self):
        """End them; conftest.py does it after the last test of the file."""
        if 'ros' in vars(self):
            self.ros.close()

    def start_master(self, participants, **parameters):
        """Start a time master that waits for these participants; return (child, path of the event log)."""
        self._count += 1
        path = os.path.join(self.ros.log_dir, f'run_{self._count}.jsonl')
        return self.ros.run('time_master', 'time_master', parameters={
            'mode': 'lockstep', 'participants': [f'/{name}' for name in participants], 'event_log': path,
            'log_messages': False, **parameters}), path

    def start_node(self, module, role, adverse=0.0):
        """Start a node that plays a role; adverse: the longest random delay in its calls [s, wall]."""
        command = [sys.executable, os.path.join(FOLDER, f'library_{module}.py'), role, str(adverse), f'__name:={role}']
        return self.ros.spawn(f'/{role}', command)

    def run(self, module, *roles, outsiders=(), adverse=0.0, parameters=None, log_messages=False, onlook='',
            condition=Condition(), **settings):
        """Run until all nodes have ended by themselves; outsiders do not take part, and are ended.

        onlook: a topic to which an onlooker listens; condition: what else happens meanwhile;
        settings: parameters of the time master.
        """
        self.ros.is_warm = condition.is_warm
        for name, value in (parameters or {}).items():
            self.ros.set_param(name, value)
        master, path = self.start_master(roles, log_messages=log_messages, **condition.clock, **settings)
        others = [self.start_node(module, role) for role in outsiders]
        nodes = {role: self.start_node(module, role, adverse) for role in roles}
        onlooker = look_on(self.ros, onlook) if onlook else None
        try:
            with condition.around():
                for node in nodes.values():
                    wait_for_end(node, nodes)
            if onlooker is not None:
                assert_heard(onlooker)
        finally:
            outputs, codes = {}, {}
            for role, node in nodes.items():
                codes[role] = node.process.poll()
                self.ros.end(node)
                outputs[role] = read(node)
            for child in [*others, master]:
                self.ros.end(child)
        return Run(path, codes, outputs)


def look_on(ros, topic):
    """Start an onlooker that listens for one message on a topic; return it."""
    return ros.spawn('/onlooker', [shutil.which('rostopic'), 'echo', '-n', '1', topic])


def assert_heard(onlooker):
    """Wait for the end of an onlooker, and assert that it has heard its message."""
    wait_for_end(onlooker)
    assert '---' in read(onlooker), read(onlooker)
