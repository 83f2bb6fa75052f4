"""The command line: rosrun move_base_abstract chaos."""
from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Optional, Sequence, Tuple

from move_base_abstract.common import temporary
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import list_of, number, similar, text
from move_base_abstract.common.options import given, of_arguments, option, word_of, words_of
from move_base_abstract.common.shown import pasted, shown
from move_base_abstract.lockstep import replay_file
from move_base_abstract.lockstep.replay_file import Replay
from move_base_abstract.lockstep.run_options import LARGEST_CHAOS_SEED, RunOptions
from move_base_abstract.properties import Gathering
from move_base_abstract.runs.built_in import ALL, BUILT_IN

from .. import ending
from . import counting, failures
from .counting import Count
from .runs import RunRequest, RunResult, Runs, document_of
from .variation import DELAY_S, STARTS_S, Variation

GOOD, FAILED, OTHER = 0, 1, 3
_OUTPUT = 'chaos.json'
_COUNT = word_of(number(1, 1024, whole=True))
_BOUND = word_of(number(0.0, 1000.0, unit='s, simulated'))
_SEED = word_of(number(1, LARGEST_CHAOS_SEED, whole=True))
#: RunOptions that mean nothing here
_REFUSED = {**dict.fromkeys(('chaos_seed', 'chaos_delay', 'chaos_starts', 'chaos_only'),
                            '--seeds, --delay and --starts say what is tried'),
            'lookahead': 'with a lookahead no events are equal'}
#: {name of a property: the beginning of the names of the failures that it is here}
_FAILURES = {'no_crash': 'crash', 'no_exception': 'crash', 'no_zero_delay_loop': 'zero_delay_loop'}
#: the words with which the names of all failures begin, but for those of statements
_KNOWN = (ALL, *failures.NAMES, *BUILT_IN)


@dataclass(frozen=True)
class _Options(RunOptions):
    """The options of the runs of a search."""

    properties: Tuple[str, ...] = option(
        list_of(text()), [], 'the search looks only for these failures: {}, other [properties](properties.md), or '
        'texts of your own'.format(', '.join(map('`{}`'.format, failures.NAMES))), flag='property', was='properties',
        metavar='NAME')


def main(words: Sequence[str]) -> int:
    """Run the command with these arguments; return the exit code, which the epilog of --help explains."""
    parser, options = _parse(words)
    def run() -> int:
        if not options.replay:
            return _search(parser, options)
        made = replay_file.read(options.replay)
        if any(':=' not in word for word in made.launch[1:]):
            raise ConfigurationError(f'{options.replay}: launch must be a file, then ARG:=VALUE')
        return _count_again(options, made) if options.count else _replay(made)
    return ending.exit_code('chaos', run)


def _parse(words: Sequence[str]) -> Tuple[argparse.ArgumentParser, argparse.Namespace]:
    from move_base_abstract_ros.launching import command_line
    parser = argparse.ArgumentParser(
        prog='chaos', usage=command_line.USAGE + '\n       %(prog)s [--count] --replay FILE',
        description='Run a launch file with other legal orders, delays and late starts, until something fails.',
        epilog='exit codes: 0 nothing failed, 1 something failed (with --replay: it fails again), 2 the file cannot be '
        'run like this, 3 (with --replay) it does not fail any more, 130 interrupted')
    parser.add_argument('--seeds', type=_seeds, default=(1, 100), metavar='FIRST:LAST', help='seeds to try '
                        '(default: 1:100)')
    parser.add_argument('--delay', type=_BOUND, metavar='S', help='in all seeds messages take up to S simulated '
                        f'seconds (default: {DELAY_S:g} in even seeds, 0 in odd ones; 0 with --starts)')
    parser.add_argument('--starts', type=_BOUND, metavar='S', help='in all seeds nodes start up to S simulated seconds '
                        f'late, and their connections are up to S/10 late (default: {STARTS_S:g} in even seeds, 0 in '
                        'odd ones; 0 with --delay)')
    parser.add_argument('--count', action='store_true', help='try all seeds, and say how many fail; with --replay: try '
                        'them again, and compare')
    parser.add_argument('--workers', type=_COUNT, default=os.cpu_count() or 1, metavar='N',
                        help='runs at the same time (default: one per core)')
    parser.add_argument('--output', default=_OUTPUT, metavar='FILE', help='file that replays the failure '
                        '(default: %(default)s)')
    parser.add_argument('--replay', metavar='FILE', help='run a failure again, and say whether it is the same')
    command_line.add_run(parser, _Options, _REFUSED)
    options = parser.parse_intermixed_args(words)
    options.asked = of_arguments(_Options, parser, options)
    besides = words_of(options.asked) + Variation(options.delay, options.starts).words() + options.command
    if options.replay and besides:
        parser.error(f'--replay: the file says what is run; got also {" ".join(besides)}')
    return parser, options


