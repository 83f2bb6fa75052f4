"""Find the first message in which two bags differ, and describe it so that its cause can be found."""
import itertools
import os

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.input_files import sha256_of

from . import message_fields

_MOST_BYTES = 1 << 31  # of a bag that is read in the search


class BagError(SimulatorError):
    """A bag that cannot be read; the text names it."""


def lines(difference, logs):
    """Yield lines that describe a BagDifference of two event logs.

    ``logs``: the paths of the logs. The bags are looked for in the folders of the logs and in the current folder.
    """
    yield 'the bags of {} are different (number {} of them)'.format(difference.node, difference.number)
    found = []
    for log, bag in zip(logs, (difference.first, difference.second)):
        yield '{}: {}'.format(log, told(bag))
        found += [] if bag is None else [_beside(log, bag)]
    if len(found) == 2 and None not in found:
        try:
            yield from find(*found)
        except BagError as error:
            yield str(error)
    elif len(found) == 2:
        yield 'the bags are not beside the logs; `compare A.bag B.bag` names the first message that differs'


def told(bag):
    """Return a bag of an event log in words. None means that the log has no more bags."""
    return 'no more bags' if bag is None else '{name}, {bytes} bytes, SHA-256 {sha256}'.format(**bag)


def _beside(log, bag):
    """Return the path of a bag that the log describes, in the log's folder or the current one; None if not there."""
    for folder in (os.path.dirname(log), ''):
        path = os.path.join(folder, bag['name'])
        if os.path.isfile(path) and sha256_of(path) == bag['sha256']:
            return path
    return None


def find(first, second):
    """Return lines about the first difference between the bags at two paths; [] if all bytes are equal.

    :raises BagError: if a bag cannot be read.
    """
    try:
        for path in (first, second):
            if os.path.exists(path) and not os.path.isfile(path):
                raise BagError('{}: is not a regular file'.format(path))
        if sha256_of(first) == sha256_of(second):
            return []
        for path in (first, second):
            if os.path.getsize(path) > _MOST_BYTES:
                return ['{}: has more than {} bytes, and is not read'.format(path, _MOST_BYTES)]
    except OSError as error:
        raise BagError('{}: cannot be read: {}'.format(error.filename, error.strerror)) from None
    pairs = itertools.zip_longest(_messages(first), _messages(second))
    for number, (one, other) in enumerate(pairs, 1):
        if one is None or other is None or _compared(one) != _compared(other):
            return _lines_of(number, first, second, one, other)
    return ['all messages, their topics and stamps are equal; the connections or the layout of the files differ']


def _messages(path):
    """Yield (topic, (type, bytes, md5sum, ...), stamp) of each message of a bag, in the order of their stamps."""
    import genpy
    import rosbag  # takes a while
    try:
        with rosbag.Bag(path) as bag:
            yield from bag.read_messages(raw=True)
    except (OSError, rosbag.ROSBagException, genpy.MessageException, ValueError, LookupError) as error:
        raise BagError('{}: cannot be read: {}'.format(path, error)) from None


def _compared(message):
    topic, raw, stamp = message[:3]
    return topic, raw[0], raw[2], raw[1], stamp.to_nsec()


def _lines_of(number, first, second, one, other):
    lines_ = ['first difference: message {}'.format(number)]
    for path, message in ((first, one), (second, other)):
        lines_.append('  {}: {}'.format(path, 'no more messages' if message is None else
                                      '{:.9f} s: {} ({}), {} bytes'.format(message[2].to_nsec() * 1e-9, message[0],
                                                                           message[1][0], len(message[1][1]))))
    if one is not None and other is not None and one[:1] + one[1][:1] == other[:1] + other[1][:1]:
        lines_ += ['  ' + line for line in message_fields.difference(one[1][4], one[1][1], other[1][1])]
    return lines_
