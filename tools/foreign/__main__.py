"""Run public systems, unchanged, under five conditions each, and print the table of docs/compatibility.md.

    python3 tools/foreign [--fetch] [--conditions A,B] [--sources FOLDER] [--table FILE] [--time-limit S] [NAME ...]

Run it in the built environment. The table of systems (.systems/systems.yaml) says of each system which commit
of which repository it is, which ROS packages must be found, and what is run. --fetch brings the commits into the folder
of sources. Nothing is built: programs in C++ and messages are built in a catkin workspace of the user's, which is
sourced before. A system that is not here, or is another commit, or is changed, is left out, and a line says why.

Exit codes: 0 what was run is as it says of itself; 1 a system differs although it was called repeatable, or has not
come to its end; 2 the arguments, or the table, cannot be used.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import rospkg
import yaml

HERE = Path(__file__).resolve().parent
OWN = HERE / '.systems'  # a ROS package; completion of roslaunch and rosrun does not look into a folder with a dot
ROOT = HERE.parent.parent
sys.path.insert(0, str(ROOT / 'bench'))

import launched  # noqa: E402

from move_base_abstract.common.options import POSITIVE  # noqa: E402
from move_base_abstract.runs.event_log import labels_of  # noqa: E402
from move_base_abstract_ros.launching import conditions  # noqa: E402

SERVER = 'https://github.com/'
CANNOT = 2  # exit code of lockstep_launch
NEVER = 'so that time never starts'  # it says of a program that cannot be run as it is
GIT_S = 300.0  # wall; only ends what would never end
ONE_CORE = conditions.Condition('one core', 'all on one core', '')
#: those of `verify` that concern the machine, and one of our own; each run has a working folder of another name
CONDITIONS = (*(one for one in conditions.CONDITIONS if one.name in ('plain', 'busy', 'delays', 'addresses')), ONE_CORE)
NAMES = tuple(one.name for one in CONDITIONS)
HEAD = ('| system | what was run | robots | simulated | events and messages | result |',
        '|---|---|---|---|---|---|')


class Unfit(Exception):
    """A system cannot be run here; the text says why."""


@dataclass(frozen=True)
class System:
    """A row of the table of systems.

    :param commits: {'owner/name': commit} of its repositories.
    :param packages: ROS packages that must be found, and lie in these repositories.
    :param launch: the launch file, beside the table, or 'PACKAGE FILE', and its arguments. options: of lockstep_launch.
    """

    name: str
    commits: dict
    packages: list
    ran: str
    robots: str
    launch: str
    options: list = field(default_factory=list)

    def words(self, folder):
        """Return the words for lockstep_launch. ``folder``: that of the table."""
        file, *arguments = self.launch.split()
        own = folder / file
        return ['--log-messages', '--crashes', 'allow', *self.options, str(own) if own.exists() else file, *arguments]

    @property
    def title(self):
        """The system as a link, with its commit, for a page."""
        name, commit = next(iter(self.commits.items()))
        return f'[{self.name}]({SERVER}{name}) `{commit[:7]}`'


class Outcome(NamedTuple):
    """How one run ended. ``run``: a launched.Run, or None, and ``error`` says why."""

    condition: str
    run: object = None
    error: str = ''

    @property
    def key(self):
        """What must be equal in all runs."""
        return self.error or (self.run.digest, self.run.crashes)

    @property
    def labels(self):
        """Why the run is not called repeatable."""
        return labels_of(self.run.end) if self.run else []

    @property
    def is_repeatable(self):
        """Whether the run said that another one would be the same."""
        return self.run is not None and not self.labels


def verdict(outcomes):
    """Return (the words for the table, whether each run came to its end and is what it said of itself)."""
    first, names = outcomes[0], ', '.join(one.condition for one in outcomes)
    others = [one for one in outcomes if one.key != first.key]
    said = [*dict.fromkeys(label for one in outcomes for label in one.labels)]
    word = f'labelled ({"; ".join(said)})' if said else 'repeatable'
    crashes = ''.join(f'; but {crash}' for crash in (first.run.crashes if first.run else ()))
    if not others:
        return f'{first.error} ({names})' if first.error else f'{word}: the same bytes ({names}){crashes}', (
            not first.error)
    how = f'not like {first.condition}: ' + ', '.join(f'{one.condition} ({one.error or "other bytes"})'
                                                      for one in others) + crashes
    is_false = any(one.is_repeatable for one in outcomes)
    return (f'FALSE: called repeatable, but {how}' if is_false else f'{word}: {how}'), (
        not is_false and not any(one.error for one in outcomes))


def run(system, folder, chosen, time_limit):
    """Run a system under each of these conditions; return the outcomes. Raises Unfit if it cannot be run here."""
    outcomes = []
    for condition in (one for one in CONDITIONS if one.name in chosen):
        with _under(condition):
            try:
                outcome = Outcome(condition.name, launched.launch([*condition.options, *system.words(folder)],
                                                                  time_limit))
            except launched.Failed as error:
                said = str(error).strip().splitlines()
                never = [line for line in said if NEVER in line]
                if error.code == CANNOT or never:
                    raise Unfit(f'it cannot be run: {(never or said[-1:])[0]}') from None
                outcome = Outcome(condition.name, error=error.why)
                print(error, file=sys.stderr)
        outcomes.append(outcome)
        print(f'foreign: {system.name}: {condition.name}: {outcome.error or _told(outcome.run)}', file=sys.stderr,
              flush=True)
    return outcomes


def _told(done):
    return (f'{done.end["events"]} events and messages, {done.simulated_s:.3f} s simulated in {done.run_s:.1f} s, '
            f'sha256 {done.digest[:12]}')


@contextmanager
def _under(condition):
    """Make the machine as the condition says, in an empty working folder, and put all back afterwards."""
    before, cores, place = dict(os.environ), os.sched_getaffinity(0), os.getcwd()
    with tempfile.TemporaryDirectory(prefix='foreign_') as folder, (
            conditions.busy() if condition.is_busy else nullcontext()):
        try:
            os.environ.update(dict(condition.environment), ROS_HOME=folder)
            if condition is ONE_CORE:
                os.sched_setaffinity(0, {min(cores)})
            os.chdir(folder)
            yield
        finally:
            os.chdir(place)
            os.sched_setaffinity(0, cores)
            os.environ.clear()
            os.environ.update(before)


def look_at(system):
    """Raise Unfit if the system is not here, as its authors have published it."""
    places = rospkg.RosPack()
    for package in system.packages:
        try:
            path = places.get_path(package)
        except rospkg.ResourceNotFound:
            raise Unfit(f'the package {package} is not here: {_where(system)}') from None
        commit = _git(path, 'rev-parse', 'HEAD').stdout.strip()
        if commit not in system.commits.values():
            raise Unfit(f'{path} is {f"at commit {commit}" if commit else "in no git repository"}: {_where(system)}')
        changed = _git(path, '-c', 'core.fileMode=false', 'status', '--porcelain', '--untracked-files=no', '.').stdout
        if changed:
            raise Unfit(f'{path} is not as published: {changed.splitlines()[0].strip()}')


def _where(system):
    return 'wanted: ' + ', '.join(f'{SERVER}{name} at commit {commit}' for name, commit in system.commits.items())


def fetch(system, sources):
    """Bring the commits of a system into folders of these sources, if they are not there. Raises Unfit."""
    for name, commit in system.commits.items():
        place = sources / name.partition('/')[2]
        if place.exists():
            continue
        sources.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=sources, prefix='.fetched_') as folder:
            for words in (('init', '-q'), ('fetch', '-q', '--depth', '1', SERVER + name, commit),
                          ('checkout', '-q', commit)):
                done = _git(folder, *words)
                if done.returncode:
                    said = done.stderr.strip().splitlines()
                    raise Unfit(f'{SERVER}{name} at commit {commit} cannot be fetched: {said[0] if said else words}')
            os.rename(folder, place)
            os.mkdir(folder)  # for the TemporaryDirectory to remove


def _git(folder, *words):
    """Run git in a folder; return what has ended. It asks nobody for a password."""
    try:
        return subprocess.run(['git', '-C', str(folder), *words], check=False, timeout=GIT_S, text=True,
                              env={**os.environ, 'GIT_TERMINAL_PROMPT': '0'}, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(words, 1, '', f'not over after {GIT_S:g} s')


def read(path):
    """Return the systems of a table, {name: System}. Raises ValueError with the file and what is wrong."""
    try:
        systems = {row['name']: System(**row) for row in yaml.safe_load(path.read_text(encoding='utf-8'))}
    except (OSError, TypeError, KeyError, yaml.YAMLError) as error:
        raise ValueError(f'{path}: is no table of systems: {error}') from None
    for system in systems.values():
        for name, commit in system.commits.items():
            if not re.fullmatch('[0-9a-f]{40}', commit):
                raise ValueError(f'{path}: {system.name}: the commit of {name} must have 40 hexadecimal digits, got '
                                 f'{commit!r}')
    return systems


def _row(system, outcomes, words):
    done = next((one.run for one in outcomes if one.run), None)
    seen = ('', '') if done is None else (f'{done.simulated_s:.0f} s', str(done.end['events']))
    return '| ' + ' | '.join((system.title, system.ran, str(system.robots), *seen, words.replace('|', '\\|'))) + ' |'


def _parse():
    parser = argparse.ArgumentParser(prog='tools/foreign', description=__doc__.split('\n\n', maxsplit=1)[0])
    parser.add_argument('names', nargs='*', metavar='NAME', help='run only these systems (default: all of the table)')
    parser.add_argument('--fetch', action='store_true', help='fetch what is not in the folder of sources yet')
    parser.add_argument('--conditions', type=lambda text: text.split(','), metavar='A,B', default=NAMES,
                        help='run only under these conditions: ' + ', '.join(NAMES))
    parser.add_argument('--table', type=Path, default=OWN / 'systems.yaml', metavar='FILE',
                        help='the table of systems (default: %(default)s)')
    parser.add_argument('--sources', type=Path, default=ROOT / '.ws' / 'foreign', metavar='FOLDER', help='where '
                        'fetched systems lie; packages are looked for there after ROS_PACKAGE_PATH (default: '
                        '%(default)s)')
    parser.add_argument('--time-limit', type=POSITIVE, default=600.0, metavar='S',
                        help='time that a run may take [s, wall] (default: %(default)g)')
    options = parser.parse_args()
    try:
        systems = read(options.table)
    except ValueError as error:
        parser.error(str(error))
    for what, named, allowed in (('system', options.names, systems), ('condition', options.conditions, NAMES)):
        for name in named:
            if name not in allowed:
                parser.error(f'there is no {what} {name!r}; allowed: {", ".join(allowed)}')
    return options, [systems[name] for name in options.names or systems]


def main():
    """Run the systems, print the table on standard output and all else on standard error, exit with the code."""
    options, systems = _parse()
    sources = options.sources.resolve()
    os.environ['ROS_PACKAGE_PATH'] = os.pathsep.join([os.environ.get('ROS_PACKAGE_PATH', ''), str(OWN), str(sources)])
    rows, left_out, is_good = [], [], True
    for system in systems:
        try:
            if options.fetch:
                fetch(system, sources)
            look_at(system)
            outcomes = run(system, options.table.resolve().parent, options.conditions, options.time_limit)
        except Unfit as error:
            left_out.append(f'foreign: {system.name}: left out: {error}')
            continue
        words, is_true = verdict(outcomes)
        is_good = is_good and is_true
        if not is_true:
            print('foreign: next: ROS_PACKAGE_PATH={} rosrun move_base_abstract verify {}'.format(
                os.environ['ROS_PACKAGE_PATH'], ' '.join(system.words(options.table.resolve().parent)[1:])),
                  file=sys.stderr)
        rows.append(_row(system, outcomes, words))
    print('\n'.join((*HEAD, *rows)), flush=True)
    print('\n'.join((*left_out, f'foreign: {len(rows)} systems were run, {len(left_out)} were left out')),
          file=sys.stderr)
    sys.exit(not is_good)


if __name__ == '__main__':
    main()
