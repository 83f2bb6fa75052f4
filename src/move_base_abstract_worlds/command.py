"""Check a scenario before it runs, or make one from sizes.

    rosrun move_base_abstract scenario check FILE [--map MAP.yaml] [--picture OUT.png] [--json OUT.json]
    rosrun move_base_abstract scenario make warehouse --out FOLDER [--aisles 10] [--robots 50]

Exit codes: 0 nothing found, or made; 1 something was found; 2 a file cannot be read or written, or the arguments are
wrong.
"""
from __future__ import annotations

import argparse
import json
import os
import sys
from itertools import groupby
from typing import TYPE_CHECKING, Any, Optional, Sequence

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import word_of

from .findings import KINDS
from .sites import KINDS as KINDS_OF_SITES, make_site

if TYPE_CHECKING:
    from .findings import Finding
    from .world import World

_FORMAT = '{"format": "move_base_abstract scenario check 1",\n'
_MOST_OF_A_KIND = 20  # in the terminal; the JSON has all


def main(words: Optional[Sequence[str]] = None) -> None:
    """Run the command with these arguments (default: those of the shell); exit with its code."""
    options = _parse(words)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors='backslashreplace')  # type: ignore[union-attr]  # names may contain characters that a terminal cannot show
    try:
        code = options.run(options)
    except SimulatorError as error:
        print('scenario: {}'.format(error), file=sys.stderr)
        code = 2
    sys.exit(code)


def _parse(words: Any) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog='scenario', description='Check a scenario before it runs, or make one from sizes.',
        epilog='exit codes: 0 nothing found, or made; 1 something was found; 2 a file cannot be read or written')
    commands = parser.add_subparsers(metavar='COMMAND', required=True)
    check = commands.add_parser('check', help='report problems of a scenario', description=(
        'Report problems of a scenario: places where robots cannot start or go, places that they do not reach with '
        'their charge, and capacities that can lock.'))
    check.add_argument('scenario', metavar='FILE', help='a scenario file')
    check.add_argument('--map', metavar='MAP.yaml', help='the map, as map_server reads it (default: map.yaml beside '
                       'the scenario, if it is there)')
    check.add_argument('--picture', metavar='OUT.png', help='write a picture with the findings in red; it replaces '
                       'only a file of this program')
    check.add_argument('--json', metavar='OUT.json', help='write the findings as JSON, in the same way; - for the '
                       'standard output, instead of the text')
    check.set_defaults(run=_check)
    _add_make(commands)
    return parser.parse_args(words)


def _add_make(commands: Any) -> None:
    make = commands.add_parser('make', help='make a scenario from sizes', description='Make a scenario from sizes: '
                               'net of '
                               'lanes, places, chargers, map. The same sizes give the same files.')
    kinds = make.add_subparsers(metavar='KIND', required=True)
    for kind, (what, sizes, _) in KINDS_OF_SITES.items():
        one = kinds.add_parser(kind, help=what, description=what)
        one.add_argument('--out', required=True, metavar='FOLDER', help='a new folder, an empty one, or one that this '
                         'program made as a scenario; nothing else is replaced')
        for size in sizes:
            one.add_argument('--' + size.name.replace('_', '-'), default=size.default, metavar='N',
                             type=word_of(number(size.least, size.most, whole=True)),
                             help='{} (default: {})'.format(size.what, size.default))
        one.set_defaults(run=_make, kind=kind)


def _make(options: argparse.Namespace) -> int:
    from .layout import write_site  # numpy takes a while to import
    _, sizes, defaults = KINDS_OF_SITES[options.kind]
    values = {size.name: getattr(options, size.name) for size in sizes}
    site = make_site(options.kind, values)
    words = ' '.join(['scenario make', options.kind] + ['--{} {}'.format(name.replace('_', '-'), value)
                                                        for name, value in values.items()])
    write_site(site, values['robots'], defaults, words, options.out)
    print('{}: {} robots, {} nodes, {} lanes, {} places, {} chargers, {} orders'.format(
        os.path.join(options.out, 'scenario.yaml'), values['robots'], len(site.nodes), len(site.edges),
        len(site.places), sum('charger' in zone for zone in site.zones), len(site.orders)))
    return 0


def _check(options: argparse.Namespace) -> int:
    from .check import findings_of  # numpy and networkx take a while to import
    from .world import read_world
    world = read_world(options.scenario, options.map)
    findings = findings_of(world)
    if options.json == '-':
        print(_json_text(world, findings), end='')
    else:
        _tell(world, findings)
    if options.json not in (None, '-'):
        own_files.check_file(options.json, lambda line: line == _FORMAT.encode())
        with own_files.whole_file(options.json, 'w', encoding='utf-8') as stream:
            stream.write(_json_text(world, findings))
    if options.picture is not None:
        from .picture import write_picture
        write_picture(world, findings, options.picture)
    return 1 if findings else 0


def _tell(world: World, findings: Sequence[Finding]) -> None:
    print('{}: {} robots, {} zones, {} places, {} nodes; map: {}'.format(
        world.path, len(world.starts), len(world.scenario.zones), len(world.scenario.places or ()),
        sum(len(net.nodes) for net in world.nets.values()), world.map_path or 'none'))
    headlines = dict(KINDS)
    for kind, own in groupby(findings, key=lambda one: one.kind):
        group = list(own)
        print('\n{} ({}): {}'.format(kind, len(group), headlines[kind]))
        for one in group[:_MOST_OF_A_KIND]:
            print('  ' + one.text().replace('\n', '\n  '))
        if len(group) > _MOST_OF_A_KIND:
            print('  ... and {} more of this kind: --json has all'.format(len(group) - _MOST_OF_A_KIND))
    plural = 's' * (len(findings) > 1)
    print('\n{}'.format('{} finding{}'.format(len(findings), plural) if findings else 'nothing found'))


def _json_text(world: World, findings: Sequence[Finding]) -> str:
    """Return the findings as JSON text. Its first line names the format."""
    content = {'scenario': world.path, 'map': world.map_path, 'findings': [one.record() for one in findings]}
    return _FORMAT + json.dumps(content, indent=1)[1:].lstrip('\n') + '\n'
