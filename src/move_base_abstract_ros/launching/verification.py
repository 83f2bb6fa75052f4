"""Run one launch file under several conditions and look for the first difference."""
import contextlib
import os
import re
import signal
import subprocess
import sys
import time
from typing import NamedTuple

from move_base_abstract import event_log, run_difference
from move_base_abstract.event_log import EventLog, EventLogError
from move_base_abstract.own_files import OutputError

from ..loopback import find_executable
from .conditions import CONDITIONS, every_core_busy, limit_for

IDENTICAL, DIFFERENT, CANNOT, UNFINISHED, LABELLED = 0, 1, 2, 3, 4
_GRACE_S = 60.0  # wall, from the polite signal to SIGKILL: roslaunch ends its nodes meanwhile
_OUTPUT_LINES = 15
_MOST_CAUSES = 12
# What the launcher's warnings of sources that are not followed, and labels, have in them.
_SOURCES = re.compile(r'(reads the wall clock|sleeps in wall time|is seeded|seeded by|hash|address|does not take part'
                      r'|lockstep|not repeatable|random|wall|processor|comes when|run to run|another run)')
_IN_PLACE = re.compile(r'(\S+: )?(.* in \S+, line [0-9]+: .*)')
_COLOUR = re.compile('\x1b\\[[0-9;]*m')


class Run(NamedTuple):
    """One run that came to its end."""

    condition: object
    log: str  # path
    output: str  # path
    end: dict  # of the log
    wall: float  # s

    @property
    def labels(self):
        """Why the run is not called repeatable, or is called degraded."""
        return event_log.labels_of(self.end)


class Unfinished(Exception):
    """A run did not come to its end, or could not be started; ``code`` is the exit code of verify."""

    def __init__(self, text, code=UNFINISHED):
        super().__init__(text)
        self.code = code