def _seeds(text: str) -> Tuple[int, int]:
    first, colon, last = text.partition(':')
    low, high = _SEED(first), _SEED(last if colon else first)
    if low > high:
        raise argparse.ArgumentTypeError(f'got {text}; allowed: FIRST:LAST, the smaller one first')
    return low, high


def _search(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    from move_base_abstract_ros.launching import command_line
    (path, arguments), = command_line.files_of(parser, options.command)
    judged, wanted = _wanted(options.asked.properties)
    more = {**given(_Options, options), 'properties': [ALL, *judged]}
    count = Count(options.seeds, options.delay, options.starts, wanted)
    with _runs(path, arguments, more, options.workers, count) as runs:
        if options.asked.adopt:
            _say(command_line.of_adopted(options.asked, options.command))
        found = _tried(runs, count, options.count)
        if options.count:
            _say(count.said())
        if found is None:
            first, last = count.seeds
            _say(f'nothing failed in the stated order and with the seeds {first} to {last}')
            if last < LARGEST_CHAOS_SEED:
                further = f'{last + 1}:{min(2 * last - first + 1, LARGEST_CHAOS_SEED)}'
                _say('next: more seeds: ' + command_line.typed(
                    'chaos', ['--seeds', further, *_changed(options)], options.asked, options.command))
            _say(f'the seeds varied {runs.variation.said(count.seeds)}')
            return GOOD
        bounds = runs.variation.of(found.chosen.seed)
        made = Replay([path, *arguments], found.chosen.seed, bounds.delay, [], '', '', more, starts=bounds.starts,
                      count=vars(count) if options.count else {})
        return _tell(runs, found, made, options.output)


def _runs(path: str, arguments: Sequence[str], more: Dict[str, Any], workers: int, count: Count) -> Runs:
    return Runs(document_of(path, arguments, more), os.getcwd(), workers, count.variation, count.wanted)


def _tried(runs: Runs, count: Count, is_all: bool) -> Optional[RunResult]:
    """Try the stated order, seed 0, and the seeds of ``count``, up to the first that fails, or all; say what was seen.

    Return the first that fails, or None. The failing seeds are added to ``count``.

    :raises ConfigurationError: if none fails, and a text that is looked for was stated in no run.
    """
    begin = time.monotonic()
    first, last = count.seeds
    # The stated order comes first. If it fails, no chaos is needed.
    told = runs.each([RunRequest(0), *map(RunRequest, range(first, last + 1))])
    found: Optional[RunResult] = None
    stated: Dict[str, None] = {}
    gathered = Gathering()
    for one in told:
        if one.judged is not None:
            gathered.take(f'seed {one.chosen.seed}', one.chosen.seed, one.judged.told())
            stated.update(dict.fromkeys(key[-1] for key in one.judged.statements))
        if one.failure is not None:
            found = found or one
            if one.chosen.seed:
                count.failed[one.chosen.seed] = one.failure.name
            if not is_all:
                break
    told.close()
    passed = time.monotonic() - begin
    _say(f"{_counted(runs.count, 'run')} in {passed:.1f} s of wall time, {60 * runs.count / passed:.0f} a minute")
    for (node, what), (said, held) in gathered.sometimes.items():
        _say(f"sometimes: {node}: {what}: came true in {held or 'none'} of the {_counted(said, 'run')} that say it")
    if found is None:
        _check_stated(count.wanted, list(stated), runs.count)
    return found


def _check_stated(wanted: Sequence[str], stated: Sequence[str], runs: int) -> None:
    for name in wanted:
        if name.partition(' ')[0] not in _KNOWN and not any(failures.is_meant(one, name) for one in stated):
            raise ConfigurationError(
                f'{shown(name)}: no failure has this name, and no node stated this text in the '
                f'{_counted(runs, "run")}; stated were: {", ".join(map(shown, stated)) or "none"}')


def _wanted(properties: Sequence[str]) -> Tuple[List[str], List[str]]:
    """Return (the built-in properties among those that are asked for, the names of the failures that count; []: all).

    Say which are taken for statements of nodes, whose texts nobody knows before they are made.
    """
    judged = [word for word in properties if word.partition('=')[0] in BUILT_IN]  # some take a number
    names = [word.partition('=')[0] if word in judged else word for word in properties]
    for name in names:
        if name.partition(' ')[0] not in _KNOWN:
            _say(f'{shown(name)} is taken for the text of a statement of your own{similar(name, _KNOWN)}')
    return judged, [] if ALL in names else [_FAILURES.get(name, name) for name in names]


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
    made.happened = [replay_file.said(decision) for decision in shrunk.decisions]
    made.debug = made.debug_command(shrunk.failure.instant_ns)
    for line in made.happened:
        _say('  ' + line)
    replay_file.write(output, made)
    _say(f'run it again: rosrun move_base_abstract chaos --replay {pasted(output)}')
    _say(f'before that, in the debugger: {made.debug}')
    if made.count:
        _say(f'after a repair, count again: rosrun move_base_abstract chaos --count --replay {pasted(output)}')
    return FAILED


def _changed(options: argparse.Namespace) -> List[str]:
    """Return the words of the options of the search, besides its seeds, that are not their defaults."""
    return [*Variation(options.delay, options.starts).words(), *(['--count'] if options.count else []), *(
        word for name, default in (('workers', os.cpu_count() or 1), ('output', _OUTPUT))
        for value in [getattr(options, name)] if value != default for word in (f'--{name}', str(value)))]


def _counted(count: int, what: str = 'decision') -> str:
    return f"{count} {what}{'s' * (count != 1)}"


def _replay(made: Replay) -> int:
    if made.test:
        return _replay_test(made)
    path, *arguments = made.launch
    with Runs(document_of(path, arguments, made.document), os.getcwd(), 1, Variation(made.delay, made.starts),
              [made.failure] if made.failure else []) as runs:
        told = runs.one(RunRequest(made.seed, tuple(made.only)))
    for line in made.happened:
        _say('  ' + line)
    code = _compared(made, None if told.failure is None else told.failure.text, told.digest)
    if told.failure is not None:
        _say(f'before that, in the debugger: {made.debug_command(told.failure.instant_ns)}')
    return code


def _count_again(options: argparse.Namespace, made: Replay) -> int:
    """Try the seeds of a count again, and compare; return the exit code."""
    before = counting.of_file(options.replay, made.count)
    now = replace(before, failed={})
    path, *arguments = made.launch
    with _runs(path, arguments, made.document, options.workers, now) as runs:
        found = _tried(runs, now, True)
    if found is not None and not found.chosen.seed:
        assert found.failure is not None
        _say(f'it fails in the stated order, without chaos: {found.failure.text}')
    for line in now.compared(before):
        _say(line)
    return OTHER if found is None else FAILED


def _replay_test(made: Replay) -> int:
    """Run a test of pytest again, and compare its failure; return the exit code."""
    folder, name = made.test
    with temporary.folder('chaos_') as own:
        path = os.path.join(own, 'chaos.json')
        try:
            code = subprocess.run(
                [sys.executable, '-m', 'pytest', '-p', 'move_base_abstract_testing', name], cwd=folder, check=False,
                env={**os.environ, replay_file.VARIABLE: path}).returncode
        except OSError as error:
            raise ConfigurationError(f'test: {folder}: {error.strerror}') from None
        again = replay_file.read(path) if os.path.exists(path) else None
    for line in made.happened:
        _say('  ' + line)
    if code and again is None:
        raise ConfigurationError(f'the test {name} did not run to its end: pytest ended with exit code {code}')
    return _compared(made, None if again is None else again.text, again.sha256 if again is not None else '')


def _compared(made: Replay, failure: Optional[str], digest: str) -> int:
    """Say how a run that was made again has ended; return the exit code. ``failure``: its text, or None."""
    if failure is None:
        _say(f'it does not fail any more: {made.text}')
        return OTHER
    _say(f'failed: {failure}')
    _say('the same bytes as before' if digest == made.sha256 else
         'not the same bytes as before: the programs, or what they read, have changed since')
    return FAILED


def _say(line: str) -> None:
    print(f'chaos: {line}', flush=True)
