"""The bags that participants have written: the preloaded library notes them, and they get digests when the run is over.

The digest is that of a bag's bytes. In equal runs a recorder that takes part writes the same bytes.
"""
import json
import os
from typing import NamedTuple

from move_base_abstract.common.input_files import sha256_of
from move_base_abstract.common.shown import shown_text
from move_base_abstract.runs import event_log

from ..process import code_places

NOTES = 'bags'  # the file in the folder of error_lines.VARIABLE where participants note the bags that they write
_ACTIVE = '.active'  # rosbag's name for a bag that is not closed
LITTLE_SPACE = 'less than 1 GiB is free where it is: rosbag may have stopped recording'
_BLOCK = 1 << 20  # bytes
_LEAST_SPACE = 1 << 30  # bytes: with less on the disk rosbag stops recording


class Bag(NamedTuple):
    """A bag as it is when the run is over. ``problem``: why its bytes are not covered, or None."""

    node: str
    path: str
    size: int  # bytes
    sha256: str
    problem: str

    @property
    def record(self):
        """The bag's entry in the event log. It is the same in each run."""
        return {'node': self.node, 'name': os.path.basename(self.path), 'bytes': self.size, 'sha256': self.sha256}


def written(path):
    """Return the Bags that the file at ``path`` notes and that still exist, by node and in the order of writing."""
    if not os.path.exists(path):
        return []
    with open(path, 'rb') as stream:
        words = [os.fsdecode(word) for word in stream.read().split(b'\0')]
    found = dict.fromkeys(zip(words[0::2], words[1::2]))
    bags = [_look_at(node, path) for node, path in found]
    return sorted((bag for bag in bags if bag is not None), key=lambda bag: bag.node)


def _look_at(node, path):
    closed = path[:-len(_ACTIVE)] if path.endswith(_ACTIVE) else path
    if closed != path and os.path.exists(path):
        return Bag(node, path, os.path.getsize(path), '', 'it was not closed')
    if os.path.exists(closed) and not os.path.isfile(closed):
        return Bag(node, closed, 0, '', 'it is not a regular file')
    try:
        size, sha256 = os.path.getsize(closed), sha256_of(closed)
        space = os.statvfs(closed)
    except FileNotFoundError:
        return None  # rosbag has removed it, because of --max-splits
    except OSError as error:
        return Bag(node, closed, 0, '', 'it cannot be read: {}'.format(error.strerror))
    if space.f_bavail * space.f_frsize < _LEAST_SPACE:
        return Bag(node, closed, size, sha256, LITTLE_SPACE)
    return Bag(node, closed, size, sha256, None)


def lines(bags):
    """Yield lines about the bags for the user."""
    for bag in bags:
        yield 'bag of {}: {}'.format(shown_text(bag.node), bag.path.replace('\n', '?'))
        yield '  not covered: {}'.format(bag.problem) if bag.problem else '  {} bytes, SHA-256 {}'.format(
            bag.size, bag.sha256)


def add_to_log(log, bags):
    """Write into the end record of an event log what only the launcher knows. A log without such a record stays.

    These are the bags, and the lines of source of the places that labels name. If a bag is not covered, the run is not
    called repeatable.
    """
    if not os.path.isfile(log):
        return
    with open(log, 'rb+') as stream:
        offset, text = _last_line(stream)
        head, body = (b'# ', text[2:]) if text.startswith(b'# ') else (b'', text)
        try:
            record = json.loads(body)
            end, told = record['end'], record['end']['not_repeatable_because']
        except (ValueError, KeyError, TypeError):
            return
        why = [code_places.with_lines(one) for one in told]
        if not bags and why == told:
            return
        if bags:
            end['bags'] = [bag.record for bag in bags if not bag.problem]
        why += [event_log.uncovered_bag(bag.node, bag.problem) for bag in bags if bag.problem]
        end['not_repeatable_because'] = why
        end['repeatable'] = bool(end.get('repeatable')) and not why
        stream.seek(offset)
        stream.write(head + json.dumps(record, separators=(',', ':'), ensure_ascii=False).encode(
            'utf-8', 'backslashreplace') + b'\n')


def _last_line(stream):
    """Return (offset [bytes] of the last line, the line)."""
    size = stream.seek(0, os.SEEK_END)
    block = min(size, _BLOCK)
    stream.seek(size - block)
    text = stream.read(block)
    begin = text.rstrip(b'\n').rfind(b'\n') + 1
    return size - block + begin, text[begin:]
