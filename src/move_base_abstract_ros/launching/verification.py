"""Run one launch file under several conditions and look for the first difference."""
import contextlib
import os
import shutil
import time
from typing import NamedTuple

from move_base_abstract.common.own_files import OutputError
from move_base_abstract.common.shown import pasted
from move_base_abstract.runs import ends, event_log, run_difference
from move_base_abstract.runs.calls import DeathError, call
from move_base_abstract.runs.event_log import EventLogError

from . import difference_report
from .conditions import CONDITIONS, busy, limit_for

IDENTICAL, DIFFERENT, CANNOT, UNFINISHED, LABELLED, CRASHED, BROKEN = 0, 1, 2, 3, 4, 5, 6
_BROKEN = 4  # exit code of lockstep_launch: the run has come to its end
_OUTPUT_LINES = 15
_MOST_BAG_BYTES = 1 << 30  # of the first run's bags, which are kept to be compared with others message by message


class Run(NamedTuple):
    """One run that came to its end."""

    condition: object
    log: str  # path
    output: str  # path
    end: dict  # of the log
    simulated: float  # s
    events: int  # without messages
    messages: int
    wall: float  # s
    message_bytes: str  # path of a file with the messages between participants
    bags: dict  # {(node, number of its bag from 1 on): path}
    crashes: list  # the crashes of its nodes, in words; the user allows them
    fleets: list  # [name, why it cannot be split into several processes, or ''] of each fleet
    broken: list  # the properties that it breaks, in words

    @property
    def labels(self):
        """The reasons why the run is not called repeatable, or is called degraded."""
        return event_log.labels_of(self.end)


class Unfinished(Exception):
    """A run did not come to its end, or could not be started; ``code`` is the exit code of verify."""

    def __init__(self, text, code=UNFINISHED):
        super().__init__(text)
        self.code = code


