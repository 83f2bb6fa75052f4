"""Kinds of values, each with its check, its JSON Schema, and its form as a word of a command line.

Options of files and command lines and parameters of nodes are of these kinds. An error says where, what was got, and
what is allowed.
"""
from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Iterable, Mapping, Optional, Sequence, Tuple

from .errors import ConfigurationError
from .shown import shown, shown_text
from .units import FARTHEST_M

Schema = Dict[str, Any]
#: ((x, y), ...), ascending by x
Pairs = Tuple[Tuple[float, float], ...]
_DECIMAL = re.compile(r'\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*\Z', re.ASCII)
_WHOLE = re.compile(r'\s*[-+]?[0-9]{1,100}\s*\Z', re.ASCII)
_PRINTABLE = r'^[^\x00-\x1f\x7f-\x9f]*$'
_LONGEST_TEXT = 4096
_LONGEST_NAME = 200  # of topics and frames
_TOPIC = f'(?=.{{1,{_LONGEST_NAME}}}$)[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z0-9_]+)*/?'
_LARGEST_WHOLE = 10**18


@dataclass(frozen=True, eq=False)
class Kind:
    """One kind of value. ``check(where, value)`` returns the value for the code, or raises a ConfigurationError.

    ``of_word(word)`` converts a word of a command line to the value that a file would have, or raises a ValueError;
    ``to_word(value)`` converts the code's value back. ``each``: for lists and mappings, whose words are given once for
    each value, the Kind of one of them, a mapping's as NAME=VALUE. ``allowed``: what is allowed, in words; '': only the
    errors of ``check`` say it.
    """

    check: Callable[[str, Any], Any]
    schema: Schema
    of_word: Callable[[str], Any] = str
    to_word: Callable[[Any], str] = str
    each: Any = None
    allowed: str = ''

    def __call__(self, value: Any) -> Any:
        """Return ``value`` for the code. :raises ConfigurationError: if it is not allowed."""
        return self.check('', value)


def error(where: str, value: object, allowed: str, given: str = '') -> ConfigurationError:
    """Return the error for a value that cannot be used: where, what was got, and what is allowed.

    ``given``: what else was got that does not go with it, ' with ...'.
    """
    return ConfigurationError(f'{where}: got {shown(value)}{given}; allowed: {allowed}'.lstrip(': '))


def similar(name: object, known: Iterable[str], otherwise: str = '') -> str:
    """Return "; did you mean 'NAME'?" with the known name that is most similar; ``otherwise`` if none is."""
    near = difflib.get_close_matches(shown_text(name), list(known), n=1)
    return f"; did you mean '{near[0]}'?" if near else otherwise


def unknown(what: str, name: str, known: Iterable[str]) -> ConfigurationError:
    """Return the error for an unknown name, with the most similar known one."""
    known = list(known)
    return ConfigurationError(f'{what} {shown_text(name)!r} is unknown{similar(name, known)} '
                              f'(known: {", ".join(known) or "none"})')


def check_keys(raw: Mapping[str, Any], known: Sequence[str], where: str, prefix: str) -> None:
    """Check that all keys of the mapping ``raw`` are among ``known``; an error shows the key with ``prefix`` before it.

    :raises ConfigurationError: if one is not; the text begins with ``where``, and names the most similar known key.
    """
    for key in raw:
        if key not in known:
            hint = similar(key, known, '; allowed: ' + ', '.join(known[:12]))
            raise ConfigurationError(f'{where}: {prefix}{shown_text(key)}: unknown key{hint}')


def as_number(value: Any) -> float:
    """Return a number, or the one that a text is: ASCII digits, perhaps a sign, a point and an exponent; not 1_0, inf.

    Files, options and arguments take numbers in this one form. :raises ValueError: if it is none.
    """
    if isinstance(value, str) and not _DECIMAL.match(value):
        raise ValueError('{} is no number'.format(shown(value)))
    return float(value)


def as_whole(word: str) -> int:
    """Return the whole number that a text is, in ASCII digits, perhaps with a sign. :raises ValueError: if not."""
    if not _WHOLE.match(word):
        raise ValueError('{} is no whole number'.format(shown(word)))
    return int(word)


def made_by(made: Callable[[Any], Any], allowed: str, schema: Optional[Schema] = None, **others: Any) -> Kind:
    """Return the Kind of the values for which ``made(value)`` raises neither a ValueError nor a TypeError."""
    def check(where: str, value: Any) -> Any:
        try:
            return made(value)
        except (ValueError, TypeError, OverflowError):
            raise error(where, value, allowed) from None
    return Kind(check, schema or {}, allowed=allowed, **others)


