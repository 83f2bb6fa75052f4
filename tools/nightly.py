"""What `make nightly` adds to a run of the tests: many runs of each scenario, turns, parts, and a table at the end."""
import json
import os
import subprocess
import time
from datetime import datetime, timezone

import test_steps
from test_steps import ROOT, WS

STATE = WS / 'nightly.json'  # of each step: when it was last run, how it ended, its scenarios
HOUR_S = 3600.0


def add_arguments(parser):
    """Add the options of the night to a parser."""
    parser.add_argument('--night', type=int, default=0, metavar='RUNS', help='run each scenario so often, and all that '
                        'the day leaves out')
    parser.add_argument('--part', default='1/1', metavar='K/N', help='of the night, run the K-th of N parts')
    parser.add_argument('--hours', type=float, default=3.0, metavar='H', help='begin no step of the night after this '
                        'time (default: %(default)s); those that were run longest ago come first')


class Night:
    """One night: which steps are run, in which order, and what is known of them afterwards."""

    def __init__(self, arguments, parser):
        """Choose the steps. Errors in the arguments go to the parser."""
        try:
            part, parts = map(int, arguments.part.split('/'))
        except ValueError:
            part = parts = 0
        if not 1 <= part <= parts:
            parser.error(f'--part: got {arguments.part!r}; allowed: K/N with K from 1 to N, such as 3/16')
        if not arguments.night > 0:
            parser.error(f'--night must be at least 1, got {arguments.night}')
        self.steps = test_steps.by_night()[part - 1::parts]
        self._runs = arguments.night
        self._end = time.monotonic() + arguments.hours * HOUR_S
        self._left_out = 0
        self._state = _read_state()
        self._scenarios = None  # path of what the tests note

    def begin(self, steps, results):
        """Prepare the environment of the tests; return the steps, those first that were run longest ago."""
        self._scenarios = results / 'scenarios.jsonl'
        os.environ.update(NIGHT=str(self._runs), SCENARIOS=str(self._scenarios))
        return sorted(steps, key=lambda step: self._state.get(step.name, {}).get('at', ''))

    def may_begin(self):
        """Return whether there is time for one more step."""
        is_early = time.monotonic() < self._end
        self._left_out += not is_early
        return is_early

    def conclude(self, done):
        """Note what was done, and print the tables."""
        now, commit = datetime.now(timezone.utc).strftime('%Y-%m-%d %H:%M'), _commit()  # noqa: TID251
        noted = _noted(self._scenarios)
        for step, _cpu, seconds, has_passed in done:
            own = {name: rows for name, rows in noted.items() if name.partition(': ')[0] == step.name}
            self._state[step.name] = {'at': now, 'commit': commit, 'seconds': round(seconds, 1), 'passed': has_passed,
                                      'scenarios': {name: _summary(rows) for name, rows in own.items()}}
        temporary = STATE.with_suffix('.part')
        temporary.write_text(json.dumps(self._state, indent=1))
        temporary.rename(STATE)
        print('\n' + table(self._state, [step.name for step in test_steps.by_night()]))
        if self._left_out:
            print(f'{self._left_out} steps were left out, since the time was over: the next night begins with them')


def table(state, names):
    """Return what is known of the steps of the night, as text: each step, and each scenario."""
    lines = [f'{"step of the night":<40} {"last run (UTC)":<17} {"commit":<9} {"s":>7}  end']
    for name in names:
        one = state.get(name)
        lines.append(f'{name:<40} ' + (f'{one["at"]:<17} {one["commit"]:<9} {one["seconds"]:7.1f}  '
                                       f'{"passed" if one["passed"] else "FAILED"}' if one else 'never'))
    lines += ['', f'{"scenario":<72} {"runs":>4}  {"equal":<7} {"slowest":>9}  under']
    for name in names:
        for scenario, found in sorted(state.get(name, {}).get('scenarios', {}).items()):
            end = 'equal' if found['equal'] else 'DIFFERS'
            lines.append(f'{_short(scenario, 72):<72} {found["runs"]:4d}  {end:<7} {found["slowest_s"]:7.1f} s  '
                         f'{found["slowest"]}')
    return '\n'.join(lines)


def _short(text, length):
    return text if len(text) <= length else text[:length - 3] + '...'


def _noted(path):
    """Return what the tests have noted of their scenarios, {name: [row, ...]}."""
    found = {}
    if path.exists():
        for line in path.read_text(encoding='utf-8').splitlines():
            row = json.loads(line)
            found.setdefault(row['scenario'], []).append(row)
    return found


def _summary(rows):
    slowest = max(rows, key=lambda row: row['seconds'])
    return {'runs': len(rows), 'equal': all(row['equal'] for row in rows), 'slowest_s': slowest['seconds'],
            'slowest': slowest['condition']}


def _read_state():
    try:
        return json.loads(STATE.read_text())
    except (OSError, ValueError):
        return {}


def _commit():
    done = subprocess.run(['git', 'rev-parse', '--short=8', 'HEAD'], cwd=ROOT, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=False)
    return done.stdout.strip() or '-'