class Verification:
    """Runs of one launch file, each in a folder of its own below ``folder``. ``say(line)`` prints a line."""

    def __init__(self, start, words, next_steps, folder, time_limit, say):
        """start(words): runs lockstep_launch with these words in this process, and returns what is in Launched.

        words: for lockstep_launch; time_limit: of each run [s, wall]. next_steps: what to type next,
        {LABELLED: command, IDENTICAL: command}, each with words that say what for.
        """
        self._start, self._words = start, words
        self._next_steps = next_steps
        self._folder = folder
        self._time_limit = time_limit
        self._say = say
        self.runs = []

    def verify(self, names):
        """Run under the conditions of these names until a run differs from the first; return the exit code.

        :raises Unfinished: if a run does not come to its end; OutputError: if a folder cannot be made;
            EventLogError: if an event log cannot be read.
        """
        for condition in (condition for condition in CONDITIONS if condition.name in names):
            if condition.name == 'split' and self.runs and not self._can_split():
                continue
            run = self._run(condition)
            self.runs.append(run)
            self._tell(run)
            if len(self.runs) == 1:
                self.runs[0] = run._replace(bags=_keep(run))
            elif not self._is_like_the_first(run):
                return DIFFERENT
            else:
                _remove(run)
        return self._conclude()

    def _can_split(self):
        """Return whether the first run's fleets can run in two processes each and be compared with it; say why not."""
        first = self.runs[0]
        names = [name for name, _why in first.fleets]
        crashed = [crash for crash in first.crashes if crash.partition(' ')[0] in names]
        why = ['in two processes a fleet has other names, and ' + crash for crash in crashed[:1]] or [
            '{}: {}'.format(name, why) for name, why in first.fleets if why]
        if why:
            self._say('split: not run: ' + why[0])
        return bool(names) and not why

    def _run(self, condition):
        folder = os.path.join(self._folder, '{}_{}'.format(len(self.runs) + 1, condition.name))
        try:
            os.mkdir(folder)
        except OSError as error:
            raise OutputError('{}: cannot be made: {}'.format(folder, error.strerror)) from None
        log, output = os.path.join(folder, 'events.jsonl'), os.path.join(folder, 'output.txt')
        message_bytes = os.path.join(folder, 'messages.bin')
        words = ['--event-log', log, '--log-messages', '--message-bytes', message_bytes, '--end-when-idle',
                 '--no-displays', *condition.options]
        if condition.is_limited:
            simulated = self.runs[0].simulated if self.runs else 0.0
            words += ['--speed-limit', '{:.9g}'.format(limit_for(simulated))]
        environment = {'ROS_LOG_DIR': os.path.join(folder, 'ros_log'), 'PYTHONUNBUFFERED': '1',
                       'ROSCONSOLE_STDOUT_LINE_BUFFERED': '1', **dict(condition.environment)}
        begin = time.monotonic()
        with busy() if condition.is_busy else contextlib.nullcontext():
            code, bags, crashes, fleets, broken = self._launched(words + self._words, environment, output)
        wall = time.monotonic() - begin
        if code != 0 and crashes:
            raise Unfinished("nodes crashed in the run '{}', so that it is not compared; --crashes allow "
                             'compares such runs, too:\n{}\nall output of the nodes: {}'.format(
                                 condition.name, '\n'.join('    ' + one for one in crashes), output), CRASHED)
        if code not in (0, _BROKEN):
            how = 'could not be started' if code == CANNOT else 'did not come to its end ({})'.format(
                ends.described(code))
            raise Unfinished("the run '{}' {}; its last lines:\n{}\nall of them: {}".format(
                condition.name, how, _last_lines(output), output), CANNOT if code == CANNOT else UNFINISHED)
        return Run(condition, log, output, *_read_end(log), wall, message_bytes, _by_number(bags), crashes, fleets,
                   broken)

    def _launched(self, words, environment, output):
        """Run lockstep_launch in a fork; return (its exit code, [[node, path of a bag]], crashes, fleets, broken)."""
        def work():
            os.environ.update(environment)
            launched = self._start(words)
            return (launched.code, [[bag.node, bag.path] for bag in launched.bags], launched.crashes, launched.fleets,
                    [one.words() for one in launched.judged.broken])
        try:
            return call(work, self._time_limit, output)
        except DeathError as error:
            if not error.is_late:
                return error.code or UNFINISHED, [], [], [], []
            raise Unfinished('a run was not over after {:g} s of wall time (--time-limit). It needs an end: '
                             '--until S, a node with required="true", or nothing left to do. Its last lines:\n{}'
                             .format(self._time_limit, _last_lines(output))) from None

    def _tell(self, run):
        self._say('{}: {} events, {} messages, {:.3f} s simulated, the whole run in {:.1f} s of wall time; {}'.format(
            run.condition.name, run.events, run.messages, run.simulated, run.wall,
            'called repeatable' if not run.labels else 'labelled'))
        for line in (*run.crashes, *('broken: ' + one for one in run.broken)):
            self._say('  {}'.format(line))

    def _is_like_the_first(self, run):
        first = self.runs[0]
        found = run_difference.compare(first.log, run.log, run.condition.with_messages)
        if found.identical and sorted(run.crashes) == sorted(first.crashes):
            return True
        if found.identical:
            self._say('different: nodes of {} and of {} crash in different ways, after equal events'.format(
                first.condition.name, run.condition.name))
            self._say_next('the output of the nodes: less {}', run.output)
            return False
        self._say('different: {} ({}) and {} ({})'.format(first.condition.name, first.condition.what,
                                                          run.condition.name, run.condition.what))
        tell = difference_report.bag_lines if found.difference is None else difference_report.event_lines
        for line in tell(found.difference or found.bags, first, run):
            self._say(line)
        self._say('likely causes:')
        for line in difference_report.cause_lines(found.difference, first, run):
            self._say('  ' + line)
        self._say_next('both runs side by side: rosrun move_base_abstract replay {} {}', first.log, run.log)
        for one in (first, run):
            _remove(one)
        return False

    def _conclude(self):
        first, names = self.runs[0], ', '.join(run.condition.name for run in self.runs)
        is_compared = len(self.runs) > 1
        self._say('identical: {} runs ({}), {}'.format(len(self.runs), names, self._told_of_equal(first))
                  if is_compared else 'nothing is compared: only one run was made ({})'.format(names))
        self._say('not compared: other files that nodes write, and what they print')
        for crash in first.crashes:
            self._say('but {} (--crashes allow)'.format(crash))
        labels = ['but not called repeatable: {}'.format(label) for label in difference_report.label_lines(self.runs)]
        if not is_compared:
            labels.append('but one run has no other to be compared with: more --conditions make more runs')
        has_messages = len(self._with_messages()) > 1 and (first.messages or first.bags)
        if is_compared and not (first.events or has_messages):
            labels.append('but there was nothing to compare: no robot did anything, and ' + (
                'messages are not compared' if first.messages else
                'no message went from one participant to another'))
        for line in (*labels, *('but broken: ' + one for one in first.broken)):
            self._say(line)
        if labels:
            self._say('if a label names a program and a place in it, change the program there')
        self._say('next: ' + self._next_steps[LABELLED if labels else IDENTICAL])
        _remove(first)
        return LABELLED if labels else BROKEN if first.broken else IDENTICAL

    def _say_next(self, text, *words):
        """Print what the user can type next. ``words`` fill the places in ``text``."""
        self._say('next: ' + text.format(*map(pasted, words)))

    def _with_messages(self):
        return [run.condition.name for run in self.runs if run.condition.with_messages]

    def _told_of_equal(self, first):
        """Return in words what is equal in all runs, and of which runs only the events were compared."""
        names = self._with_messages()
        without = [run.condition.name for run in self.runs if run.condition.name not in names]
        if len(names) < 2:
            return '{} events each; messages and bags are not compared'.format(first.events)
        number = len(first.bags)
        bags = ', and the same bytes in {} bag{}'.format(number, 's' * (number > 1)) if number else ''
        return '{} events and {} messages each{}{}'.format(
            first.events, first.messages, bags, '; of {} only the events'.format(', '.join(without)) * bool(without))


