#!/usr/bin/python3
"""Write docs/scenario_keys.md: each key of a scenario file, from the tables of the code.

usage: python3 tools/write_scenario_keys.py [OUTPUT.md]     (default: docs/scenario_keys.md)

`make lint` compares the page with the tables. If you add a key, add a row for it to a page of the docs, then run this.
"""
import os
import re
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir)
sys.path.insert(0, os.path.join(ROOT, 'src'))
DOCS, PAGE = os.path.join(ROOT, 'docs'), 'scenario_keys.md'

from output_file import output_file  # noqa: E402
from write_node_pages import UNIT, shown  # noqa: E402

from move_base_abstract import scenario  # noqa: E402
from move_base_abstract.common.parameter_table import Parameter  # noqa: E402
from move_base_abstract.config import robot_table  # noqa: E402
from move_base_abstract.orders import (  # noqa: E402
    order,
    order_arrivals,
    settings as dispatch_settings,  # noqa: E402
)
from move_base_abstract.tasks import arrivals, places  # noqa: E402
from move_base_abstract.traffic import rules, zones  # noqa: E402

HEAD = """# All keys of a scenario

One table for each part of a [scenario file](fleet.md#scenario-files). Units are SI unless a row says otherwise;
positions and headings are in the global frame. The last column leads to the page that says what the key does.
This page is written by `tools/write_scenario_keys.py`; a test holds it to the code.
"""
#: {key: (default, allowed)} of keys that no table of the code has
TEXTS = {
    'defaults': ('', 'a mapping of settings of every robot'), 'robots': ('', 'a list of robots'),
    'zones': ('', 'a list of zones'), 'places': ('', 'a list of places'), 'arrivals': ('', 'a list of arrivals'),
    'orders': ('', 'a list of entries'), 'dispatcher': ('', 'a mapping'),
    'lanes': ('', 'the path of a file'), 'travel_matrix': ('', 'the path of a file'),
    'recovery_behaviors': ("upstream's four", 'a list of {name, type}'),
    'footprint': ('none', 'a list of 3 to 1000 points [x, y] [m, base frame]'),
    'robot_radius': ('0.46', 'a finite number >= 0 [m]'),
    'step_x': ('0', scenario._STEP.allowed), 'step_y': ('0', scenario._STEP.allowed),
}


def row(parameter, page):
    """Return the row of a Parameter that ``page`` describes."""
    units = UNIT.findall(parameter.allowed)
    return '| `{}` | {} | {} | {} | [{}]({}) |'.format(
        parameter.name, units[-1] if units else '', shown(parameter.default), UNIT.sub('', parameter.allowed),
        page[:-3].rpartition('/')[2].replace('_', ' '), page)


def as_parameters(names, known):
    """Return the Parameters with these ``names``, from ``known`` or from TEXTS."""
    found = {parameter.name: parameter for parameter in known}
    lost = [name for name in names if name not in found and name not in TEXTS]
    if lost:
        raise SystemExit('{}: no known table of the code has this key: add it to TEXTS'.format(lost[0]))
    return [found.get(name) or Parameter(name, TEXTS[name][0], None, allowed=TEXTS[name][1]) for name in names]


def sections():
    """Return [(heading, Parameters, pages that are searched first)]."""
    of_robot = robot_table.TABLE + robot_table.LIMITS
    return [
        ('Top level', as_parameters(scenario._TOP_KEYS, [scenario._SEED, *rules.TABLE, scenario._ENCOUNTERS]),
         ('orders.md', 'encounters.md', 'tasks.md', 'zones.md', 'lanes.md', 'fleet.md')),
        ('A robot', as_parameters(scenario._GROUP_KEYS, [places.NAME, scenario._COUNT]), ('fleet.md',)),
        ('Settings: of `defaults` or of a robot', as_parameters(robot_table.OWN_NAMES, of_robot),
         ('durations.md', 'failures.md', 'battery.md', 'routes.md', 'lanes.md', 'laser_scan.md', 'nodes/move_base.md')),
        ('A zone', list(zones.TABLE), ('zones.md',)),
        ('A place', list(places.PLACE_TABLE), ('tasks.md',)),
        ('Arrivals', list(arrivals.ARRIVAL_TABLE), ('tasks.md',)),
        ('A file of tasks', list(arrivals._ROW), ('tasks.md',)),
        ('Orders', list(order_arrivals.ORDER_TABLE), ('orders.md',)),
        ('A stop of an order', [*order_arrivals.DRAWN_STOP_TABLE[:2], *order.STOP_TABLE], ('orders.md',)),
        ('The dispatcher', list(dispatch_settings.DISPATCHER_TABLE), ('orders.md',)),
    ]


def page_of(key, first):
    """Return the page of the docs with a table that has a row for the key; the ``first`` pages are searched first."""
    names = [*sorted(name for name in os.listdir(DOCS) if name.endswith('.md') and name != PAGE),
             'nodes/fleet.md', 'nodes/task_source.md']
    pattern = re.compile(r'^\|[^|]*`~?{}`[^|]*\|'.format(re.escape(key)), re.MULTILINE)
    for name in (*first, *names):
        with open(os.path.join(DOCS, name), encoding='utf-8') as stream:
            if pattern.search(stream.read()):
                return name
    raise SystemExit('{}: no page of docs/ has a row for this key: describe it there first'.format(key))


def make_page():
    """Return the page's text."""
    parts = [HEAD]
    for heading, parameters, first in sections():
        parts += ['## {}\n'.format(heading), '| key | unit | default | allowed | page |', '|---|---|---|---|---|']
        parts += [row(parameter, page_of(parameter.name, first)) for parameter in parameters]
        parts.append('')
    return '\n'.join(parts)


if __name__ == '__main__':
    made = make_page()
    with open(output_file(os.path.join('docs', PAGE), __doc__), 'w', encoding='utf-8') as output:
        output.write(made)
