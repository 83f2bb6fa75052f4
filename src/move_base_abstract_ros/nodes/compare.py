"""Compare the event logs of two runs of the event-driven clock.

    rosrun move_base_abstract compare A B

Prints `identical`, or the first difference: both events with their line numbers, and how many events each log has.
Only the events are compared, by value, in their order; one log may be JSON lines and the other CSV. A run that was
degraded, not repeatable, or did not end properly is named too.

Exit codes: 0 identical; 1 different; 2 a file cannot be read, or wrong arguments.
"""

import argparse
import sys

from move_base_abstract import event_log
from move_base_abstract.event_log import EventLog, EventLogError


def main(words=None):
    """Compare the two files of the command line and exit with the code."""
    parser = argparse.ArgumentParser(prog='compare', description='Compare the event logs of two runs: print '
                                     '`identical` or the first difference.',
                                     epilog='exit codes: 0 identical, 1 different, 2 a file cannot be read')
    parser.add_argument('first', metavar='A', help='event log (JSON lines or CSV)')
    parser.add_argument('second', metavar='B', help='event log (JSON lines or CSV)')
    arguments = parser.parse_args(words)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors='backslashreplace')  # a log may hold bytes that are no text
    try:
        sys.exit(_compare(arguments.first, arguments.second))
    except EventLogError as error:
        print(f'compare: {error}', file=sys.stderr)
        sys.exit(2)


def _compare(first_path, second_path):
    with event_log.open_text(first_path) as first_file, event_log.open_text(second_path) as second_file:
        first, second = EventLog(first_file, first_path), EventLog(second_file, second_path)
        result = event_log.compare(first, second)
    if result.identical:
        print('identical')
        print(f'{first.events} events each')
    else:
        print('different')
        for log, event in ((first, result.first), (second, result.second)):
            print(f'{log.name}:{event.line}: {event.text}' if event else f'{log.name}: no more events')
        print(f'{first.name} has {first.events} events, {second.name} has {second.events}')
    for log in (first, second):
        for remark in log.remarks():
            print(f'note: {log.name} {remark}' if log.end is None else f'note: {log.name} is {remark}')
    return 0 if result.identical else 1
