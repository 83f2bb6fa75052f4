"""Statements of nodes about a run (always, sometimes, never again), and the rows of the event log with their outcomes.

A row is an event of kind ROW of the node: kind of statement, text, outcome, then details as 'key=value':

    {"time_ns":41300000000,"robot":"/coordinator","kind":"property","values":["always","one owner","broken","task=7"]}

A statement has at most two rows: STATED when it is made for the first time, and BROKEN or HELD when that is first true.
The C++ header include/move_base_abstract/properties.h follows the same rules.
"""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..common.errors import SimulatorError
from ..common.shown import cut
from ..runs.built_in import ALWAYS, NEVER_AGAIN, SOMETIMES

ROW = 'property'  # the kind of the events
KINDS = (ALWAYS, SOMETIMES, NEVER_AGAIN)
STATED, BROKEN, HELD = 'stated', 'broken', 'held'
LONGEST_TEXT = 200
MOST_DETAILS = 16
MOST_STATEMENTS = 1000  # of one node, with different kinds or texts
TOO_MANY = 'a node states at most {} things; what differs each time belongs in the details'.format(MOST_STATEMENTS)


class StatementError(SimulatorError):
    """A statement that is not allowed; the text says what was got, and what is allowed."""


class _Statement(NamedTuple):
    """The state of a statement.

    ``is_over``: whether the outcome is known; ``was_true``: the number of times that the condition has become true;
    ``is_true``: the condition in the last call.
    """

    is_over: bool
    was_true: int
    is_true: bool


class Statements:
    """The statements of one node. A call without news costs one look-up in a dict."""

    def __init__(self) -> None:
        self._made: Dict[Tuple[str, str], _Statement] = {}

    def take(self, kind: str, condition: object, text: str, details: Mapping[str, Any]) -> Sequence[List[str]]:
        """Return the values of the new rows for the event log, in order; there are usually none.

        ``kind``: one of KINDS. An ALWAYS is broken if ``condition`` is false. A SOMETIMES holds if it is true. A
        NEVER_AGAIN is broken if it becomes true for the second time.

        :raises StatementError: for another kind, or if ``text`` is no text, or is empty.
        """
        holds = bool(condition)
        made = self._made.get((kind, text))
        if made is None:
            _check(kind, text)
            if len(self._made) >= MOST_STATEMENTS:
                return self._too_many(text)
        elif made.is_over or made.is_true == holds:
            return ()
        was_true = (made.was_true if made else 0) + holds
        is_over = not holds if kind == ALWAYS else was_true > (kind == NEVER_AGAIN)
        self._made[kind, text] = _Statement(is_over, was_true, holds)
        rows = [] if made else [[kind, short(text), STATED]]
        if is_over:
            shown = ['{}={}'.format(short(key), short(value)) for key, value in sorted(details.items())[:MOST_DETAILS]]
            rows.append([kind, short(text), HELD if kind == SOMETIMES else BROKEN, *shown])
        return rows

    def _too_many(self, text: str) -> Sequence[List[str]]:
        """Return the row that says that there are too many statements, once."""
        if (ALWAYS, TOO_MANY) in self._made:
            return ()
        self._made[ALWAYS, TOO_MANY] = _Statement(True, 0, False)
        return [[ALWAYS, TOO_MANY, BROKEN, 'text=' + short(text)]]


def _check(kind: str, text: object) -> None:
    if kind not in KINDS:
        raise StatementError('a statement is {}, got {!r}'.format(' or '.join(KINDS), kind))
    if not isinstance(text, str) or not text.strip():
        raise StatementError('{} needs a text that says what it is about, got {!r}'.format(kind, text))


def short(value: object) -> str:
    """Return a value as one line of text, with at most LONGEST_TEXT characters."""
    return cut(' '.join(str(value).split()), LONGEST_TEXT)


class Row(NamedTuple):
    """The values of a row. ``outcome``: STATED, BROKEN or HELD."""

    kind: str
    text: str
    outcome: str
    details: Tuple[str, ...]


def read_row(values: Any) -> Optional[Row]:
    """Return the Row of an event's values, or None if they are not those of a statement."""
    if not isinstance(values, list) or len(values) < 3 or not all(isinstance(value, str) for value in values):
        return None
    kind, text, outcome = values[:3]
    if kind not in KINDS or outcome not in (STATED, BROKEN, HELD):
        return None
    return Row(kind, text, outcome, tuple(values[3:]))
