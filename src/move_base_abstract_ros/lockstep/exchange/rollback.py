"""Foreseen turns may never happen, so the changes of state that they make are noted here, and can be taken back.

The code that sends periodic messages (feedback, poses, heartbeats) says so before it changes an attribute or an entry
of a dictionary. Outside of foreseen turns nothing is noted. Not thread-safe: the calling thread must have the turn.
"""
from __future__ import annotations

from functools import partial
from typing import Any, Callable, Dict, List, Optional

_NOTHING = object()


class NotForeseeable(Exception):
    """A message cannot be foreseen, because an onlooker listens: to an onlooker it would go at once."""


class _Journal:
    """The functions that take changes back; ``undos`` is None outside of a foreseen turn."""

    undos: Optional[List[Callable[[], None]]] = None


_journal = _Journal()


def begin() -> None:
    """Note changes from now on."""
    _journal.undos = []


def end() -> List[Callable[[], None]]:
    """Stop noting; return the functions that take the changes back, to be called from the last one to the first."""
    undos, _journal.undos = _journal.undos, None
    return undos or []


def is_recording() -> bool:
    """Return whether changes are noted, as in a foreseen turn."""
    return _journal.undos is not None


def changes(owner: Any, attribute: str) -> None:
    """Note the present value of an attribute that the caller is about to change."""
    if _journal.undos is not None:
        _journal.undos.append(partial(setattr, owner, attribute, getattr(owner, attribute)))


def changes_entry(entries: Dict[Any, Any], key: Any) -> None:
    """Note the present entry of a dictionary that the caller is about to change, add or remove."""
    if _journal.undos is not None:
        _journal.undos.append(partial(_put_back, entries, key, entries.get(key, _NOTHING)))


def _put_back(entries: Dict[Any, Any], key: Any, value: Any) -> None:
    if value is _NOTHING:
        entries.pop(key, None)
    else:
        entries[key] = value
