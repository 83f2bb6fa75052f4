#!/usr/bin/python3
"""Write docs/nodes/*.md, one page for each node, and the tables of parameters, states and others within pages.

usage: python3 tools/write_node_pages.py

Parameters come from the tables by which the nodes check them. Topics, services and actions come from
docs/nodes/interfaces.yaml, which a test compares with the nodes. Upstream's parameters come from
docs/nodes/upstream.yaml. A table within a page is between
`<!-- parameters: NAME -->`, or a kind of OTHERS as `<!-- states: robots -->`, and `<!-- end -->`. `make lint` compares
the pages with the output of this program.
"""
import ast
import json
import re
import sys
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / 'src'))
DOCS = ROOT / 'docs'
NODES = DOCS / 'nodes'

from move_base_abstract.common.errors import ConfigurationError  # noqa: E402
from move_base_abstract.config import node_tables, robot_table, settings  # noqa: E402
from move_base_abstract.driving import settings as driving  # noqa: E402
from move_base_abstract.energy import battery  # noqa: E402
from move_base_abstract.faults import buggify, failures  # noqa: E402
from move_base_abstract.fleet import robot_rows  # noqa: E402
from move_base_abstract.lockstep import node_parameters  # noqa: E402
from move_base_abstract.motion import durations  # noqa: E402
from move_base_abstract.orders import rows as order_rows  # noqa: E402
from move_base_abstract.orders.policies import POLICIES  # noqa: E402
from move_base_abstract.runs import built_in  # noqa: E402
from move_base_abstract.runs.metrics import METRICS  # noqa: E402
from move_base_abstract.runs.states import STATES  # noqa: E402
from move_base_abstract.sensing import laser  # noqa: E402
from move_base_abstract_experiments.chaos import failures as chaos_failures  # noqa: E402
from move_base_abstract_ros.nodes import help as programs  # noqa: E402

UNIT = re.compile(r' \[([^\[\]_]*)\]')
CPP_TABLE = ROOT / 'src' / 'time_master' / 'parameters' / 'parameter_table.h'
HEAD = ('| parameter | what | type | unit | default | range |', '|---|---|---|---|---|---|')
KINDS = {'boolean': 'true or false', 'integer': 'whole number', 'string': 'text', 'array': 'list'}


def _robot(*beginnings):
    return [parameter for parameter in robot_table.TABLE if parameter.name.startswith(beginnings)]


#: tables within pages, {name: Parameters}
WITHIN = {'durations': durations.TABLE, 'failures': failures.TABLE, 'buggify': buggify.TABLE, 'battery': battery.TABLE,
          'driving': driving.TABLE,
          'laser': laser.TABLE, 'stage': _robot('stage_'), 'gazebo': _robot('gazebo_'),
          'map': _robot('use_map', 'map_topic', 'allow_')}
#: parameters of all robots that one under velocities has use for; of rooms with a table of their own only the first
_OF_ALL = ('start_x', 'start_y', 'start_yaw', 'global_frame', 'odom_frame', 'robot_base_frame', 'tf_prefix', 'use_map',
           'map_topic', 'pose_update_freq', 'max_pose_rate', 'scan_rate', 'battery_capacity',
           'failure_kind', 'marker_topic', 'marker_size', 'log_motion', 'seed')
_LOCKSTEP = ('Of every node that takes part in lockstep', node_parameters.TABLE)
_SCENARIO = 'Keys of a scenario, instead of the file'
_ACTIONLIB = ('Of actionlib, found as actionlib finds them', node_tables.ACTIONLIB)
#: {node: [(heading of its table or '', Parameters)]}
TABLES = {
    'move_base': [('', robot_table.LIMITS + robot_table.TABLE), _LOCKSTEP, _ACTIONLIB],
    'velocity_robot': [('', (*driving.TABLE[1:], *robot_table.SHOWN)), ('Of all robots', [
        one for one in robot_table.TABLE if one.name in _OF_ALL]), _LOCKSTEP],
    'fleet': [('', node_tables.FLEET), (_SCENARIO, node_tables.FLEET_INLINE), _LOCKSTEP, _ACTIONLIB],
    'task_server': [('', node_tables.TASK_SERVER), (_SCENARIO, node_tables.TASK_SERVER_INLINE), _LOCKSTEP, _ACTIONLIB],
    'task_source': [('', node_tables.TASK_SOURCE), (_SCENARIO, node_tables.TASK_SOURCE_INLINE), _LOCKSTEP],
    'map_server': [('', (node_tables.MAP_FRAME, node_tables.MAP_IMAGE, *node_tables.MAP_OLD_FORM))],
}


