"""Why a test has failed, in words for its report: how nodes ended, what chaos decided, and how to run it again."""
from __future__ import annotations

import contextlib
import json
import os
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Optional, Sequence

from move_base_abstract.common.input_files import sha256_of
from move_base_abstract.common.shown import pasted
from move_base_abstract.faults import buggify
from move_base_abstract.lockstep import replay_file
from move_base_abstract.runs import debug_command, ends, event_log, run_file
from move_base_abstract.runs.built_in import Broken
from move_base_abstract_ros.launching.outputs import Files

from . import debugged

if TYPE_CHECKING:
    from .system_under_test import Lockstep

TITLE = 'why'
DECISIONS, REPLAY = 'chaos_decisions.jsonl', 'chaos.json'  # files of a run's folder
_CALL, _FAILED = 'call', 'failed'
_MOST_NODES, _MOST_LINES, _MOST_DECISIONS, _LAST_BYTES = 5, 6, 10, 1 << 14
_OF_MASTER = 'rosmaster.txt'
_TRACEBACK = 'Traceback (most recent call last):'


def tell(item: Any, system: Lockstep, reports: Sequence[Any]) -> None:
    """Let a test fail whose run has broken a property; add to the report of a test that fails why it does.

    ``reports``: those of the item, whose run is over; each is changed.
    """
    broken = system.told_broken
    call = next((one for one in reports if one.when == _CALL), None)
    text = 'broken:\n' + '\n'.join('  ' + one.words() for one in broken) if broken else ''
    if text and call is not None and call.outcome != _FAILED:
        is_expected = hasattr(call, 'wasxfail')
        call.outcome, call.longrepr = 'skipped' if is_expected else _FAILED, text
        text = ''
    bad = next((one for one in reports if one.failed), None)
    if bad is not None and system.has_run:
        lines = [*text.splitlines(), *_of_nodes(system, broken), *_of_chaos(item, system, bad, broken),
                 *_of_debugger(item, system, broken)]
        bad.sections += [(TITLE, '\n'.join(lines))] if lines else []


def again(item: Any) -> str:
    """Return the command that runs a test again, from the folder in which pytest was started."""
    return 'python3 -m pytest -p move_base_abstract_testing ' + pasted(_id(item))


def _id(item: Any) -> str:
    return '{}::{}'.format(os.path.relpath(str(item.fspath), _start_of(item)), item.nodeid.partition('::')[2])


def _start_of(item: Any) -> str:
    return str(item.config.invocation_params.dir)


def last_words(folder: str) -> Iterator[str]:
    """Yield the last lines of all that has printed into a run's folder. Nothing else is known of that run."""
    for name in sorted(os.listdir(folder)):
        lines = _last_lines(os.path.join(folder, name)) if name.endswith('.txt') and name != _OF_MASTER else []
        if lines:
            yield f'{name[:-len(".txt")]} printed last:'
            yield from ('    ' + line for line in lines)


def _of_nodes(system: Lockstep, broken: Sequence[Broken]) -> Iterator[str]:
    """Yield what crashed nodes have raised and printed last; if none has, those that are broken; else the user's."""
    crashed = [one for one in system.ends if one.crash is not None]
    names = [one.node for one in crashed]
    for one in crashed:
        yield one.words
        last = one.last_lines or _printed(system, one.node)
        raised = [line for line in _raised(_output(system, one.node)) if line not in last]
        yield from ('    ' + line for line in (*raised, *last))
    others = [one.node for one in broken if one.node not in names] or ([] if names else system.nodes_of_user)
    for name in list(dict.fromkeys(others))[:_MOST_NODES]:
        lines = _printed(system, name)
        if lines:
            yield f'{name} printed last:'
            yield from ('    ' + line for line in lines)


def _output(system: Lockstep, name: str) -> str:
    return str(Files(system.folder).of(name).path)


def _printed(system: Lockstep, name: str) -> List[str]:
    """Return the last lines that a node had printed when the test was over. The end of the run adds its own."""
    path = _output(system, name)
    return _last_lines(path, system.sizes.get(os.path.basename(path), 0))