def _by_number(bags):
    """Return {(node, number of its bag from 1 on): path} for the pairs [node, path]."""
    counts, found = {}, {}
    for node, path in bags:
        counts[node] = counts.get(node, 0) + 1
        found[node, counts[node]] = path
    return found


def _keep(run):
    """Copy the bags of a run beside its log, since the next run may write over them; return their new paths.

    The path is '' if a bag was not copied.
    """
    kept = {}
    left = _MOST_BAG_BYTES
    for number, (key, path) in enumerate(sorted(run.bags.items())):
        with contextlib.suppress(OSError):
            left -= os.path.getsize(path)
            if left >= 0:
                kept[key] = os.path.join(os.path.dirname(run.log), 'bag_{}.bag'.format(number))
                shutil.copyfile(path, kept[key])
    return {key: kept.get(key, '') for key in run.bags}


def _remove(run):
    """Remove the file of a run's messages, which was kept only to compare runs."""
    with contextlib.suppress(OSError):
        os.unlink(run.message_bytes)  # this run's time master has made it


def _read_end(path):
    """Return the end record of a log, the simulated time [s] of the run, and the numbers of events and messages."""
    with event_log.opened(path) as log:
        messages = sum(row.kind in run_difference.MESSAGES for row in log.rows())
    if log.end is None:
        raise EventLogError('{}: has no end record: the run did not end properly'.format(path))
    return log.end, (log.end['at_ns'] - log.start_ns) * 1e-9, log.events - messages, messages


def _last_lines(path):
    lines = list(difference_report.lines_of(path))[-_OUTPUT_LINES:]
    return '\n'.join('    ' + line for line in lines) or '    (it printed nothing)'
