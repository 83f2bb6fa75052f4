"""Report what a fleet did in one run: utilisation, orders, where robots waited, charging, failures.

    rosrun move_base_abstract fleet_report RUN.jsonl [--json OUT.json]

Exit codes: 0 the report is written; 2 the log cannot be read, or the file cannot be written.
"""
from __future__ import annotations

import argparse
import json
from typing import Dict, List, Optional, Sequence, Tuple

from move_base_abstract.common import own_files
from move_base_abstract.common.errors import telling
from move_base_abstract.common.shown import first_lines
from move_base_abstract.runs import event_log
from move_base_abstract.runs.metrics import fleet_metrics
from move_base_abstract.runs.states import NAMES
from move_base_abstract.runs.story import Story

_FORMAT = '{"format": "move_base_abstract fleet report 1",\n'
_MOST_PLACES, _MOST_ROBOTS = 20, 60  # rows in the terminal; the JSON has all
_REST = '... and {} more: --json has all'


def main(words: Optional[Sequence[str]] = None) -> None:
    """Run the command with these arguments (default: those of the shell); exit with code 2 on an error."""
    parser = argparse.ArgumentParser(prog='fleet_report', description='Report what a fleet did in one run, from its '
                                     'event log: utilisation, orders, where robots waited, charging, failures.')
    parser.add_argument('log', metavar='LOG', help='an event log: of lockstep_launch --event-log, of an experiment, or '
                        'of Fleet.write_log')
    parser.add_argument('--json', metavar='OUT.json', help='write all figures as JSON; this replaces only a file '
                        'of this program; - for the standard output, instead of the text')
    options = parser.parse_args(words)
    with telling('fleet_report'):
        story, labels = story_of(options.log)
        if options.json == '-':
            print(json_text(story, labels), end='')
        else:
            print('\n'.join(lines_of(story, labels, options.log)))
        if options.json not in (None, '-'):
            own_files.check_file(options.json, lambda line: line == _FORMAT.encode())
            with own_files.whole_file(options.json, 'w', encoding='utf-8') as stream:
                stream.write(json_text(story, labels))


def story_of(path: str) -> Tuple[Story, List[str]]:
    """Return the Story of the event log ``path``, and the log's remarks that a reader must know, [text, ...].

    :raises EventLogError: if it cannot be read.
    """
    with event_log.opened(path) as log:
        story = Story(log.start_ns)
        for row in log.rows():
            story.take(*row)
    story.close((log.end or {}).get('at_ns'))
    return story, log.remarks()


def lines_of(story: Story, labels: List[str], path: str) -> List[str]:
    """Return the lines for a terminal."""
    robots = story.figures
    lines = [f'{path}: {len(robots)} robots, {story.seconds:.1f} s', *(f'  {label}' for label in labels)]
    if not robots:
        return lines
    lines += ['', 'share of time, mean of the robots', '  ' + ', '.join(
        f'{state} {100.0 * sum(one[state] for one in robots.values()) / _time(robots):.1f} %'
        for state in NAMES)]
    return [*lines, *_orders(story), *_waits(story), *_charging(story), *_robots(story)]


def _time(robots: Dict[str, Dict[str, float]]) -> float:
    return max(sum(one[state] for one in robots.values() for state in NAMES), 1e-9)


def _orders(story: Story) -> List[str]:
    orders = story.orders.times
    if not orders.arrived and not orders.refused:
        return []
    lines = ['', f'orders: {orders.arrived} arrived, {orders.done} done ({orders.late} of them late), {orders.failed} '
             f'given up, {orders.open} open; came back {orders.returned} times']
    if orders.refused:
        lines.append(f'  {orders.refused} more were refused: rows order_refused say why')
    undone = list(story.orders.undone.items())
    lines += first_lines([f'  open: {name}, {where}' for name, where in undone], _MOST_PLACES,
                         '  ... and {} more open: --json has all')
    for title, values in (('flow time', orders.flow), ('until a robot begins', orders.wait),
                          ('lateness', orders.lateness)):
        if values:
            own = sorted(values)
            lines.append(f'  {title + ":":<22}mean {sum(own) / len(own):.1f} s, median {own[len(own) // 2]:.1f} s, '
                         f'95 % within {own[min(len(own) - 1, int(0.95 * len(own)))]:.1f} s, most {own[-1]:.1f} s')
    return lines


def _waits(story: Story) -> List[str]:
    waits = story.waits
    if not waits:
        return []
    width = max(len('waiting'), *(len(where) for where in waits))
    lines = ['', f'{"waiting":<{width}}  {"times":>6}  {"in all [s]":>10}  {"mean [s]":>8}  {"longest [s]":>11}']
    return lines + first_lines([
        f'{where:<{width}}  {one.count:>6}  {one.total_ns / 1e9:>10.1f}  {one.total_ns / 1e9 / one.count:>8.1f}  '
        f'{one.longest_ns / 1e9:>11.1f}' for where, one in waits.items()], _MOST_PLACES, _REST)


def _charging(story: Story) -> List[str]:
    robots = story.figures.values()
    lines = []
    charges = int(sum(one['charges'] for one in robots))
    if charges or story.has_energy:
        lines.append(f'charging: {charges} times, {sum(one["charging"] for one in robots):.1f} s')
        if story.has_energy:
            lines[-1] += f'; {_sum(story, "energy_charged"):.3f} kWh charged, ' \
                         f'{_sum(story, "energy_used"):.3f} kWh used before it'
    failures = int(sum(one['failures'] for one in robots))
    if failures:
        lines.append(f'failures: {failures}, {sum(one["failed"] for one in robots):.1f} s')
    lines += first_lines([f'ran empty: {one.robot} at {one.time_ns / 1e9:.1f} s, {one.words}'
                          for one in story.emptied], _MOST_PLACES, '... and {} more ran empty: --json has all')
    return ['', *lines] if lines else []


def _sum(story: Story, what: str) -> float:
    return sum(one[what] for one in story.figures.values())


def _robots(story: Story) -> List[str]:
    robots = story.figures
    width = max(len('robot'), *(len(name) for name in robots))
    lines = ['', f'{"robot":<{width}}  ' + '  '.join(f'{state + " %":>10}' for state in NAMES) + '  orders  failures']
    return lines + first_lines([
        f'{name:<{width}}  ' + '  '.join(f'{100.0 * one[state] / _time({name: one}):>10.1f}' for state in NAMES)
        + f'  {one["orders"]:>6.0f}  {one["failures"]:>8.0f}' for name, one in robots.items()], _MOST_ROBOTS, _REST)


def json_text(story: Story, labels: List[str]) -> str:
    """Return all figures as JSON text. Its first line names the format."""
    waits = {where: {'times': one.count, 'seconds': one.total_ns / 1e9, 'longest': one.longest_ns / 1e9}
             for where, one in story.waits.items()}
    content = {'seconds': story.seconds, 'remarks': labels, 'metrics': fleet_metrics(story), 'robots': story.figures,
               'waits': waits, 'orders': story.orders.times._asdict(),
               'undone': story.orders.undone,
               'emptied': [{'robot': one.robot, 'seconds': one.time_ns / 1e9, 'at': one.at, 'doing': one.doing}
                           for one in story.emptied]}
    return _FORMAT + json.dumps(content, indent=1)[1:].lstrip('\n') + '\n'


if __name__ == '__main__':
    main()
