"""What is told beforehand, in lockstep, may not come to pass: what it has changed is noted here, and taken back.

Who tells what repeats itself (feedback, poses, heartbeats) says before it changes an attribute or an entry of a
dictionary; nothing is noted at other times. Not thread-safe: whoever tells beforehand has the participant's turn.
"""
from functools import partial

_NOTHING = object()


class NotForeseeable(Exception):
    """What was about to be told goes out at once: somebody listens who takes no part."""


class _Journal:
    """How to take back what is changed; ``undos`` is None while nothing is told beforehand."""

    undos = None


_journal = _Journal()


def begin():
    """Note from now on what is changed."""
    _journal.undos = []


def end():
    """Note no more; return the functions that take the changes back, to be called from the last one to the first."""
    undos, _journal.undos = _journal.undos, None
    return undos


def is_recording():
    """Return whether something is told beforehand at the moment."""
    return _journal.undos is not None


def changes(owner, attribute):
    """Note what the caller is about to change: an attribute."""
    if _journal.undos is not None:
        _journal.undos.append(partial(setattr, owner, attribute, getattr(owner, attribute)))


def changes_entry(entries, key):
    """Note what the caller is about to change: an entry of a dictionary."""
    if _journal.undos is not None:
        _journal.undos.append(partial(_put_back, entries, key, entries.get(key, _NOTHING)))


def _put_back(entries, key, value):
    if value is _NOTHING:
        entries.pop(key, None)
    else:
        entries[key] = value
