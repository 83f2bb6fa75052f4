"""Kinds of values, each with its check, its JSON Schema, and its form as a word of a command line.

Options of files and command lines and parameters of nodes are of these kinds. An error says where, what was got, and
what is allowed.
"""
from __future__ import annotations

import difflib
import math
import re
from typing import Any, Callable, Dict, Iterable, NamedTuple, Tuple

from .errors import ConfigurationError
from .shown import shown, shown_text

Schema = Dict[str, Any]
_PRINTABLE = r'^[^\x00-\x1f\x7f-\x9f]*$'
_LONGEST_TEXT = 4096
_LARGEST_WHOLE = 10**18


class Kind(NamedTuple):
    """One kind of value. ``check(where, value)`` returns the value for the code, or raises a ConfigurationError.

    ``of_word(word)`` converts a word of a command line to the value that a file would have, or raises a ValueError;
    ``to_word(value)`` converts the code's value back. ``each``: for lists and mappings, whose words are given once for
    each value, the Kind of one of them, a mapping's as NAME=VALUE.
    """

    check: Callable[[str, Any], Any]
    schema: Schema
    of_word: Callable[[str], Any] = str
    to_word: Callable[[Any], str] = str
    each: Any = None


def error(where: str, value: object, allowed: str) -> ConfigurationError:
    """Return the error for a value that cannot be used: where, what was got, and what is allowed."""
    return ConfigurationError(f'{where}: got {shown(value)}; allowed: {allowed}'.lstrip(': '))


def unknown(what: str, name: str, known: Iterable[str]) -> ConfigurationError:
    """Return the error for an unknown name, with the most similar known one."""
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1)
    hint = f'; did you mean {near[0]!r}?' if near else ''
    return ConfigurationError(f'{what} {shown_text(name)!r} is unknown{hint} (known: {", ".join(known) or "none"})')


def text(longest: int = _LONGEST_TEXT) -> Kind:
    """Return the kind of texts of one line that are not empty, with at most ``longest`` characters."""
    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or not value or len(value) > longest or not value.isprintable():
            raise error(where, value, f'a text of one line, 1 to {longest} characters')
        return value
    return Kind(check, {'type': 'string', 'minLength': 1, 'maxLength': longest, 'pattern': _PRINTABLE})


def pattern(expression: str, allowed: str, made: Callable[[str], str] = str) -> Kind:
    """Return the kind of texts that match a regular expression; ``made(text)`` returns the value for the code."""
    form = re.compile(f'(?:{expression})\\Z', re.ASCII)

    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or not form.match(value):
            raise error(where, value, allowed)
        return made(value)
    return Kind(check, {'type': 'string', 'pattern': f'^(?:{expression})$'})


def number(lowest: float, highest: float, whole: bool = False, or_zero: bool = False, unit: str = '',
           or_word: str = '') -> Kind:
    """Return the kind of finite numbers in ``lowest`` .. ``highest``; with ``whole``, 2.0 is allowed, too.

    ``or_zero``: 0 is allowed, too. ``unit``: the unit in error texts, for example 's, simulated'. ``or_word``: a text
    that is allowed instead of a number; '': none.
    """
    allowed = f'a {"whole " if whole else ""}number in {short(lowest)}..{short(highest)}' + (
        f' [{unit}]' if unit else '') + (', or 0' if or_zero else '') + (f', or {or_word}' if or_word else '')

    def check(where: str, value: Any) -> Any:
        if or_word and value == or_word:
            return value
        if whole and isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not (
                lowest <= value <= highest or or_zero and value == 0):
            raise error(where, value, allowed)
        return value if whole else float(value)
    schema = {'type': 'integer' if whole else 'number', 'minimum': lowest, 'maximum': highest}
    others = [{'type': 'number', 'enum': [0]}] * or_zero + [{'enum': [or_word]}] * bool(or_word)
    return Kind(check, {'anyOf': [*others, schema]} if others else schema,
                lambda word: word if or_word and word == or_word else int(word) if whole else float(word), short)


