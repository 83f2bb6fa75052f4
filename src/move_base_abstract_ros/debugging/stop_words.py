"""The words of the commands that stop somewhere: `until result robot_1`, `until 12.5`, `back 5`, `back 2s`."""
from __future__ import annotations

import decimal
import re
from typing import Callable, Collection, Dict, List, NamedTuple, Sequence, Union

from move_base_abstract.common.kinds import similar
from move_base_abstract.common.shown import shown
from move_base_abstract.runs.built_in import ALL, KIND

from .stops import NEVER, ROW, Refused, Stop

FORMS = ('result ROBOT, message TOPIC, row KIND [ROBOT], INSTANT (simulated s), broken [PROPERTY], deadlock, end')
_LARGEST_S = 2 ** 31  # simulated
_NUMBER, _WHOLE = re.compile(r'[0-9]{1,10}(\.[0-9]{0,30})?'), re.compile('[0-9]{1,18}')


def absolute(name: str) -> str:
    """Return the name of a node or a topic with its slash in front, which people may leave out."""
    return '/' + name.strip().lstrip('/')


class UntilBroken(NamedTuple):
    """Until a row breaks one of the properties."""

    properties: Sequence[str]


class Back(NamedTuple):
    """Back by so many rows, or by a time [ns]."""

    rows: int = 0
    time_ns: int = 0


def nanoseconds(text: str, what: str) -> int:
    """Return a number of seconds as ns. :raises Refused: if ``text`` is none."""
    value = decimal.Decimal(text) if _NUMBER.fullmatch(text) else decimal.Decimal(-1)
    if not 0 <= value <= _LARGEST_S:
        raise Refused('{} must be a number of simulated seconds, 0 to {}; got {}'.format(
            what, _LARGEST_S, shown(text)))
    return int(value.scaleb(9).to_integral_value())


def whole(text: str, what: str, least: int = 1) -> int:
    """Return a whole number. :raises Refused: if ``text`` is none, or less than ``least``."""
    if not _WHOLE.fullmatch(text) or int(text) < least:
        raise Refused('{} must be a whole number of at least {}; got {}'.format(what, least, shown(text)))
    return int(text)


def until(words: List[str], robots: Collection[str]) -> Union[Stop, UntilBroken]:
    """Return what the words after `until` ask for. ``robots``: names of robots in the log.

    :raises Refused: if it is none of the FORMS.
    """
    first, rest = (words[0], words[1:]) if words else ('', [])
    if first in _KINDS:
        return _KINDS[first](rest, robots)
    if not rest and first[:1].isdigit():
        return Stop.at(nanoseconds(first, 'until'))
    raise Refused('until takes {}; got {}{}'.format(FORMS, shown(' '.join(words)), similar(first, list(_KINDS))))


def _result(words: List[str], robots: Collection[str]) -> Stop:
    _check(len(words) == 1, 'result ROBOT', words)
    name = _robot(words[0], robots)
    return Stop(ROW, kind='ended', robot=name if name in robots else name.lstrip('/'))


def _message(words: List[str], _robots: Collection[str]) -> Stop:
    _check(len(words) == 1, 'message TOPIC', words)
    return Stop(ROW, topic=absolute(words[0]))


def _row(words: List[str], robots: Collection[str]) -> Stop:
    _check(len(words) in (1, 2), 'row KIND [ROBOT]', words)
    return Stop(ROW, kind=words[0], robot=_robot(words[1], robots) if words[1:] else '')


def _broken(words: List[str], _robots: Collection[str]) -> UntilBroken:
    try:
        return UntilBroken([str(KIND.check('until broken', word)) for word in words] or (ALL,))
    except ValueError as error:
        raise Refused(str(error)) from None


def _deadlock(words: List[str], _robots: Collection[str]) -> Stop:
    _check(not words, 'deadlock', words)
    return Stop(ROW, kind='deadlock')


def _end(words: List[str], _robots: Collection[str]) -> Stop:
    _check(not words, 'end', words)
    return Stop.at_row(NEVER)


_KINDS: Dict[str, Callable[[List[str], Collection[str]], Union[Stop, UntilBroken]]] = {
    'result': _result, 'message': _message, 'row': _row, 'broken': _broken, 'deadlock': _deadlock, 'end': _end}


#: the words that may follow `until`
WORDS = tuple(_KINDS)


def _check(is_well: bool, form: str, words: List[str]) -> None:
    if not is_well:
        raise Refused('until takes {}; got {}'.format(form, shown(' '.join(words))))


def _robot(name: str, robots: Collection[str]) -> str:
    """Return the name as the log spells it, if it knows it with or without a slash at its beginning."""
    other = name[1:] if name.startswith('/') else '/' + name
    return other if other in robots else name


def back(words: List[str]) -> Back:
    """Return what the words after `back` ask for: nothing, a number of rows, or seconds as 2.5s."""
    if len(words) > 1:
        raise Refused('back takes [ROWS], or a time as 2.5s; got {}'.format(shown(' '.join(words))))
    if words and words[0].endswith('s'):
        return Back(time_ns=nanoseconds(words[0][:-1], 'back'))
    return Back(rows=whole(words[0], 'back') if words else 1)
