"""Statements of a node: three functions that any Python program may call, in lockstep or not.

    always(len(owners) == 1, 'a task has one owner', task=7)
    sometimes(battery < 0.2, 'a battery gets low')
    never_again(goal.done, 'a goal is done once', goal=goal.id)

If the node takes part in lockstep, each new outcome becomes a row of the run's event log. Otherwise the first break of
a statement is a warning in the node's log, and nothing else happens.
"""
from __future__ import annotations

import logging
from types import SimpleNamespace
from typing import Any, Callable, List, Optional

from ..runs.built_in import ALWAYS, NEVER_AGAIN, SOMETIMES
from .statements import BROKEN, Statements

_made = Statements()
_state = SimpleNamespace(tell=None)  # tell: a function that takes the values of a row


def always(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition`` is true in each call; the first call in which it is false breaks the statement.

    ``text`` says what is stated; it must be the same in each call. ``details`` are shown if the statement breaks.

    :raises StatementError: if ``text`` is no text, or empty.
    """
    _take(ALWAYS, condition, text, details)


def sometimes(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition`` is true in at least one call, in some run; arguments as for :func:`always`."""
    _take(SOMETIMES, condition, text, details)


def never_again(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition``, after it was true and then false, is never true again; see :func:`always`."""
    _take(NEVER_AGAIN, condition, text, details)


def tell_to(tell: Optional[Callable[[List[str]], object]]) -> None:
    """Call ``tell`` with the values of each row from now on; None: write breaks to the node's log."""
    _state.tell = tell


def _take(kind: str, condition: object, text: str, details: Any) -> None:
    for row in _made.take(kind, condition, text, details):
        if _state.tell is not None:
            _state.tell(row)
        elif row[2] == BROKEN:  # by rospy's logger; without rospy, Python's default one handles it
            logging.getLogger('rosout').warning('broken: %s: %s', kind, ', '.join([row[1], *row[3:]]))