def _kept(is_allowed: Callable[[Any], bool], allowed: str, schema: Optional[Schema] = None) -> Kind:
    """Return the Kind of the values for which ``is_allowed(value)``; the code gets them as they are."""
    def made(value: Any) -> Any:
        if not is_allowed(value):
            raise ValueError
        return value
    return made_by(made, allowed, schema)


def text(longest: int = _LONGEST_TEXT) -> Kind:
    """Return the kind of texts of one line that are not empty, with at most ``longest`` characters."""
    return _kept(lambda value: isinstance(value, str) and 0 < len(value) <= longest and value.isprintable(),
                 f'a text of one line, 1 to {longest} characters',
                 {'type': 'string', 'minLength': 1, 'maxLength': longest, 'pattern': _PRINTABLE})


def pattern(expression: str, allowed: str, made: Callable[[str], str] = str) -> Kind:
    """Return the kind of texts that match a regular expression; ``made(text)`` returns the value for the code."""
    form = re.compile(f'(?:{expression})\\Z', re.ASCII)

    def convert(value: Any) -> str:
        if not isinstance(value, str) or not form.match(value):
            raise ValueError
        return made(value)
    return made_by(convert, allowed, {'type': 'string', 'pattern': f'^(?:{expression})$'})


def number(low: float = -math.inf, high: float = math.inf, whole: bool = False, or_zero: bool = False, unit: str = '',
           or_word: str = '', above: Optional[float] = None, note: str = '') -> Kind:
    """Return the kind of finite numbers in ``low`` .. ``high``; with ``whole``, 2.0 is allowed, too, as in roscpp.

    ``above``: the numbers are > this. ``or_zero``: 0 is allowed, too. ``or_word``: a text that is allowed instead of a
    number; '': none. In error texts, ``unit`` is the unit, for example 's, simulated', and ``note`` follows.
    """
    def made(value: Any) -> Any:
        if or_word and value == or_word:
            return value
        if whole and isinstance(value, float) and float.is_integer(value):
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not (
                low <= value <= high and (above is None or value > above) or or_zero and value == 0) or not (
                whole or math.isfinite(value)):
            raise ValueError
        return value if whole else float(value)
    words = _range(low, high, above, 'a whole number' if whole else 'a number') + (f' [{unit}]' if unit else '') + (
        ', or 0' if or_zero else '') + (f', or {or_word}' if or_word else '') + (f', {note}' if note else '')
    schema: Schema = {'type': 'integer' if whole else 'number', **{
        name: value for name, value in (('minimum', low), ('maximum', high)) if math.isfinite(value)},
        **({} if above is None else {'exclusiveMinimum': above})}
    others = [{'type': 'number', 'enum': [0]}] * or_zero + [{'enum': [or_word]}] * bool(or_word)
    return made_by(made, words, {'anyOf': [*others, schema]} if others else schema, to_word=short,
                   of_word=lambda word: word if word == or_word else (as_whole if whole else as_number)(word))


def _range(low: float, high: float, above: Optional[float], what: str) -> str:
    """Return in words which numbers are allowed: 'a number in 0..1e9', 'a finite number > 0'."""
    if math.isfinite(high):
        return f'{what} in {_end(low)}..{_end(high)}' if above is None else f'{what} > {_end(above)}, <= {_end(high)}'
    what = what.replace('a number', 'a finite number')
    return f'{what} > {_end(above)}' if above is not None else f'{what} >= {_end(low)}' if math.isfinite(low) else what


def _end(value: float) -> str:
    """Return an end of a range: '1e9', '1e-6', '2147483647', '3.14159'."""
    brief = f'{value:g}'
    return re.sub(r'e\+?(-?)0*', r'e\1', brief) if float(brief) == value or value % 1 else str(int(value))


def short(value: Any) -> str:
    """Return a number as a word: 4.0 as '4'; a text as it is."""
    is_whole = isinstance(value, float) and float.is_integer(value) and abs(value) < _LARGEST_WHOLE
    return str(int(value) if is_whole else value)


def position(unit: str = 'm, global frame', **others: Any) -> Kind:
    """Return the kind of positions on an axis; ``others``: as for number()."""
    return number(-FARTHEST_M, FARTHEST_M, unit=unit, **others)


COORDINATE = position()


