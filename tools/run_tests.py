"""Run the tests, a few steps at a time, and print a summary.

usage: run_tests.py [--only PART_OF_A_NAME] [--jobs N]    (in the built environment: source .ws/setup.sh)
       run_tests.py --night RUNS [--part K/N] [--hours H] ...    what `make nightly` runs

A step is one process (test_steps.py has them all). It writes its results to a folder of its own below
.ws/test_results, which is emptied first, and its output to output.log there. A step that dies, hangs or leaves no
result counts as a failure of its own. Steps share no ROS master, port or folder, and none measures wall time, so they
may run at the same time.

The runner has one thread, imports what the tests of systems need, and forks for each of their files: otherwise each
would import the same for a second.
"""
import argparse
import fcntl
import importlib
import json
import os
import shutil
import signal
import sys
import time
import traceback
import xml.etree.ElementTree as ElementTree
from collections import namedtuple

import nightly
import psutil
import test_steps
import test_summary
from test_steps import ROOT, WS

from move_base_abstract.common import processes
from move_base_abstract_ros.launching import warm_nodes
from move_base_abstract_ros.lockstep.programs import address_layout

TIMES = WS / 'test_times.json'  # CPU seconds of each step, in its last run
# Wall seconds. It only ends a step that would never end: a busy machine may need 20 times the time of an idle one.
LIMIT_S, NIGHT_LIMIT_S = 1800.0, 5400.0
GRACE_S = 20.0  # wall seconds between the request to stop and the kill
LOOK_S = 0.02  # wall seconds between two looks at the processes
FEWEST_JOBS, MOST_JOBS = 4, 5  # a step also waits: for processes to start, or for time to pass
IMPORTS = ('pytest', '_pytest.junitxml', 'psutil', 'actionlib', 'rosbag', 'std_msgs.msg', 'sensor_msgs.msg')

Running = namedtuple('Running', 'step pid began')


class Runner:
    """Runs steps in their order, at most ``jobs`` at a time. Use it as a context manager: it ends all that runs."""

    def __init__(self, results, jobs, limit):
        """``results``: the folder for the results; ``limit``: how long a step may take [s, wall]."""
        self._results, self._jobs, self._limit = results, jobs, limit
        self._running = []
        self.done = []  # (step, CPU s, wall s, whether it passed)

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        for one in self._running:
            _stop(one.pid)

    def run(self, steps, may_begin=lambda: True):
        """Run the steps; those for which may_begin() is false when their turn comes are left out."""
        todo = list(steps)
        while todo or self._running:
            while todo and len(self._running) < self._jobs:
                step = todo.pop(0)
                if may_begin():
                    self._start(step)
            for one in self._running[:]:
                self._look(one)
            time.sleep(LOOK_S)

    def _start(self, step):
        folder = self._results / step.name
        folder.mkdir(parents=True)
        with open(folder / test_summary.LOG_NAME, 'wb') as log:
            pid = _fork(step, self._results, log)
        self._running.append(Running(step, pid, time.monotonic()))

    def _look(self, one):
        """Look whether a step has ended, or has to be ended."""
        seconds = time.monotonic() - one.began
        ended, status, used = os.wait4(one.pid, os.WNOHANG)
        if ended:
            code = os.WEXITSTATUS(status) if os.WIFEXITED(status) else -os.WTERMSIG(status)
            problem = f'exit code {code}' if code else None
        elif seconds > self._limit:
            problem, used = f'still running after {self._limit:.0f} s', _stop(one.pid)
        else:
            return
        self._running.remove(one)
        self._conclude(one.step, problem, used.ru_utime + used.ru_stime, seconds)

    def _conclude(self, step, problem, cpu, seconds):
        """Print one line; add a failure if the step failed without one."""
        folder = self._results / step.name
        cases = test_summary.read_cases(folder)
        if problem is None and not cases:
            problem = 'it left no result'
        failed = any(case.outcome == test_summary.FAILED for case in cases)
        if problem is not None and not (failed and problem.startswith('exit code')):  # the failed case is enough
            _write_failure(step, folder, problem)
            failed = True
        note = f'  ({problem})' if problem else ''
        print(f'{"FAIL" if failed else "ok  "}  {step.name:<36} {len(cases):4d} tests {seconds:6.1f} s, '
              f'{cpu:5.1f} s of CPU{note}', flush=True)
        self.done.append((step, cpu, seconds, not failed))


def _fork(step, results, log):
    """Begin a step in a process of its own, which ends with this one; return its id."""
    parent = os.getpid()
    pid = os.fork()
    if pid:
        return pid
    code = 1
    try:
        processes.die_with(parent)
        for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGTERM, signal.SIG_DFL)):
            signal.signal(number, handler)
        with open(os.devnull) as nothing:
            os.dup2(nothing.fileno(), 0)
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
        os.chdir(ROOT)
        if step.forks:
            sys.modules['warm'].prepare()
        os.environ.pop('PYTHONHASHSEED')  # tests, and what they start, have what any process has
        address_layout.choose({address_layout.VARIABLE: address_layout.RANDOM})
        if not step.forks:
            words = step.words(results)
            os.execv(words[0], words)
        sys.argv = ['pytest', *step.pytest_words(results)]
        code = int(importlib.import_module('pytest').main(sys.argv[1:]))
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


