"""Run gtest, pytest, every rostest and the install-space test, a few at a time, and print a summary.

usage: run_tests.py [--only PART_OF_A_NAME] [--jobs N]    (in the built environment: source .ws/setup.sh)

Each step writes its results to a folder of its own below .ws/test_results, which is emptied first, and its output to
output.log there. A step that dies, hangs or leaves no result counts as a failure of its own. Steps share no ROS master,
port or folder, and none measures wall time, so they may run at the same time.
"""
import argparse
import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import psutil
import test_summary

ROOT = Path(__file__).resolve().parent.parent
WS = ROOT / '.ws'
RESULTS = WS / 'test_results'
VENV_PYTHON = WS / 'venv' / 'bin' / 'python'  # the same Python, with the study's packages from PyPI
PLAIN_PYTHON = WS / 'plain' / 'bin' / 'python'  # the same Python, with the packages for processes in plain Python
INDEX = ROOT / 'docs' / 'site' / 'index.md'  # the tutorials are its first group
TUTORIALS = ROOT / 'test' / 'tutorials' / 'test_tutorials.py'
ROSTEST = '/usr/bin/rostest'
# Wall seconds. It only ends a step that would never end: a busy machine may need 20 times the time of an idle one.
LIMIT_S = 1800.0
GRACE_S = 20.0  # wall seconds between the request to stop and the kill
FEWEST_JOBS, MOST_JOBS = 3, 4  # a step mostly waits: for processes to start, or for time to pass


@dataclass(frozen=True)
class Step:
    """One command that writes JUnit XML to RESULTS/name."""

    name: str
    command: tuple

    @property
    def folder(self):
        """Folder of the results and of the log."""
        return RESULTS / self.name


def all_steps():
    """Return the steps in the order in which they begin, quick ones first."""
    steps = [_gtest(name) for name in ('time_master_test', 'lockstep_test', 'event_log_writer_test', 'shim_fit_test',
                                       'shim_heap_test', 'pending_parameters_test',
                                       'parameters_at_start_test')]
    steps += [_pytest('unit', ROOT / 'test' / 'unit', VENV_PYTHON)]
    steps += [_pytest('plain', ROOT / 'test' / 'plain', PLAIN_PYTHON)]
    steps += [_pytest(name, ROOT / 'test' / name) for name in ('export', 'browser', 'plugin')]
    steps += [_rostest(path) for path in sorted((ROOT / 'test' / 'rostest').glob('*.test'))]
    steps += [_pytest('tutorials', ROOT / 'test' / 'tutorials' / 'test_runner.py')]
    steps += [_pytest(f'tutorial_{page}', f'{TUTORIALS}::test_a_tutorial_shows_what_it_says[{page}]')
              for page in re.findall(r'^docs/(\w+)$', INDEX.read_text().split(':caption: ')[1], re.MULTILINE)]
    return [*steps, _pytest('install', ROOT / 'test' / 'install')]


def _gtest(target):
    name = f'gtest_{target}'
    program = WS / 'devel' / 'lib' / 'move_base_abstract' / target
    return Step(name, (program, f'--gtest_output=xml:{RESULTS / name}/gtest.xml'))


def _pytest(name, folder, python=sys.executable):
    name = f'pytest_{name}'
    command = (python, '-m', 'pytest', '-p', 'no:cacheprovider', folder,
               f'--junitxml={RESULTS / name}/pytest.xml')
    return Step(name, command)


def _rostest(path):
    name = f'rostest_{path.stem}'
    rostest = shutil.which('rostest') or ROSTEST
    command = (sys.executable, rostest, f'--pkgdir={ROOT}', '--package=move_base_abstract',
               f'--results-filename={path.stem}.xml', f'--results-base-dir={RESULTS / name}', path)
    return Step(name, command)


def run_steps(steps, jobs):
    """Run the steps in their order, at most ``jobs`` at a time; an interrupt ends those that run."""
    running = []
    with ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(run_step, step, running) for step in steps]
        try:
            for future in as_completed(futures):
                future.result()
        except BaseException:
            for future in futures:
                future.cancel()
            for process in list(running):
                _stop(process)
            raise