def kind_of(parameter):
    """Return the type of a Parameter in a word."""
    schema = parameter.kind.schema
    if 'enum' in schema:
        return 'text'
    if schema:
        return KINDS.get(schema['type'], schema['type'])
    return 'mapping' if parameter.allowed.startswith('a mapping') else 'list'


def shown(value):
    """Return a default as YAML text."""
    if value in (None, '') or value == ():
        return ''
    if isinstance(value, (tuple, list)):
        return '`{}`'.format('[{}]'.format(', '.join("''" if item == '' else '{}'.format(item) for item in value)))
    if isinstance(value, bool):
        return str(value).lower()
    return '{:.6g}'.format(value) if isinstance(value, float) else str(value)


def row(parameter):
    """Return the row of a Parameter: name, what, type, unit, default, range."""
    units = UNIT.findall(parameter.allowed)
    return '| `{}` | {} | {} | {} | {} | {} |'.format(
        parameter.name, parameter.what, kind_of(parameter), units[-1] if units else '', shown(parameter.default),
        UNIT.sub('', parameter.allowed).replace('|', '\\|'))


def table(parameters):
    """Return the lines of a table of Parameters."""
    lost = [parameter.name for parameter in parameters if not parameter.what.endswith('.')]
    if lost:
        raise SystemExit(f'{lost[0]}: its Parameter has no sentence that describes it')
    return [*HEAD, *map(row, parameters)]


def cpp_rows():
    """Return the rows of the time master's table: name, type, unit, default, range, what."""
    text = CPP_TABLE.read_text(encoding='utf-8')
    text = text[text.index('kParameterTable[] = {'):text.index('\n};\n\n/** @return')]
    rows = [[ast.literal_eval(f'({cell})') for cell in re.findall(r'"(?:[^"\\]|\\.)*"(?:\s+"(?:[^"\\]|\\.)*")*', one)]
            for one in re.findall(r'\{((?:\s*"(?:[^"\\]|\\.)*",?)+)\}', text)]
    assert rows and all(len(one) == 6 for one in rows), rows
    return rows


def parameters_of(node):
    """Return the lines of a node's section on parameters."""
    lines = ['## Parameters', '', 'Private parameters, which the node reads once at the start. A wrong value is fatal: '
             'the text names key, namespace, value and what is allowed. A name that is not known gets a warning.', '']
    if node == 'time_master':
        rows = ('| `{}` | {} | {} | {} | {} | {} |'.format(one[0], one[5], *one[1:5]) for one in cpp_rows())
        return [*lines, *HEAD, *rows, '']
    for heading, parameters in TABLES[node]:
        lines += ([f'### {heading}', ''] if heading else []) + [*table(parameters), '']
    return lines


def interfaces_of(described):
    """Return the lines of a node's sections on actions, topics and services."""
    lines = []
    for part in ('actions', 'topics', 'services'):
        if part in described:
            columns = ['name', 'type', *(['direction'] if part == 'topics' else []), 'only with', 'what']
            lines += ['## ' + part.capitalize(), '', '| {} |'.format(' | '.join(columns)), '|---' * len(columns) + '|']
            for one in described[part]:
                cells = [', '.join(f'`{name}`' for name in one['names']), one['type'],
                         *([one['direction']] if part == 'topics' else []),
                         ' or '.join(f'`{name}`' for name in one['when'].split(' or ')) if 'when' in one else '',
                         one['what']]
                lines.append('| {} |'.format(' | '.join(cells)))
            lines.append('')
    return lines


def page(node, described):
    """Return the text of a node's page."""
    lines = [f'# Node `{node}`', '', described['what'] + ' How to use it: [guide]({}).'.format(described['guide']), '',
             'This page is written by `tools/write_node_pages.py` from the tables that the node checks against; a test '
             'holds it to the node.', '']
    if 'like' in described:
        lines += [described['like']['text'], '']
    if 'actions' in described or node == 'move_base':
        lines += ['`<ns>` is the namespace of a robot, `~` is the name of the node.', '']
    return '\n'.join([*lines, *parameters_of(node), *interfaces_of(described)]).rstrip() + '\n'


def filled(text):
    """Return a page's text with new tables."""
    def fill(match):
        kind, name = match.group(2), match.group(3)
        lines = OTHERS[kind](name) if kind in OTHERS else table(WITHIN[name])
        return '\n'.join([match.group(1), *lines, match.group(4)])
    return FILLED.sub(fill, text)


def rows_of(name):
    """Return the lines of a table of kinds of rows: of robots, with log_motion, or of orders."""
    kinds = order_rows.ROW_KINDS if name == 'orders' else [
        one for one in robot_rows.ROW_KINDS if one.is_motion == (name == 'motion')]
    return ['| kind | values | when |', '|---|---|---|',
            *(f'| `{one.kind}` | {one.values} | {one.words} |' for one in kinds)]