def _last_lines(path: str, size: Optional[int] = None) -> List[str]:
    """Return the last lines of a file of which ``size`` bytes count; None: all."""
    with contextlib.suppress(OSError), open(path, 'rb') as stream:
        size = os.fstat(stream.fileno()).st_size if size is None else size
        stream.seek(max(0, size - _LAST_BYTES))
        lines = stream.read(min(size, _LAST_BYTES)).decode('utf-8', 'replace').splitlines()
        return [ends.plain_line(line) for line in lines if line.strip()][-_MOST_LINES:]
    return []


def _raised(path: str) -> List[str]:
    """Return the last lines of the first tracebacks in what a node has printed: the exceptions with their texts."""
    found: List[str] = []
    with contextlib.suppress(OSError), open(path, encoding='utf-8', errors='replace') as stream:
        is_within = False
        for line in stream:
            if line.startswith(_TRACEBACK):
                is_within = True
            elif is_within and line.strip() and not line[0].isspace():
                found.append(ends.plain_line(line))
                is_within = False
            if len(found) == _MOST_LINES:
                break
    return list(dict.fromkeys(found))


def _of_chaos(item: Any, system: Lockstep, bad: Any, broken: Sequence[Broken]) -> Iterator[str]:
    """Yield the decisions of the run's chaos, up to the break, and write the file that runs the test again."""
    options, log = system.options, os.path.join(system.folder, 'events.jsonl')
    if not (options.chaos_seed and os.path.exists(log)):
        return
    instants = [one.instant_ns for one in broken if one.instant_ns is not None]
    made = _decisions(os.path.join(system.folder, DECISIONS), log, min(instants, default=None))
    said = [*map(replay_file.said, made)]
    yield 'the chaos of seed {} made {} decision{}{}{}'.format(
        options.chaos_seed, len(said), 's' * (len(said) != 1), ' before that' * bool(instants),
        ', of these the last:' if len(said) > _MOST_DECISIONS else ':' if said else '')
    yield from ('    ' + line for line in said[-_MOST_DECISIONS:])
    text = broken[0].words() if broken else _first_line(bad)
    replay_file.write(os.environ.get(replay_file.VARIABLE) or os.path.join(system.folder, REPLAY), replay_file.Replay(
        [], options.chaos_seed, options.chaos_delay, [], broken[0].property if broken else 'test', text,
        happened=said, sha256=sha256_of(log), starts=options.chaos_starts, test=[_start_of(item), '{}::{}'.format(
            str(item.fspath), item.nodeid.partition('::')[2])]))


def _of_debugger(item: Any, system: Lockstep, broken: Sequence[Broken]) -> Iterator[str]:
    """Yield the command that leads to before the fault in the debugger, and write what it needs beside the log."""
    log = os.path.join(system.folder, 'events.jsonl')
    if debugged.asked() or not os.path.exists(log):
        return
    run_file.write(log, run_file.of_run([_id(item)], _start_of(item), system.environment,
                                        [str(item.fspath), *system.files], debugged.PROGRAM))
    end, _ = ends.read_log(log).departures.get('/test', (None, False))
    yield 'before that, in the debugger: ' + debug_command.of_log(log, [one.instant_ns for one in broken] or [end])


def _decisions(path: str, log: str, until_ns: Optional[int]) -> List[Dict[str, Any]]:
    """Return the decisions in the file ``path``, and the deliberate faults of robots in the log, by their instants."""
    found = []
    with contextlib.suppress(OSError), open(path, encoding='utf-8') as stream:
        found += [json.loads(line) for line in stream]
    with contextlib.suppress(event_log.EventLogError), event_log.opened(log) as read:
        found += buggify.decisions(read.rows(buggify.GOES_WRONG))
    return sorted((one for one in found if until_ns is None or one['time_ns'] <= until_ns),
                  key=lambda one: int(one['time_ns']))


def _first_line(report: Any) -> str:
    crash = getattr(report.longrepr, 'reprcrash', None)
    return str(crash.message if crash is not None else report.longrepr).partition('\n')[0]