class Verification:
    """Runs of one launch file, each in a folder of its own below ``folder``; ``say`` takes lines for people."""

    def __init__(self, words, folder, time_limit, say):
        """words: of lockstep_launch; time_limit: s, wall, of a run."""
        self._words = words
        self._folder = folder
        self._time_limit = time_limit
        self._say = say
        self.runs = []

    def verify(self, names):
        """Run under the conditions of these names, until two runs differ; return the exit code.

        :raises Unfinished, OutputError, EventLogError: if that cannot be said.
        """
        for condition in (condition for condition in CONDITIONS if condition.name in names):
            if condition.name == 'split' and self.runs and not _has_fleet(self.runs[0].output):
                continue
            run = self._run(condition)
            self.runs.append(run)
            self._tell(run)
            if len(self.runs) > 1 and not self._is_like_the_first(run):
                return DIFFERENT
        return self._conclude()

    def _run(self, condition):
        folder = os.path.join(self._folder, '{}_{}'.format(len(self.runs) + 1, condition.name))
        try:
            os.mkdir(folder)
        except OSError as error:
            raise OutputError('{}: cannot be made: {}'.format(folder, error.strerror)) from None
        log, output = os.path.join(folder, 'events.jsonl'), os.path.join(folder, 'output.txt')
        command = [find_executable('lockstep_launch'), '--event-log', log, '--log-messages', '--end-when-idle',
                   *condition.options]
        if condition.is_limited:
            simulated = _simulated(self.runs[0].log) if self.runs else 0.0
            command += ['--speed-limit', '{:.9g}'.format(limit_for(simulated))]
        environment = dict(os.environ, ROS_LOG_DIR=os.path.join(folder, 'ros_log'), PYTHONUNBUFFERED='1',
                           ROSCONSOLE_STDOUT_LINE_BUFFERED='1', **dict(condition.environment))
        begin = time.monotonic()
        with every_core_busy() if condition.is_busy else contextlib.nullcontext():
            code = self._wait(command + self._words, environment, output)
        wall = time.monotonic() - begin
        if code != 0:
            how = 'could not be started' if code == CANNOT else 'did not come to its end (exit code {})'.format(code)
            raise Unfinished("the run '{}' {}; its last lines:\n{}\nall of them: {}".format(
                condition.name, how, _last_lines(output), output), CANNOT if code == CANNOT else UNFINISHED)
        return Run(condition, log, output, _read_end(log), wall)

    def _wait(self, command, environment, output):
        with open(output, 'wb') as stream:
            process = subprocess.Popen([sys.executable, *command], env=environment, stdin=subprocess.DEVNULL,
                                       stdout=stream, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            return process.wait(self._time_limit)
        except subprocess.TimeoutExpired:
            raise Unfinished('a run was not over after {:g} s of wall time (--time-limit). An end can be given to it: '
                             '--until S, a node with required="true", or nothing left to do. Its last lines:\n{}'
                             .format(self._time_limit, _last_lines(output))) from None
        finally:
            _end(process)

    def _tell(self, run):
        found = run_difference.compare(run.log, run.log)
        simulated = _simulated(run.log)
        self._say('{}: {} events, {} messages, {:.3f} s simulated, the whole run in {:.1f} s of wall time; {}'.format(
            run.condition.name, found.events, found.messages, simulated, run.wall,
            'called repeatable' if not run.labels else 'labelled: ' + '; '.join(run.labels)))

    def _is_like_the_first(self, run):
        found = run_difference.compare(self.runs[0].log, run.log, run.condition.with_messages)
        if found.difference is None:
            return True
        for line in self._difference_lines(found.difference, run):
            self._say(line)
        return False

    def _difference_lines(self, difference, run):
        first = self.runs[0]
        yield 'different: {} ({}) and {} ({})'.format(first.condition.name, first.condition.what, run.condition.name,
                                                     run.condition.what)
        yield 'first difference: at {:.9f} s, event {} of this instant'.format(difference.time_ns * 1e-9,
                                                                               difference.place)
        for one, event in ((first, difference.first), (run, difference.second)):
            yield '  {}: {}'.format(one.condition.name, run_difference.told_lines(event) if event else
                                    'no more events; the run ended: {}'.format(one.end['reason']))
        for node, events in difference.told.items():
            yield 'what {} had been told before, in both runs:'.format(node)
            yield from ('  ' + run_difference.told_lines(event) for event in events)
        for one in (first, run):
            yield from ('label of {}: {}'.format(one.condition.name, label) for label in one.labels)
        yield 'likely causes:'
        for cause in self._causes(run, list(difference.told)):
            yield '  ' + cause

    def _causes(self, run, nodes):
        """Yield what is likely, the sources that the launcher has warned of first, those of the nodes before others."""
        found = sorted({line for one in (self.runs[0], run) for line in _sources(one.output)},
                       key=lambda line: (not any(node in line for node in nodes), line))
        yield from found[:_MOST_CAUSES]
        if run.condition.points_at:
            yield run.condition.points_at
        if not found:
            yield 'no source of chance or wall time was seen in the programs; not seen are files, sets of objects ' \
                  'and what libraries do'

    def _conclude(self):
        counts = run_difference.compare(self.runs[0].log, self.runs[0].log)
        labels = [label for run in self.runs for label in run.labels]
        self._say('identical: {} runs ({}), {} events and {} messages each'.format(
            len(self.runs), ', '.join(run.condition.name for run in self.runs), counts.events, counts.messages))
        for label in dict.fromkeys(labels):
            self._say('but not called repeatable: {}'.format(label))
        return LABELLED if labels else IDENTICAL


def _end(process):
    """End a run that is not over: politely, so that roslaunch ends its nodes; by SIGKILL if that does not help."""
    for number in (signal.SIGINT, signal.SIGKILL):
        if process.poll() is not None:
            return
        process.send_signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_GRACE_S)


def _read_end(path):
    with event_log.open_text(path) as stream:
        log = EventLog(stream, path)
        for _event in log:
            pass
    if log.end is None:
        raise EventLogError('{}: has no end record: the run did not end properly'.format(path))
    return log.end


def _simulated(path):
    """Return how much simulated time a run took, to its last event [s]."""
    with event_log.open_text(path) as stream:
        first = last = None
        for event in EventLog(stream, path):
            first, last = event.time_ns if first is None else first, event.time_ns
    return 0.0 if first is None else (last - first) * 1e-9


def _lines(path):
    with open(path, encoding='utf-8', errors='replace') as stream:
        for line in stream:
            yield _COLOUR.sub('', line).rstrip()


def _last_lines(path):
    return '\n'.join('    ' + line for line in list(_lines(path))[-_OUTPUT_LINES:]) or '    (it printed nothing)'


def _has_fleet(path):
    return any(line.startswith('lockstep_launch: fleets: ') for line in _lines(path))


def _sources(path):
    """Yield what the programs were warned of by the launcher, with file and line."""
    for line in _lines(path):
        found = _IN_PLACE.search(line)
        if found and _SOURCES.search(found.group(2)):
            yield re.sub(r'^\[[^]]*\](\s*\[[^]]*\])?:?\s*', '', found.group(0))