def faults(_name):
    """Return the lines of the table of deliberate faults."""
    return ['| fault | what happens. If several are drawn for a goal, the first in this order happens |', '|---|---|',
            *(f'| `{fault.name}` | {fault.happens} |' for fault in buggify.FAULTS)]


def failures_of_runs(_name):
    """Return the lines of the table of what fails a run of chaos."""
    named = ((', '.join(f'`{name}`' for name in kind.names) or "a statement's text", kind.when)
             for kind in chaos_failures.KINDS)
    return ['| name | when |', '|---|---|', *(f'| {name} | {when} |' for name, when in named)]


def coordinators(_name):
    """Return the lines of the table of what chaos finds, as bench/chaos_faults.py has counted it."""
    counted = json.loads((ROOT / 'test' / '.nodes' / 'coordinators' / 'counted.json').read_text(encoding='utf-8'))
    columns = ('order', 'delays', 'starts', 'default', 'twin')
    return ['| coordinator | seeds | order alone | order, delays up to 0.05 s | order, starts up to 0.5 s late | '
            'by default | its twin, by default |', '|---|---|---|---|---|---|---|',
            *(f'| `{name}` | {one["seeds"]} | {" | ".join(str(one[column]) for column in columns)} |'
              for name, one in counted.items())]


def policies(_name):
    """Return the lines of the table of a dispatcher's policies."""
    return ['| policy | rule |', '|---|---|', *(f'| `{name}` | {one.rule} |' for name, one in POLICIES.items())]


def states(_name):
    """Return the lines of the table of the states of robots, first those that come before others."""
    lines = ['| state | a robot is in it | from a row | to a row |', '|---|---|---|---|']
    for state in sorted(STATES, key=lambda state: state.precedence):
        begin, end = (', '.join(f'`{kind}`' for cause in state.causes for kind in kinds(cause))
                      for kinds in (lambda cause: cause.begin, lambda cause: cause.end))
        lines.append(f'| {state.name} | {state.words} | {begin} | {end} |')
    return lines


def properties(_name):
    """Return the lines of the table of the built-in properties."""
    rows = [f'| `{one.name}{"=NUMBER" if one.number else ""}` | {one.page} |' for one in built_in.BUILT_IN.values()]
    return ['| property | holds if |', '|---|---|', *rows]


def metrics(_name):
    """Return the lines of the table of the built-in metrics."""
    return ['| metric | unit | better | when | meaning |', '|---|---|---|---|---|',
            *(f'| `{name}` | {one.unit} | {one.better or ""} | {one.when.words} | '
              f'{one.title}{": " if one.says else ""}{one.says} |' for name, one in METRICS.items())]


def at_limit(_name):
    """Return the lines of the table of what metrics mean in trials that the limit of time ended."""
    words = {'lower_bound': 'lower bound', 'to_last_goal': 'lower bound if a goal was under way, otherwise a value',
             'value': 'value', None: 'not known: cut off'}
    own = "; your own, unless the experiment's file has `at_limit: {NAME: lower_bound}` or `{NAME: value}`"
    return ['| at the limit | which metrics |', '|---|---|',
            *('| {} | {}{} |'.format(text, ', '.join(f'`{name}`' for name, one in METRICS.items()
                                                     if one.at_limit == key), '' if key else own)
              for key, text in words.items())]


def list_of_programs(name):
    """Return the lines of the tables of the programs, by task, or of the table of their old names."""
    if name == 'old':
        rows = [f'| `{old}` | {row[-1]} |' for old, row in programs.OLD_NAMES.items()]
        return ['', '| old name | write instead |', '|---|---|', *rows, '']
    lines = []
    for task, rows in programs.PROGRAMS.items():
        lines += ['', f'**{task}**', '', '| program | what it does | page |', '|---|---|---|']
        lines += [f'| `{name}` | {words} | [{page.partition(".")[0]}]({page}) |'
                  for name, (words, page, _) in rows.items()]
    return [*lines, '']