def short(value: Any) -> str:
    """Return a number as a word: 4.0 as '4'; a text as it is."""
    return str(int(value)) if isinstance(value, float) and value.is_integer() and abs(value) < _LARGEST_WHOLE else (
        str(value))


def one_of(*allowed: str) -> Kind:
    """Return the kind of texts that are among ``allowed``."""
    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or value not in allowed:
            raise error(where, value, ', '.join(allowed))
        return value
    return Kind(check, {'enum': list(allowed)})


def _flag(where: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise error(where, value, 'true or false')
    return value


def _scalar(where: str, value: Any) -> Any:
    if isinstance(value, str) and len(value) <= _LONGEST_TEXT and (value.isprintable() or not value):
        return value
    if isinstance(value, bool) or isinstance(value, int) and abs(value) < _LARGEST_WHOLE:
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    raise error(where, value, 'a text, a number, true or false')


FLAG = Kind(_flag, {'type': 'boolean'})
#: the kind of values that can be in a table
SCALAR = Kind(_scalar, {'type': ['string', 'number', 'boolean'], 'maxLength': _LONGEST_TEXT, 'pattern': _PRINTABLE})
#: the name of a factor or a metric
NAME = pattern('[A-Za-z][A-Za-z0-9_]{0,63}', 'a letter, then at most 63 letters, digits and underscores')


def list_of(kind: Kind, allowed: str = '', least: int = 0, distinct: bool = False, most: int = 10_000) -> Kind:
    """Return the kind of lists of values of ``kind``, which the code gets as tuples; ``allowed``: words for errors."""
    allowed = allowed or f'a list of at most {most} texts'

    def check(where: str, value: Any) -> Tuple[Any, ...]:
        if not isinstance(value, (list, tuple)) or not least <= len(value) <= most:
            raise error(where, value, allowed)
        found = tuple(kind.check(f'{where}[{place}]', one) for place, one in enumerate(value))
        if distinct and len({(type(one), one) for one in found}) < len(found):
            raise error(where, value, 'each value once')
        return found
    schema = {'type': 'array', 'items': kind.schema, 'maxItems': most, **({'minItems': least} if least else {}),
              **({'uniqueItems': True} if distinct else {})}
    return Kind(check, schema, each=kind)


def map_of(kind: Kind, names: Kind = NAME) -> Kind:
    """Return the kind of mappings from ``names`` to values of ``kind``."""
    def check(where: str, value: Any) -> Dict[Any, Any]:
        if not isinstance(value, dict):
            raise error(where, value, 'a mapping')
        return {names.check(where, name): kind.check(f'{where}.{name}', one) for name, one in value.items()}
    schema = {'type': 'object', 'additionalProperties': kind.schema}
    return Kind(check, {**schema, 'propertyNames': names.schema} if names is not SCALAR else schema,
                each=_pair(names, kind))


def _pair(names: Kind, kind: Kind) -> Kind:
    """Return the kind of the pairs (name, value) that a command line has as NAME=VALUE."""
    def check(where: str, value: Any) -> Any:
        name = names.check(where, value[0])
        return name, kind.check(name, value[1])

    def of_word(word: str) -> Any:
        name, _, value = word.partition('=')
        return names.of_word(name), kind.of_word(value)
    return Kind(check, {}, of_word, lambda pair: f'{names.to_word(pair[0])}={kind.to_word(pair[1])}')


def either(others: Kind, *kinds: Tuple[type, Callable[[Any], Any], Kind]) -> Kind:
    """Return the kind of values of several types.

    ``kinds``: (type, made, kind), ...: a value of that type is checked by ``kind``, and the code gets ``made(value)``.
    Values of all other types are checked by ``others``.
    """
    def check(where: str, value: Any) -> Any:
        for type_, made, kind in kinds:
            if isinstance(value, type_):
                return made(kind.check(where, value))
        return others.check(where, value)
    return others._replace(check=check, schema={'anyOf': [*(kind.schema for _, _, kind in kinds), others.schema]})


def or_null(kind: Kind) -> Kind:
    """Return the kind of values of ``kind``, or null."""
    return either(kind, (type(None), lambda _: None, Kind(lambda _where, _value: None, {'type': 'null'})))