def _import_for_forks():
    """Import what each fork needs."""
    # The devel space's packages put the sources before the folder of this program.
    standard_path = sys.path[sys.path.index(str(ROOT / 'tools')) + 1:]
    sys.path[:0] = [str(test_steps.TEST / 'systems'), str(test_steps.TEST)]
    for name in IMPORTS:
        importlib.import_module(name)
    importlib.import_module('warm').import_all(standard_path)
    for name in processes.ONE_THREAD:  # for the imports; tests must not see it (nproc goes by it)
        os.environ.pop(name, None)


def _stop(pid):
    """End a step and all processes that it started (each node has a session of its own); return what it has used."""
    family = psutil.Process(pid).children(recursive=True)
    os.kill(pid, signal.SIGINT)
    deadline = time.monotonic() + GRACE_S
    ended, _, used = os.wait4(pid, os.WNOHANG)
    while not ended and time.monotonic() < deadline:
        time.sleep(LOOK_S)
        ended, _, used = os.wait4(pid, os.WNOHANG)
    if not ended:
        os.kill(pid, signal.SIGKILL)
        _, _, used = os.wait4(pid, 0)
    for member in family:
        try:
            member.kill()
        except psutil.NoSuchProcess:
            pass
    return used


def _write_failure(step, folder, problem):
    text = f'{step.name}: {problem}; the end of its output:\n{test_summary.log_tail(folder)}'
    suite = ElementTree.Element('testsuite', name=step.name)
    case = ElementTree.SubElement(suite, 'testcase', classname=step.name, name='ends_well_and_leaves_results')
    # XML cannot contain the control characters of coloured output.
    printable = ''.join(c for c in text if c in '\n\t' or c.isprintable())
    ElementTree.SubElement(case, 'failure', message=problem).text = printable
    ElementTree.ElementTree(suite).write(folder / 'step.xml', encoding='utf-8', xml_declaration=True)


def wait_for_other_run(lock):
    """Take the lock, so that two runs in the same tree do not remove each other's results."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print('waiting for another test run in this tree to end', flush=True)
        fcntl.flock(lock, fcntl.LOCK_EX)


def _chosen(steps, part, parser):
    """Return the steps, or parts of them, that a part of a name chooses."""
    found = [one for one in (step.chosen(part) for step in steps) if one is not None]
    if not found:
        parser.error(f'no name of a step or of a test file contains {part!r}; there are '
                     f'{", ".join(step.name for step in steps)}, and the files of test/unit')
    return found


def _longest_first(steps):
    """Return the steps by the CPU time that they took in their last runs here; others keep their places before them."""
    try:
        times = json.loads(TIMES.read_text())
    except (OSError, ValueError):
        times = {}
    return sorted(steps, key=lambda step: -times.get(step.name, sys.maxsize)), times


def _arguments():
    parser = argparse.ArgumentParser(description='Run the tests of move_base_abstract.')
    parser.add_argument('--only', default='', metavar='PART',
                        help='run only the steps whose name contains PART, and the test files whose names do')
    usual = min(max(os.cpu_count() or 1, FEWEST_JOBS), MOST_JOBS)
    parser.add_argument('--jobs', type=int, default=usual, metavar='N', help='steps at a time (default: %(default)s)')
    nightly.add_arguments(parser)
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        parser.error(f'--jobs must be at least 1, got {arguments.jobs}')
    return arguments, parser


def main():
    """Run the chosen steps; exit with 1 if anything failed."""
    os.environ.update({**processes.ONE_THREAD, **os.environ})
    warm_nodes.start_again()  # once, so that forks can be nodes
    signal.signal(signal.SIGTERM, lambda number, _frame: sys.exit(128 + number))  # so that it ends what it started
    arguments, parser = _arguments()
    night = nightly.Night(arguments, parser) if arguments.night else None
    steps = _chosen(night.steps if night else test_steps.by_day(), arguments.only, parser)
    results = WS / ('nightly' if night else 'test_results')
    os.environ.setdefault('ROS_LOG_DIR', str(WS / 'ros_home' / 'log'))
    os.environ['PYTHONUNBUFFERED'] = '1'  # so that a log is complete if a process must be killed
    with open(WS / 'test.lock', 'w') as lock:
        wait_for_other_run(lock)
        shutil.rmtree(results, ignore_errors=True)
        results.mkdir()
        if any(step.forks for step in steps):
            _import_for_forks()
        steps, times = _longest_first(steps) if night is None else (night.begin(steps, results), {})
        with Runner(results, arguments.jobs, NIGHT_LIMIT_S if night else LIMIT_S) as runner:
            try:
                runner.run(steps, *([night.may_begin] if night else []))
            finally:
                if night:  # also if it is ended before its time
                    night.conclude(runner.done)
        if not night and not arguments.only:
            TIMES.write_text(json.dumps({**times, **{step.name: round(cpu, 1) for step, cpu, *_ in runner.done}}))
        sys.exit(test_summary.summarise(results))


if __name__ == '__main__':
    main()
