"""Show one run, or two side by side, from their event logs: a page that opens in any browser, without network.

    rosrun move_base_abstract replay RUN.jsonl [OTHER.jsonl] [--map MAP.yaml] [-o replay.html]
    rosrun move_base_abstract replay RUN.jsonl --mcap RUN.mcap --bag RUN.bag

Exit codes: 0 the files are written; 2 a file cannot be read or written, or the arguments are wrong.
"""
from __future__ import annotations

import argparse
import sys
from typing import Any, Iterator

from move_base_abstract.common.errors import telling
from move_base_abstract.common.kinds import number
from move_base_abstract.common.options import word_of

_PAGE = 'replay.html'
_RATE = word_of(number(above=0.0, high=1000.0, unit='Hz'))


def main(words: Any = None) -> None:
    """Write the files that these arguments ask for (default: those of the shell); exit with code 2 on an error."""
    options = _parse(words)
    with telling('replay'):
        for output in _write(options):
            print(output)


def _parse(words: Any) -> Any:
    parser = argparse.ArgumentParser(prog='replay', description='Make a page from an event log that plays the run '
                                     'in any browser, from two logs side by side. Or write the run as ROS messages.',
                                     epilog='exit codes: 0 written, 2 a file cannot be read or written')
    parser.add_argument('logs', metavar='RUN', nargs='+', help='event log (JSON lines or CSV); give two to compare '
                        'them')
    parser.add_argument('--map', metavar='MAP.yaml', help='the map behind the robots: a YAML file as for map_server')
    parser.add_argument('--scenario', metavar='FILE', help='the scenario of the run, whose zones, lanes and places are '
                        'shown (default: scenario.yaml beside the log, if it is there and of the same robots)')
    parser.add_argument('-o', '--output', metavar='PAGE',
                        help='the page (default: {}, unless --mcap or --bag is given). A page that this program made '
                        'is replaced, no other file is'.format(_PAGE))
    parser.add_argument('--mcap', metavar='FILE', help='write the run as ROS 1 messages into this new MCAP file')
    parser.add_argument('--bag', metavar='FILE', help='write the run as ROS messages into this new bag')
    parser.add_argument('--rate', type=_RATE, default=10.0, metavar='HZ', help='rate of the poses of moving robots in '
                        '--mcap and --bag [Hz, simulated] (default: %(default)g)')
    parser.add_argument('--frame', default='map', help='frame of the poses in --mcap and --bag (default: %(default)s)')
    options = parser.parse_args(words)
    if len(options.logs) > 1 and (options.mcap or options.bag):
        parser.error('got {} logs; allowed with --mcap and --bag: one'.format(len(options.logs)))
    if options.output is None and not (options.mcap or options.bag):
        options.output = _PAGE
    return options


def _write(options: Any) -> Iterator[Any]:
    """Write the files that are asked for; yield the name of each when it is written."""
    if options.output is not None:
        from .page import write_page  # these modules take a while to import
        for note in write_page(options.logs, options.output, options.map, options.scenario):
            print('replay: note: {}'.format(note), file=sys.stderr)
        yield options.output
    if options.mcap or options.bag:
        from .export import write_bag, write_mcap
        for write, output in ((write_mcap, options.mcap), (write_bag, options.bag)):
            if output:
                write(options.logs[0], output, options.rate, options.frame)
                yield output
