"""The command line: rosrun move_base_abstract chaos."""
from __future__ import annotations

import argparse
import os
import time
from typing import Any, Dict, Iterable, Optional, Sequence, Tuple

from move_base_abstract.common import kinds
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.run_options import RunOptions
from move_base_abstract.properties import Gathering

from .. import ending
from . import failures, replay_file
from .replay_file import Replay
from .runs import PARTS, RunRequest, RunResult, Runs, document_of

GOOD, FAILED, OTHER = 0, 1, 3
_LARGEST_SEED = 2147483647
_OWN = ('chaos_seed', 'chaos_delay', 'chaos_only', 'lookahead')  # RunOptions that are not allowed here


def main(words: Sequence[str]) -> int:
    """Run the command with these arguments; return the exit code, which the epilog of --help explains."""
    parser, options = _parse(words)
    return ending.exit_code('chaos', lambda: _replay(options) if options.replay else _search(parser, options))


def _parse(words: Sequence[str]) -> Tuple[argparse.ArgumentParser, argparse.Namespace]:
    from move_base_abstract_ros.nodes import lockstep_launch
    parser = argparse.ArgumentParser(
        prog='chaos', usage='%(prog)s [options] [PACKAGE] FILE [ARG:=VALUE ...]\n       %(prog)s --replay FILE',
        description='Run a launch file with other legal orders of equal events until something fails.',
        epilog='exit codes: 0 nothing failed, 1 something failed (with --replay: it fails again), 2 the file cannot be '
        'run like this, 3 (with --replay) it does not fail any more, 130 interrupted')
    parser.add_argument('--seeds', type=_seeds, default=(1, 100), metavar='FIRST:LAST', help='seeds to try '
                        '(default: 1:100)')
    parser.add_argument('--delay', type=_delay, default=0.0, metavar='S',
                        help='messages take up to S simulated seconds; 0: only the order of equal events changes')
    parser.add_argument('--property', action='append', default=[], metavar='NAME',
                        help='look only for this failure: a name of your own, {}; repeat it for several'.format(
                            ', '.join(failures.NAMES)))
    parser.add_argument('--workers', type=_count, default=os.cpu_count() or 1, metavar='N',
                        help='runs at the same time (default: one per core)')
    parser.add_argument('--output', default='chaos.json', metavar='FILE', help='file that replays the failure '
                        '(default: %(default)s)')
    parser.add_argument('--replay', metavar='FILE', help='run a failure again, and say whether it is the same')
    parser.add_argument('--until', type=float, default=0.0, metavar='S', help='end a run S simulated seconds after '
                        'its start')
    lockstep_launch.add_node_options(parser)
    parser.add_argument('--seed', type=int, default=0, metavar='S', help="seed of the programs' global random "
                        "generators")
    kinds.add_arguments(parser, RunOptions)
    parser.add_argument('command', nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    options = parser.parse_args(words)
    for name in _OWN:
        if getattr(options, name):
            parser.error(f"--{name.replace('_', '-')}: not here; --seeds and --delay say what is tried")
    if options.replay and options.command:
        parser.error(f'--replay: the file says what is run; got also {" ".join(options.command)}')
    return parser, options


def _seeds(text: str) -> Tuple[int, int]:
    first, colon, last = text.partition(':')
    low, high = int(first), int(last if colon else first)
    if not 1 <= low <= high <= _LARGEST_SEED:
        raise argparse.ArgumentTypeError(f'must be FIRST:LAST in 1..{_LARGEST_SEED}, got {text}')
    return low, high


def _delay(text: str) -> float:
    value = float(text)
    if not 0.0 <= value <= 1000.0:
        raise argparse.ArgumentTypeError(f'must be a number of simulated s in 0..1000, got {text}')
    return value


def _count(text: str) -> int:
    value = int(text)
    if not 1 <= value <= 1024:
        raise argparse.ArgumentTypeError(f'must be a whole number in 1..1024, got {text}')
    return value


def _document_options(options: argparse.Namespace) -> Dict[str, Any]:
    """Return the options as keys of an experiment's file, and as those of PARTS."""
    record = kinds.of_arguments(RunOptions, options)
    found = {one.key or one.field: list(value) if isinstance(value, tuple) else value
             for one, value in kinds.collected(record, lambda _one: True)}
    found.update({name: getattr(options, name) for name in (*PARTS, 'leave_out') if getattr(options, name)})
    found.update({'replace': {'/'.join(old): '/'.join(new) for old, new in options.replace}} if options.replace else {})
    found.update({'until': options.until} if options.until else {})
    return {**found, **({'seed': options.seed} if options.seed else {})}


def _search(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    from move_base_abstract_ros.nodes import lockstep_launch
    (path, arguments), = lockstep_launch.files_of(parser, options.command)
    more = _document_options(options)
    first, last = options.seeds
    begin = time.monotonic()
    with Runs(document_of(path, arguments, dict(more)), os.getcwd(), options.workers, options.delay,
              options.property) as runs:
        # The stated order, seed 0, comes first. If it fails, no chaos is needed.
        seeds = [RunRequest(0), *map(RunRequest, range(first, last + 1))]
        gathered = Gathering()
        found = _first_failing(runs.each(seeds), gathered)
        passed = time.monotonic() - begin
        _say(f"{_counted(runs.count, 'run')} in {passed:.1f} s of wall time, {60 * runs.count / passed:.0f} a minute")
        for (node, text), (said, held) in gathered.sometimes.items():
            _say(f"sometimes: {node}: {text}: came true in {held or 'none'} of the {_counted(said, 'run')} that say it")
        if found is None:
            _say(f'nothing failed in the stated order and with the seeds {first} to {last}')
            return GOOD
        made = Replay([path, *arguments], found.chosen.seed, options.delay, [], '', '', more)
        return _tell(runs, found, made, options.output)


def _first_failing(told: Iterable[RunResult], gathered: Gathering) -> Optional[RunResult]:
    """Return the first run that fails, or None. ``gathered`` takes the statements of all runs up to that one."""
    for one in told:
        if one.judged is not None:
            gathered.take(f'seed {one.chosen.seed}', one.chosen.seed, one.judged.told())
        if one.failure is not None:
            return one
    return None


def _tell(runs: Runs, found: RunResult, made: Replay, output: str) -> int:
    """Shrink a failure, print it, and write the file that runs it again; return the exit code."""
    assert found.failure is not None
    shrunk = found
    if found.chosen.seed == 0:
        _say(f'it fails in the stated order, without chaos: {found.failure.text}')
    else:
        _say(f'seed {found.chosen.seed} fails ({found.failure.name}) with {_counted(len(found.decisions))}; now as '
             'few as possible')
        before = runs.count
        shrunk = runs.shrunk(found)
        if shrunk.failure is None:
            raise ConfigurationError(f'the run of seed {found.chosen.seed} does not fail again: it is not repeatable; '
                                     f'`verify` says why. It failed: {found.failure.text}')
        _say(f'failed: {shrunk.failure.text}')
        _say(f'because of {_counted(len(shrunk.decisions))}, found in ' + _counted(runs.count - before, 'run') + ':')
    assert shrunk.failure is not None
    made.only = [decision['name'] for decision in shrunk.decisions]
    made.failure, made.text, made.sha256 = shrunk.failure.name, shrunk.failure.text, shrunk.digest
    made.happened = [_said(decision) for decision in shrunk.decisions]
    for line in made.happened:
        _say('  ' + line)
    replay_file.write(output, made)
    _say(f'run it again: rosrun move_base_abstract chaos --replay {output}')
    return FAILED


def _counted(count: int, what: str = 'decision') -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _said(decision: Dict[str, Any]) -> str:
    """Return a decision in words: "/b's message on /x reached /a before /c's message on /y, at 41.3 s"."""
    return f"{decision['says']}, at {decision['time_ns'] * 1e-9:.9g} s"


def _replay(options: argparse.Namespace) -> int:
    made = replay_file.read(options.replay)
    path, *arguments = made.launch
    if any(':=' not in word for word in arguments):
        raise ConfigurationError(f'{options.replay}: launch must be a file, then ARG:=VALUE')
    with Runs(document_of(path, arguments, dict(made.document)), os.getcwd(), 1, made.delay,
              [made.failure] if made.failure else []) as runs:
        told = runs.one(RunRequest(made.seed, tuple(made.only)))
    for line in made.happened:
        _say('  ' + line)
    if told.failure is None:
        _say(f'it does not fail any more: {made.text}')
        return OTHER
    _say(f'failed: {told.failure.text}')
    _say('the same bytes as before' if told.digest == made.sha256 else
         'not the same bytes as before: the programs, or what they read, have changed since')
    return FAILED


def _say(line: str) -> None:
    print(f'chaos: {line}', flush=True)
