"""Statements of a node: three functions that any Python program may call, in lockstep or not.

    always(len(owners) == 1, 'a task has one owner', task=7)
    sometimes(battery < 0.2, 'a battery gets low')
    never_again(goal.done, 'a goal is done once', goal=goal.id)

Where the node takes part in lockstep, what is news becomes a row of the run's event log. Elsewhere the first break of a
statement is a warning in the node's log, and nothing else happens.
"""
from __future__ import annotations

import logging
from types import SimpleNamespace
from typing import Any, Callable, List, Optional

from ..lockstep.property_names import ALWAYS, NEVER_AGAIN, SOMETIMES
from .statements import BROKEN, Statements

_made = Statements()
_state = SimpleNamespace(tell=None)  # takes the values of a row


def always(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition`` is true whenever this is called; the first time that it is not breaks it.

    ``text`` says what is stated, and is the same each time; ``details`` are shown where it breaks.

    :raises StatementError: if ``text`` is no text, or empty.
    """
    _take(ALWAYS, condition, text, details)


def sometimes(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition`` is true at least once when this is called, in some run: see :func:`always`."""
    _take(SOMETIMES, condition, text, details)


def never_again(condition: object, text: str, /, **details: Any) -> None:
    """State that ``condition``, once it has been true and then false, is never true again: see :func:`always`."""
    _take(NEVER_AGAIN, condition, text, details)


def tell_to(tell: Optional[Callable[[List[str]], object]]) -> None:
    """Have ``tell`` get the values of each row from now on; None: nobody."""
    _state.tell = tell


def _take(kind: str, condition: object, text: str, details: Any) -> None:
    for row in _made.take(kind, condition, text, details):
        if _state.tell is not None:
            _state.tell(row)
        elif row[2] == BROKEN:  # rospy's own logger, which Python's default one stands in for where there is no rospy
            logging.getLogger('rosout').warning('broken: %s: %s', kind, ', '.join([row[1], *row[3:]]))
