"""Measure how fast the README's runs are on this machine, and write the ranges over all machines into the README.

usage: figures.py    (in the built environment; `make figures` does it)

docs/figures.json has one entry for each machine (CPU model and cores). A run replaces the entry of its own machine.
Measure on a machine that does nothing else; the entry has the load at the beginning.
"""
import datetime
import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FIGURES, README = ROOT / 'docs' / 'figures.json', ROOT / 'README.md'
#: {figure: (command, what its output says of speed and messages)}; each is measured RUNS times
MEASURED = {
    'demo': (('rosrun', 'move_base_abstract', 'demo'),
             re.compile(r'wall time: ([\d.]+)x real time, with ([\d.]+) messages')),
    'dense': (('python3', 'bench/dense', '--agents', '4', '--kinds', 'roscpp', '--rates', '20/10', '--simulated', '60',
               '--runs', '1'), re.compile(r'"speed_up": ([\d.]+).*"deliveries_per_s": ([\d.]+)'))}
RUNS = 9
#: where the README has a figure of speed; what is between the two comments is written by this program
PLACE = re.compile(r'(<!-- figure: (\w+) -->)(.*?)(<!-- end of figure -->)', re.DOTALL)
#: what a speed looks like: 12x, 12 times real time, thousands of times faster
SPEED = re.compile(r'\b\d[\d,.]*x\b|\b(?:\d[\d,.]*|tens|hundreds|thousands|millions)(?: to \d[\d,.]*)? ?(?:of )?times '
                   r'(?:real time|faster|as fast)', re.IGNORECASE)


class NotMeasured(Exception):
    """A command failed, or said nothing of its speed. The text has its output."""


def measure():
    """Run all commands on this machine and return its entry for the file.

    :raises NotMeasured: if one of them fails.
    """
    load = os.getloadavg()[0]
    commit = subprocess.run(['git', '-C', str(ROOT), 'describe', '--always', '--dirty', '--abbrev=12'],
                            stdout=subprocess.PIPE, check=True, text=True).stdout.strip()
    runs = {name: sorted(_one(*how) for _ in range(RUNS)) for name, how in MEASURED.items()}
    return {'cpu': _cpu(), 'cores': os.cpu_count(), 'load_before': round(load, 2), 'commit': commit,
            'date': datetime.datetime.now(datetime.timezone.utc).date().isoformat(),  # noqa: TID251
            'figures': {name: [speed for speed, _ in each] for name, each in runs.items()},
            'messages_per_s': {name: each[0][1] for name, each in runs.items()}}


def merged(machines, entry):
    """Return the entries with ``entry`` in the place of an earlier one of the same machine, in a stated order."""
    def which(one):
        return one['cpu'], one['cores']
    return sorted([one for one in machines if which(one) != which(entry)] + [entry], key=which)


def sentence(name, machines):
    """Return what the README says of a figure: its range, beside how many messages, from how many runs, and where."""
    runs = [value for machine in machines for value in machine['figures'][name]]
    on = '{} machines'.format(len(machines))
    if len(machines) == 1:
        on = 'one machine: {cpu}, {cores} cores, load {load_before:.0f}'.format(**machines[0])
    return '{:.0f} to {:.0f} times real time with {:.3g} messages per simulated second in {} runs on {}'.format(
        min(runs), max(runs), machines[0]['messages_per_s'][name], len(runs), on)


def written(readme, machines):
    """Return the README's text with all figures as ``machines`` have them."""
    return PLACE.sub(lambda place: place.group(1) + sentence(place.group(2), machines) + place.group(4), readme)


def read():
    """Return the entries of the file; an empty list if there is none."""
    return json.loads(FIGURES.read_text(encoding='utf-8'))['machines'] if FIGURES.exists() else []


def _one(command, said):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False, cwd=ROOT)
    found = said.search(done.stdout)
    if done.returncode or not found:
        raise NotMeasured('{} ended with {} and says no speed:\n{}'.format(
            ' '.join(command), done.returncode, done.stdout))
    return float(found.group(1)), float(found.group(2))


def _cpu():
    found = re.search(r'^model name\s*: (.*)$', Path('/proc/cpuinfo').read_text(encoding='utf-8'), re.MULTILINE)
    return found.group(1).strip() if found else os.uname().machine


def _replace(path, text):
    unfinished = path.with_name(path.name + '.unfinished')
    unfinished.write_text(text, encoding='utf-8')
    os.replace(str(unfinished), str(path))


def main():
    """Measure and write both files; return the exit code."""
    try:
        machines = merged(read(), measure())
    except NotMeasured as error:
        print('figures: {}'.format(error), file=sys.stderr)
        return 1
    what = {name: ' '.join(command) + ': simulated seconds per second of wall time'
            for name, (command, _) in MEASURED.items()}
    _replace(FIGURES, json.dumps({'what': what, 'machines': machines}, indent=1) + '\n')
    _replace(README, written(README.read_text(encoding='utf-8'), machines))
    for name in MEASURED:
        print('{}: {}'.format(name, sentence(name, machines)))
    return 0


if __name__ == '__main__':
    sys.exit(main())