def run_step(step, running):
    """Run one step to its end or its limit, and print one line; add a failure if the step failed without one."""
    step.folder.mkdir(parents=True)
    started = time.monotonic()
    problem, cpu = _run_command(step, running)
    cases = test_summary.read_cases(step.folder)
    if problem is None and not cases:
        problem = 'it left no result'
    failed = any(case.outcome == test_summary.FAILED for case in cases)
    if problem is not None and not (failed and problem.startswith('exit code')):  # the failed case is enough
        _write_failure(step, problem)
        failed = True
    seconds = time.monotonic() - started
    note = f'  ({problem})' if problem else ''
    print(f'{"FAIL" if failed else "ok  "}  {step.name:<36} {len(cases):4d} tests {seconds:6.1f} s, {cpu:5.1f} s of CPU'
          f'{note}', flush=True)


def _run_command(step, running):
    """Return (None or the problem in a few words, CPU seconds); the process is in ``running`` while it runs."""
    with open(step.folder / test_summary.LOG_NAME, 'wb') as log:
        process = subprocess.Popen([str(word) for word in step.command], cwd=ROOT, stdin=subprocess.DEVNULL,
                                   stdout=log, stderr=subprocess.STDOUT)
        running.append(process)
        try:
            has_ended = _wait_for_end(process)
            cpu = sum(psutil.Process(process.pid).cpu_times()[:4])  # its own, and that of children that it has reaped
            if not has_ended:
                _stop(process)
                return f'still running after {LIMIT_S:.0f} s', cpu
            code = process.wait()
        finally:
            running.remove(process)
    return f'exit code {code}' if code else None, cpu


def _wait_for_end(process):
    """Return whether the process ends within the limit; its exit status stays for a later wait()."""
    limit = time.monotonic() + LIMIT_S
    while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is None:
        if time.monotonic() > limit:
            return False
        time.sleep(0.05)
    return True


def _stop(process):
    """End a step and all processes that it started (roslaunch gives each node a session of its own)."""
    try:
        family = psutil.Process(process.pid).children(recursive=True)
    except psutil.NoSuchProcess:
        return
    process.send_signal(signal.SIGINT)
    try:
        process.wait(timeout=GRACE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    for member in family:
        try:
            member.kill()
        except psutil.NoSuchProcess:
            pass


def _write_failure(step, problem):
    text = f'{step.name}: {problem}; the end of its output:\n{test_summary.log_tail(step.folder)}'
    suite = ElementTree.Element('testsuite', name=step.name)
    case = ElementTree.SubElement(suite, 'testcase', classname=step.name, name='ends_well_and_leaves_results')
    # XML cannot contain the control characters of coloured output.
    printable = ''.join(c for c in text if c in '\n\t' or c.isprintable())
    ElementTree.SubElement(case, 'failure', message=problem).text = printable
    ElementTree.ElementTree(suite).write(step.folder / 'step.xml', encoding='utf-8', xml_declaration=True)


def wait_for_other_run(lock):
    """Take the lock, so that two runs in the same tree do not remove each other's results."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print('waiting for another test run in this tree to end', flush=True)
        fcntl.flock(lock, fcntl.LOCK_EX)


def main():
    """Run the chosen steps; exit with 1 if anything failed."""
    parser = argparse.ArgumentParser(description='Run the tests of move_base_abstract.')
    parser.add_argument('--only', default='', metavar='PART', help='run only the steps whose name contains PART')
    usual = min(max(os.cpu_count() or 1, FEWEST_JOBS), MOST_JOBS)
    parser.add_argument('--jobs', type=int, default=usual, metavar='N', help='steps at a time (default: %(default)s)')
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        parser.error(f'--jobs must be at least 1, got {arguments.jobs}')
    only = arguments.only
    steps = [step for step in all_steps() if only in step.name]
    if not steps:
        parser.error(f'no name of a step contains {only!r}; there are {", ".join(step.name for step in all_steps())}')
    os.environ.setdefault('ROS_LOG_DIR', str(WS / 'ros_home' / 'log'))
    os.environ['PYTHONUNBUFFERED'] = '1'  # so that a log is complete if a process must be killed
    with open(WS / 'test.lock', 'w') as lock:
        wait_for_other_run(lock)
        shutil.rmtree(RESULTS, ignore_errors=True)
        run_steps(steps, arguments.jobs)
        sys.exit(test_summary.summarise(RESULTS))


if __name__ == '__main__':
    main()