def integer(low: float, high: float = math.inf, **others: Any) -> Kind:
    """Return the kind of whole numbers in ``low`` .. ``high``; ``others``: as for number()."""
    return number(low, high, whole=True, **others)


#: the kind of the whole numbers that a message holds in an int32
INT32 = integer(-2 ** 31, 2 ** 31 - 1)


def one_of(*allowed: str) -> Kind:
    """Return the kind of texts that are among ``allowed``."""
    *first, last = map(repr, allowed)
    return _kept(lambda value: isinstance(value, str) and value in allowed, ' or '.join(filter(None, (
        ', '.join(first), last))), {'enum': list(allowed)})


def numbers(count: int, allowed: str = '', single: Kind = number()) -> Kind:
    """Return the kind of lists of ``count`` finite numbers of the kind ``single``, which the code gets as a tuple."""
    def made(value: Any) -> Tuple[float, ...]:
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise ValueError
        return tuple(map(single, value))
    return made_by(made, allowed or f'a list of {count} numbers', {
        'type': 'array', 'items': single.schema, 'minItems': count, 'maxItems': count})


def ascending_pairs(first: Callable[[Any], float], second: Callable[[Any], float], allowed: str = '') -> Kind:
    """Return the kind of lists of [x, y] with ascending x, as tuples of pairs; x by ``first``, y by ``second``."""
    def made(value: Any) -> Pairs:
        if not isinstance(value, (list, tuple)) or not value:
            raise ValueError
        pairs = tuple((first(x), second(y)) for x, y in value)
        if any(one[0] >= other[0] for one, other in zip(pairs, pairs[1:])):
            raise ValueError
        return pairs
    return made_by(made, allowed)


def _scalar(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= _LONGEST_TEXT and (value.isprintable() or not value) or (
        isinstance(value, bool) or isinstance(value, int) and abs(value) < _LARGEST_WHOLE) or (
        isinstance(value, float) and math.isfinite(value))


def string(allowed: str) -> Kind:
    """Return the kind of all texts."""
    return _kept(lambda value: isinstance(value, str), allowed, {'type': 'string'})


def bare_name(allowed: str) -> Kind:
    """Return the kind of names of frames and topics, which the code gets without leading slashes."""
    return made_by(_bare, allowed, {'type': 'string'})


def _bare(value: Any) -> str:
    bare = value.lstrip('/') if isinstance(value, str) else ''
    if not 0 < len(bare) <= _LONGEST_NAME or ' ' in bare or not bare.isprintable() or not bare.strip('/'):
        raise ValueError
    return bare


#: the kind of all values, which something else checks
ANY = Kind(lambda _where, value: value, {})
FLAG = _kept(lambda value: isinstance(value, bool), 'true or false', {'type': 'boolean'})
FRAME = bare_name('a frame name')
BELOW_ROOT = pattern(f'/*{_TOPIC}', 'a topic name', lambda name: name.lstrip('/'))
PATH = string('the path of a file')
#: the name of a topic, with its leading slash
TOPIC = pattern(f'[~/]?{_TOPIC}', 'a topic name')
#: the kind of values that can be in a table
SCALAR = _kept(_scalar, 'a text, a number, true or false', {
    'type': ['string', 'number', 'boolean'], 'maxLength': _LONGEST_TEXT, 'pattern': _PRINTABLE})
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
        name = names.check(f"{where}before '='", value[0])
        return name, kind.check(name, value[1])

    def of_word(word: str) -> Any:
        name, _, value = word.partition('=')
        return names.of_word(name), kind.of_word(value)
    return Kind(check, {}, of_word, lambda pair: f'{names.to_word(pair[0])}={kind.to_word(pair[1])}')


def one_of_types(others: Kind, *kinds: Tuple[type, Callable[[Any], Any], Kind]) -> Kind:
    """Return the kind of values of several types.

    ``kinds``: (type, made, kind), ...: a value of that type is checked by ``kind``, and the code gets ``made(value)``.
    Values of all other types are checked by ``others``.
    """
    def check(where: str, value: Any) -> Any:
        for type_, made, kind in kinds:
            if isinstance(value, type_):
                return made(kind.check(where, value))
        return others.check(where, value)
    return replace(others, check=check, schema={'anyOf': [*(kind.schema for _, _, kind in kinds), others.schema]})


def or_null(kind: Kind) -> Kind:
    """Return the kind of values of ``kind``, or null."""
    return one_of_types(kind, (type(None), lambda _: None, Kind(lambda _where, _value: None, {'type': 'null'})))
