"""The report on two runs that differ: the events, the fields of the message, the bags, and likely causes."""
import os
import re

from move_base_abstract.runs import run_difference

from . import bag_difference, message_fields

_COLOUR = re.compile('\x1b\\[[0-9;]*m')
_REORDERED = 'the events of this instant are the same in both runs, in another order: nodes registered with the ROS ' \
             'master in another order, and so were connected in another order, or they talk past lockstep'
_UNSEEN = 'the labels of these runs name no source of chance or wall time. The tools do not see ' \
          'the order of registrations with the ROS master, effects of another run at the same time (files, ' \
          'shared memory), files of the run before, sets of objects, and the inside of libraries'


def event_lines(difference, first, run):
    """Yield lines that describe a run_difference.Difference between two Runs."""
    yield 'first difference: at {:.9f} s, event {} of this instant'.format(difference.time_ns * 1e-9, difference.place)
    for one, event in ((first, difference.first), (run, difference.second)):
        yield '  {}: {}'.format(one.condition.name, run_difference.told_lines(event) if event else
                                'no more events; the run ended: {}'.format(one.end['reason']))
    yield from _field_lines(difference, first, run)
    for node, events in difference.told.items():
        yield 'what {} had heard before, in both runs:'.format(node)
        yield from ('  ' + run_difference.told_lines(event) for event in events)


def _field_lines(difference, first, run):
    """Yield lines about the fields in which the two versions of a message differ."""
    events = difference.first, difference.second
    if None in events or any(event.kind not in run_difference.MESSAGES for event in events) \
            or len({(event.kind, event.robot) for event in events}) > 1:
        return
    kept = [message_fields.kept(one.message_bytes, difference.number) for one in (first, run)]
    if None in kept:
        yield 'the fields are not known: the bytes of this message were not kept'
        return
    (kind, data), (_, other) = kept
    if data == other:
        return
    yield 'its fields, {} / {}:'.format(first.condition.name, run.condition.name)
    for line in message_fields.difference(message_fields.class_of(kind) if kind else None, data, other):
        yield '  ' + line


def bag_lines(difference, first, run):
    """Yield lines that describe an event_log.BagDifference between two Runs whose events are equal."""
    yield 'the events are equal; the bags of {} are not (number {} of them)'.format(difference.node, difference.number)
    paths = []
    for one, bag in ((first, difference.first), (run, difference.second)):
        yield '  {}: {}'.format(one.condition.name, bag_difference.told(bag))
        paths += [one.bags.get((difference.node, difference.number))]
    if None in paths or not all(map(os.path.isfile, paths)):
        return
    try:
        yield from ('  ' + line for line in bag_difference.find(*paths))
    except bag_difference.BagError as error:
        yield '  {}'.format(error)


def label_lines(runs):
    """Yield each label once, with the names of the runs that have it."""
    labels = {}
    for run in runs:
        for label in run.labels:
            labels.setdefault(label, []).append(run.condition.name)
    for label, names in labels.items():
        yield '{} ({})'.format(label, 'all runs' if len(names) == len(runs) else ', '.join(names))


def cause_lines(difference, first, run):
    """Yield the likely causes: first the labels of both runs, those that name nodes of the difference before others.

    :param difference: the run_difference.Difference of the events, or None.
    """
    nodes = list(difference.told) if difference is not None else []
    labels = sorted(label_lines([first, run]), key=lambda label: not any(node in label for node in nodes))
    yield from labels
    if difference is not None and difference.is_reordered:
        yield _REORDERED
    if run.condition.points_at:
        yield run.condition.points_at
    if not labels:
        yield _UNSEEN


def lines_of(path):
    """Yield the lines of the output at ``path``, without colours."""
    with open(path, encoding='utf-8', errors='replace') as stream:
        for line in stream:
            yield _COLOUR.sub('', line).rstrip()
