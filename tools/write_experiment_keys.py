#!/usr/bin/python3
"""Write the table of keys into docs/experiments.md: each option of an experiment's file, from the code.

usage: python3 tools/write_experiment_keys.py [OUTPUT.md]     (default: docs/experiments.md)

`make lint` compares the page with the code. If you add an option, run this and tools/write_schema.py.
"""
import dataclasses
import os
import re
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir)
sys.path.insert(0, os.path.join(ROOT, 'src'))
PAGE = os.path.join(ROOT, 'docs', 'experiments.md')

from output_file import output_file  # noqa: E402

from move_base_abstract.common import kinds  # noqa: E402
from move_base_abstract_experiments.description.experiment import Experiment, in_words  # noqa: E402

HEAD = '| key | default | what |\n|---|---|---|\n'
TABLE = re.compile(re.escape(HEAD) + r'(\|.*\n)*')


def rows(cls, above=''):
    """Yield the rows of a dataclass's options; the options within an option follow it."""
    for key, one in kinds.options_of(cls).items():
        default = '' if one.default is None else str(one.default).lower() if isinstance(one.default, bool) else (
            f'`{one.default}`' if isinstance(one.default, (list, dict)) else one.default)
        only = f'. Of {in_words(one.systems)}' if one.systems and key not in one.systems else ''
        yield f'| `{above}{key}` | {default} | {one.says}{only} |\n'
        if dataclasses.is_dataclass(one.initial):
            yield from rows(one.initial, f'{above}{key}.')


def make_page():
    """Return the page's text with a new table."""
    with open(PAGE, encoding='utf-8') as stream:
        page, count = TABLE.subn(lambda _: HEAD + ''.join(rows(Experiment)), stream.read())
    if count != 1:
        raise SystemExit(f'{PAGE}: must have one table that begins with {HEAD!r}, got {count}')
    return page


if __name__ == '__main__':
    made = make_page()
    with open(output_file(os.path.join('docs', 'experiments.md'), __doc__), 'w', encoding='utf-8') as output:
        output.write(made)
