"""Count in how many seeds `chaos` finds the bug of each coordinator of test/.nodes/coordinators, by what is varied.

usage: chaos_faults.py [--seeds N] [COORDINATOR ...]    (in the built environment)

Each count goes into test/.nodes/coordinators/counted.json, from which tools/write_node_pages.py makes the table in
docs/measured.md. The twins without the bug run with the default seeds, and must not fail.
"""
import argparse
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent.parent / 'test' / '.nodes' / 'coordinators'
COUNTED = FOLDER / 'counted.json'
#: {column: the options of chaos}; `twin`: that of the coordinator without its bug
KINDS = {'order': ('--delay', '0'), 'delays': ('--delay', '0.05'), 'starts': ('--starts', '0.5'), 'default': (),
         'twin': ()}
_COUNTS = re.compile(r'chaos: (\d+) of (\d+) seeds? fails?\b')


def count(coordinator, kind, seeds):
    """Return (how many of the seeds fail, those) of a coordinator."""
    with tempfile.TemporaryDirectory() as folder:
        words = ['rosrun', 'move_base_abstract', 'chaos', '--count', '--seeds', f'1:{seeds}', '--until', '300',
                 '--output', os.path.join(folder, 'chaos.json'), *KINDS[kind], str(FOLDER / 'coordinators.launch'),
                 f'coordinator:={coordinator}', f'correct:={str(kind == "twin").lower()}']
        done = subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False)
    said = _COUNTS.search(done.stdout)
    if done.returncode not in (0, 1) or said is None or int(said.group(2)) != seeds or 'stated order, w' in done.stdout:
        raise SystemExit(f'{coordinator}, {kind}: exit code {done.returncode}\n{done.stdout}')
    return int(said.group(1))


def main():
    """Count, and write the file after each coordinator."""
    parser = argparse.ArgumentParser(description='Count in how many seeds chaos finds the bugs of the coordinators.')
    parser.add_argument('--seeds', type=int, default=50, metavar='N', help='seeds 1 to N (default: %(default)s)')
    known = list(json.loads((FOLDER / 'found.json').read_text(encoding='utf-8')))
    parser.add_argument('coordinators', nargs='*', metavar='COORDINATOR', help=f'by default all: {", ".join(known)}')
    options = parser.parse_args()
    for name in options.coordinators or known:
        counted = json.loads(COUNTED.read_text(encoding='utf-8')) if COUNTED.exists() else {}
        found = {'seeds': options.seeds, **{kind: count(name, kind, options.seeds) for kind in KINDS}}
        print(json.dumps({'kind': 'chaos_faults', 'coordinator': name, **found}), flush=True)
        counted[name] = found
        ordered = {one: counted[one] for one in known if one in counted}
        COUNTED.write_text(json.dumps(ordered, indent=1) + '\n', encoding='utf-8')


if __name__ == '__main__':
    main()
