"""Show one run, or two side by side, from their event logs: a page that opens in any browser, without network.

    rosrun move_base_abstract replay RUN.jsonl [OTHER.jsonl] [--map MAP.yaml] [-o replay.html]

Exit codes: 0 written; 2 a file cannot be read or written, or wrong arguments.
"""
import argparse
import sys

from move_base_abstract.errors import SimulatorError

from .page import write_page


def main(words=None):
    """Write what the command line asks for, and exit with the code."""
    parser = argparse.ArgumentParser(prog='replay', description='Show a run, or two side by side, from event logs: a '
                                     'page that opens in any browser.',
                                     epilog='exit codes: 0 written, 2 a file cannot be read or written')
    parser.add_argument('logs', metavar='RUN', nargs='+', help='event log (JSON lines or CSV); or two')
    parser.add_argument('--map', metavar='MAP.yaml', help='the map to show it on, as map_server takes it')
    parser.add_argument('-o', '--output', metavar='PAGE', default='replay.html',
                        help='the page (default: %(default)s); one that this program made is replaced, nothing else is')
    options = parser.parse_args(words)
    if len(options.logs) > 2:
        parser.error('got {} logs; allowed: one, or two to be compared'.format(len(options.logs)))
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors='backslashreplace')  # names may hold bytes that are no text
    try:
        for note in write_page(options.logs, options.output, options.map):
            print('replay: note: {}'.format(note), file=sys.stderr)
    except SimulatorError as error:
        print('replay: {}'.format(error), file=sys.stderr)
        sys.exit(2)
    print(options.output)
