"""Compare the event logs of two runs of the event-driven clock.

    rosrun move_base_abstract compare A B

Prints `identical`, or the first difference: both events with their line numbers, and the number of events in each log.
The events are compared by value and in their order. The digests of the participants' bags are compared too. One log
may be JSON lines and the other CSV. The command also names a run that was degraded, not repeatable, or did not end
properly. A and B may be bags: then the command names the first message that differs.

Exit codes: 0 identical; 1 different; 2 a file cannot be read, or wrong arguments.
"""

import argparse
import sys

from move_base_abstract.common.errors import telling
from move_base_abstract.common.shown import pasted
from move_base_abstract.runs import debug_command, event_log

from ..launching import bag_difference

_GOAL = 'goal'  # the kind of the rows that came after release 1.0


def main(words=None):
    """Compare the two files of the command line and exit with the code."""
    parser = argparse.ArgumentParser(prog='compare', description='Compare the event logs of two runs: print '
                                     '`identical` or the first difference.',
                                     epilog='exit codes: 0 identical, 1 different, 2 a file cannot be read')
    parser.add_argument('first', metavar='A', help='event log (JSON lines or CSV), or bag')
    parser.add_argument('second', metavar='B', help='event log (JSON lines or CSV), or bag')
    arguments = parser.parse_args(words)
    with telling('compare'):
        compare = _compare_bags if arguments.first.endswith('.bag') else _compare
        sys.exit(compare(arguments.first, arguments.second))


def _compare_bags(first, second):
    difference = bag_difference.find(first, second)
    print('different' if difference else 'identical')
    for line in difference:
        print(line)
    return 1 if difference else 0


def _note_old_logs(*paths):
    for path in paths:
        with event_log.opened(path) as log:
            kinds = {row.kind for row in log.rows()}
        if _GOAL not in kinds and 'ended' in kinds:
            print(f'note: {path} has goals that ended, but no rows `{_GOAL}`: it is of release 1.0, and runs of '
                  'later releases differ from it by these rows')


def _compare(first_path, second_path):
    with event_log.opened(first_path) as first, event_log.opened(second_path) as second:
        result = event_log.compare(first, second)
    bags, alone = event_log.compare_bags(first, second)
    if result.identical and bags is None:
        print('identical')
        number = sum(len(second.bags[node]) for node in first.bags if node in second.bags)
        print(f'{first.events} events each' + (f', {number} bags each' if number else ''))
        if not first.events and not number:
            print('note: nothing was compared: no log has an event')
    elif result.identical:
        print('different')
        print(f'{first.events} events each, which are identical')
        for line in bag_difference.lines(bags, (first_path, second_path)):
            print(line)
    else:
        print('different')
        for log, event in ((first, result.first), (second, result.second)):
            print(f'{log.name}:{event.line}: {event.text}' if event else f'{log.name}: no more events')
        print(f'{first.name} has {first.events} events, {second.name} has {second.events}')
        if [event.kind for event in (result.first, result.second) if event].count(_GOAL) == 1:
            _note_old_logs(first_path, second_path)
    for node in alone:
        print(f'note: only one log has digests of the bags of {node}: they are not compared')
    for log in (first, second):
        for remark in log.remarks():
            print(f'note: {log.name} {remark}' if log.end is None else f'note: {log.name} is {remark}')
    is_same = result.identical and bags is None
    if not is_same:
        print('next: both runs side by side: rosrun move_base_abstract replay {} {}; the likely cause: '
              'rosrun move_base_abstract verify FILE, with their launch file'.format(
                  pasted(first_path), pasted(second_path)))
    if not result.identical:
        instant_ns = min(event.time_ns for event in (result.first, result.second) if event)
        for path in (first_path, second_path):
            command = debug_command.of_instant(path, instant_ns)
            if command:
                print(f'next: before this event, in the debugger: {command}')
    return 0 if is_same else 1
