#!/usr/bin/python3
"""Write the tables of options into pages of docs/: of a run, of one run, of an experiment, of a test.

usage: python3 tools/write_options.py

`make lint` compares the pages with the code. If you add an option, run this and tools/write_schema.py.
"""
import dataclasses
import os
import re
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir)
sys.path.insert(0, os.path.join(ROOT, 'src'))
DOCS = os.path.join(ROOT, 'docs')

from move_base_abstract.common import options  # noqa: E402
from move_base_abstract.lockstep.run_options import RunOptions  # noqa: E402
from move_base_abstract_experiments.description.experiment import Experiment  # noqa: E402
from move_base_abstract_ros.launching.command_line import OneRun  # noqa: E402
from move_base_abstract_testing.settings import Settings  # noqa: E402

#: {page: {head of a table: the class of its options}}
TABLES = {
    'lockstep_launch.md': {'| option of a run | key | default | what |': RunOptions,
                           '| option of `lockstep_launch` | default | what |': OneRun},
    'experiments.md': {'| key | default | for | what |': Experiment},
    'testing.md': {'| keyword | default | what |': Settings}}


def rows(head, cls, above=''):
    """Yield the rows of a class's own options; the options within an option follow it."""
    for key, one in options.options_of(cls).items():
        if cls is not RunOptions and one == options.options_of(RunOptions).get(key):
            continue
        default = '' if one.default is None else str(one.default).lower() if isinstance(one.default, bool) else (
            f'`{one.default}`' if isinstance(one.default, (list, dict)) else str(one.default))
        cells = {'option': '`{}`'.format(one.word + ('' if one.is_switch else ' ' + _form(one))),
                 'key': f'`{above}{key}`', 'default': default, 'what': one.says,
                 'for': ', '.join(one.systems) or 'all'}
        yield '| {} |\n'.format(' | '.join(cells[_column(name)] for name in head.strip('| ').split(' | ')))
        if dataclasses.is_dataclass(one.initial):
            yield from rows(head, type(one.initial), f'{above}{key}.')


def _column(name):
    return 'option' if name.startswith('option') else 'key' if name.startswith('key') else name


def _form(one):
    choices = one.kind.schema.get('enum')
    return ' or '.join(choices) if choices else one.metavar


def make_page(name):
    """Return a page's text with new tables."""
    with open(os.path.join(DOCS, name), encoding='utf-8') as stream:
        page = stream.read()
    for head, cls in TABLES[name].items():
        begin = head + '\n' + '|---' * head.count(' | ') + '|---|\n'
        before, found, after = page.partition(begin)
        if not found:
            raise SystemExit(f'{name}: must have a table that begins with {head!r}')
        page = before + begin + ''.join(rows(head, cls)) + re.sub(r'\A(\|.*\n)*', '', after)
    return page


if __name__ == '__main__':
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    for page in TABLES:
        made = make_page(page)
        with open(os.path.join(DOCS, page), 'w', encoding='utf-8') as output:
            output.write(made)
