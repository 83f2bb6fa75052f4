"""Run a test in a fork of pytest, since a process can be only one ROS node. The fork has all imports done."""
from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
import time
from typing import Any, Iterable, List, Optional

from move_base_abstract.common import guard, processes, temporary
from move_base_abstract.common.shown import pasted
from move_base_abstract.runs import event_log

from . import debugged, failing

WALL_LIMIT_S = 120.0
_LOOKED_AT_S = 1e8  # wall; for a test that somebody debugs
_GRACE_S = 1.0  # wall, from the fork's reports to its end
_CALL = 'call'
_PIECE = 1 << 16


def reports_of(item: Any, wall_limit: float) -> List[Any]:
    """Run an item in a process of its own, and return its reports.

    If the test calls ``assert_identical()``, it is run twice, and fails if the two event logs differ.

    :param wall_limit: how long one run may take [s, wall].
    """
    folder, is_debugged = temporary.make('test_'), debugged.asked() is not None
    wall_limit = _LOOKED_AT_S if is_debugged else wall_limit
    reports = _run(item, os.path.join(folder, 'run_1'), wall_limit)
    if _is_good(reports) and not is_debugged and os.path.exists(os.path.join(folder, 'run_1', 'assert_identical')):
        again = _run(item, os.path.join(folder, 'run_2'), wall_limit)
        problem = '' if _is_good(again) else 'the second run of the test fails:\n{}'.format(
            '\n'.join('\n'.join([str(one.longrepr), *_why(one)]) for one in again if one.failed))
        problem = problem or _difference(*(os.path.join(folder, name, 'events.jsonl') for name in ('run_1', 'run_2')))
        for report in reports:
            if problem and report.when == _CALL:
                report.outcome, report.longrepr = 'failed', problem
    if is_debugged or _is_good(reports):
        temporary.remove(folder)
    else:
        temporary.keep(folder)
        for report in reports:
            if report.failed:
                report.sections.append(('lockstep', '\n'.join(_next(item, folder))))
    return reports


def _why(report: Any) -> List[str]:
    return [text for title, text in report.sections if title == failing.TITLE]


def _next(item: Any, folder: str) -> List[str]:
    """Return what the user of a test that has failed can look at, and type next."""
    replay = os.path.join(folder, 'run_1', failing.REPLAY)
    by_chaos = ['or, and compare it: rosrun move_base_abstract chaos --replay ' + pasted(replay)]
    return ['event log and output of the nodes: {}'.format(folder), 'run it again: ' + failing.again(item),
            *(by_chaos if os.path.exists(replay) else [])]


def _is_good(reports: Iterable[Any]) -> bool:
    return not any(report.failed for report in reports)


def _run(item: Any, folder: str, wall_limit: float) -> List[Any]:
    """Return the reports of one run of an item."""
    os.mkdir(folder)
    item.lockstep_folder = folder
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    _import_all()
    read, write = os.pipe()
    pid = os.fork()
    if pid == 0:
        code = 1
        try:
            os.close(read)
            os.setpgid(0, 0)
            processes.die_with(os.getppid(), signal.SIGTERM)
            guard.stand('pytest')
            signal.signal(signal.SIGTERM, _end_at_once)  # pytest would take an exit for a failure of the test
            found = _runner(item).runtestprotocol(item, log=False, nextitem=None)
            if hasattr(item, 'lockstep_system'):
                failing.tell(item, item.lockstep_system, found)
            told = [item.config.hook.pytest_report_to_serializable(config=item.config, report=one) for one in found]
            with os.fdopen(write, 'w') as stream:
                json.dump(told, stream, default=str)
            code = 0
        finally:
            os._exit(code)
    os.close(write)
    try:
        text = _read(read, wall_limit)
    except KeyboardInterrupt:  # so `debug` ends the run of a test
        if debugged.asked() is None:
            raise
        os.kill(pid, signal.SIGTERM)
        _end(pid)
        temporary.remove(os.path.dirname(folder))
        os._exit(0)
    _end(pid)
    return _reports(item, text, wall_limit, folder)


def _end_at_once(*_signal: Any) -> None:
    processes.end_all_children()
    os._exit(1)


def _runner(item: Any) -> Any:
    """Return the module of pytest that runs tests."""
    return item.config.pluginmanager.getplugin('runner')


def _import_all() -> None:
    """Import the modules that each run needs. This is done once, in the process that is then forked."""
    from move_base_abstract_ros.launching import warm_nodes

    from . import system_under_test  # noqa: F401 - for the forks
    warm_nodes.import_all()


def _read(descriptor: int, wall_limit: float) -> Optional[bytes]:
    """Return what the fork writes (bytes), or None if it has not finished after ``wall_limit`` [s, wall]."""
    deadline, found = time.monotonic() + wall_limit, b''
    with os.fdopen(descriptor, 'rb', 0) as stream:
        while True:
            ready, _, _ = select.select([stream], [], [], max(0.0, deadline - time.monotonic()))
            if not ready:
                return None
            piece = stream.read(_PIECE)
            if not piece:
                return found
            found += piece


def _end(pid: int) -> None:
    """End the fork if it has not ended by itself. It is the guard of the test's process, and ends its children."""
    forked = processes.Forked(pid)
    try:
        forked.wait(_GRACE_S)
    except subprocess.TimeoutExpired:
        for child in processes.children(str(pid)):
            os.kill(child, signal.SIGKILL)
        forked.wait()


def _reports(item: Any, text: Optional[bytes], wall_limit: float, folder: str) -> List[Any]:
    if text:
        return [item.config.hook.pytest_report_from_serializable(config=item.config, data=one)
                 for one in json.loads(text)]
    why = 'the test was not over after {:g} s of wall time (wall_limit)'.format(wall_limit) if text is None else (
        'the process of the test has died')
    report = _runner(item).TestReport(item.nodeid, item.location, dict.fromkeys(item.keywords, 1), 'failed', why, _CALL)
    report.sections.append((failing.TITLE, '\n'.join(failing.last_words(folder))))
    return [report]


def _difference(first: str, second: str) -> str:
    """Return a text that says where the event logs of two runs differ, or '' if they are equal and repeatable."""
    with event_log.opened(first) as one, event_log.opened(second) as other:
        logs = one, other
        found = event_log.compare(*logs)
    if not found.identical:
        return 'a second run is different:\n  first:  {}\n  second: {}'.format(
            *('no more events' if event is None else event.text for event in (found.first, found.second)))
    labels = [label for log in logs if log.end is not None for label in event_log.labels_of(log.end)]
    return 'two runs are equal, but not called repeatable: {}'.format(labels[0]) if labels else ''