def rooms(house):
    """Return the lines of the table of a house's rooms, from above, or of the rooms within a package."""
    borders = (ROOT / 'pyproject.toml').read_text(encoding='utf-8').split('[tool.importlinter]')[1]
    inside = {'lockstep': 'move_base_abstract_ros.lockstep', 'experiments': 'move_base_abstract_experiments',
              'study': 'soil_mapping'}.get(house)
    if inside:
        names = re.findall('[a-z_]+', re.search(rf'\["{inside}"\]\nlayers = (.*)', borders).group(1))
    else:
        layers = borders.split('layers = [')[1].split('\n]\n')[0]
        names = re.findall(r'(?<=[" ])[a-z_.]+(?=[" ])', re.search(
            rf'  # .*\b{house.replace("_", "[- ]")}\b.*\n((?:  ".*\n?)+)', layers).group(1))
    lines = ['| room | what |', '|---|---|']
    for name in names:
        path = ROOT / 'src' / f'{inside + "." if inside else ""}{name}'.replace('.', '/')
        path = path / '__init__.py' if path.is_dir() else path.with_suffix('.py')
        said = ast.get_docstring(ast.parse(path.read_text(encoding='utf-8'))).partition('\n\n')[0]
        lines.append('| `{}` | {} |'.format(name, ' '.join(said.split()).replace('|', r'\|').replace('``', '`')))
    return lines


def commands(_name):
    """Return the lines of the table of the debugger's commands, from the docstrings of its prompt."""
    lines = ['| command | what it does |', '|---|---|']
    for path in sorted((ROOT / 'src' / 'move_base_abstract_ros' / 'debugging').glob('*.py'), reverse=True):
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith('do_'):
                usage, _, words = ' '.join(ast.get_docstring(node).replace('|', r'\|').split()).partition('`: ')
                lines.append(f'| {usage}` | {words[:1].lower()}{words[1:]} |')
    return lines


_SAMPLES = (1.0, True, 1, 'a/B', '[[1, 0], [0, 1], [-1, -1]]', [{'name': 'static_layer', 'type': 'x/StaticLayer'}])


def _effect(names, others):
    """Return what a robot on a map does with a parameter: 'used', 'listed', or 'used with ...'. ``names``: its path."""
    path, effects = '/'.join(names), set()
    for sample in _SAMPLES:
        raw = {'use_map': True, 'routes': 'grid', **others}
        here = raw
        for name in names[:-1]:
            here = here.setdefault(name, {})
        here[names[-1]] = sample
        try:
            found = settings.read_settings(raw, '/move_base')
        except ConfigurationError:
            continue  # it is used, but it has another type
        effects.add(f'used with `{found.needs[path]}`' if path in found.needs else
                    'listed' if path in found.ignored + found.unknown else 'used')
    if not effects:
        raise SystemExit(f'{path}: no sample has its type')
    return max(effects)  # if it has an effect with some values, it is used


def _effect_of(part, described, name):
    if part == 'map_server':
        return 'used' if name in [one.name for one in (node_tables.MAP_FRAME, *node_tables.MAP_OLD_FORM)] else 'listed'
    if part == 'amcl':
        from move_base_abstract_ros.adopting import poses  # it needs ROS
        return 'used' if poses.is_of_place('/amcl/' + name) else 'listed'
    return _effect([*filter(None, (described.get('below', '') + name).split('/'))], described.get('with', {}))


def of_upstream(_name):
    """Return the lines of the table of upstream's parameters, and of what becomes of each."""
    lines = ['| part | parameters of | used | listed |', '|---|---|---|---|']
    for part, described in yaml.safe_load((NODES / 'upstream.yaml').read_text(encoding='utf-8')).items():
        effects = {name: _effect_of(part, described, name) for name in described['names']}
        used = [f'`{name}`{effect[4:]}' for name, effect in effects.items() if effect != 'listed']
        listed = [f'`{name}`' for name, effect in effects.items() if effect == 'listed']
        lines.append(f'| {part} | `~{described.get("below", "")}` | {", ".join(used)} | {", ".join(listed)} |')
    return lines


#: what makes the other tables within pages, by their kind
OTHERS = {'states': states, 'policies': policies, 'properties': properties, 'metrics': metrics, 'at_limit': at_limit,
          'rows': rows_of, 'faults': faults, 'failures': failures_of_runs, 'coordinators': coordinators,
          'commands': commands, 'upstream': of_upstream, 'programs': list_of_programs, 'rooms': rooms}
FILLED = re.compile(r'(<!-- (parameters|{}): (\w+) -->)\n.*?(<!-- end -->)'.format('|'.join(OTHERS)), re.DOTALL)


def pages():
    """Return {path: text} of all pages that this program writes, whole or in part."""
    interfaces = yaml.safe_load((NODES / 'interfaces.yaml').read_text(encoding='utf-8'))
    made = {NODES / (node + '.md'): page(node, described) for node, described in interfaces.items()}
    for path in sorted(DOCS.glob('*.md')):
        text = path.read_text(encoding='utf-8')
        if FILLED.search(text):
            made[path] = filled(text)
    return made


if __name__ == '__main__':
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    for where, content in pages().items():
        where.write_text(content, encoding='utf-8')
