"""A run in lockstep of nodes that a test starts one by one, on a ROS master of its own; then its event log.

    with InLockstep(['/fleet', '/client'], log_messages=True) as run:
        run.ros.run('fleet', 'fleet', parameters={...})
        said, = run.end_of(run.ros.spawn('/client', [...]))
    run.events
"""
import json
import os
import re

from scenarios import Condition
from waiting import read, wait_for_end
from warm import Loopback

_ROS_LOG = re.compile(r'^(\x1b\[[0-9;]*m)?\[ ?(DEBUG|INFO|WARN|ERROR|FATAL)\]')


class Logged:
    """What a whole event log says: its ``text``, ``head``, ``events`` [(ns, robot, kind, values), ...], and ``end``."""

    def read_log(self, path):
        """Read it."""
        with open(path, encoding='utf-8') as log:
            self.text = log.read()
        self.head, *records, end = map(json.loads, self.text.splitlines())
        self.end = end['end']
        self.events = [(record['time_ns'], record['robot'], record['kind'], record['values']) for record in records]


class InLockstep(Logged):
    """A run: ``ros`` is its Loopback. After it there is all that Logged has."""

    def __init__(self, participants, condition=Condition(), **clock):
        """Prepare a run of these nodes; condition: how it starts; clock: parameters of the time master."""
        self.ros = Loopback(is_warm=condition.is_warm)
        self._clock = {'mode': 'lockstep', 'participants': list(participants), **condition.clock, **clock}

    def __enter__(self):
        self.ros.__enter__()
        self.log = os.path.join(self.ros.log_dir, 'events.jsonl')
        self._master = self.ros.run('time_master', 'time_master', parameters={**self._clock, 'event_log': self.log})
        return self

    def end_of(self, *children):
        """Wait until processes have ended, each with exit code 0; return what each has printed, without ROS's log."""
        for child in children:
            code = wait_for_end(child)
            if code:
                raise AssertionError('{} ended with {}:\n{}'.format(child.name, code, child.last_lines()))
            self.ros.end(child)
        return ['\n'.join(printed(read(child))) for child in children]

    def __exit__(self, kind, error, trace):
        try:
            if kind is None and 'end_at' in self._clock:
                wait_for_end(self._master)
            elif kind is None:
                self.ros.check()
                self.ros.end(self._master)
        finally:
            self.ros.close()
        if kind is None:
            self.read_log(self.log)


def printed(text):
    """Return the lines of a node's output, without ROS's log, which has wall times."""
    return [line for line in text.splitlines() if line.strip() and not _ROS_LOG.match(line) and line != '\x1b[0m']


def assert_same(case, first, other, what='row'):
    """Assert that two sequences are equal. A failure shows the first row that differs, and its number."""
    for number, (row, its) in enumerate(zip(first, other), 1):
        case.assertEqual(row, its, '{} {}'.format(what, number))
    case.assertEqual(len(first), len(other))
