"""Reads values from a dictionary of parameters, with errors that name key, namespace, value and what is allowed."""
from __future__ import annotations

import difflib
import math
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

from .errors import ConfigurationError
from .shown import shown, shown_text

#: ((x, y), ...), ascending by x
Pairs = Tuple[Tuple[float, float], ...]
#: {converter: JSON Schema of the values that it takes}; other converters are described in words only
SCHEMAS: Dict[Any, Dict[str, Any]] = {}


@dataclass(frozen=True)
class Parameter:
    """One parameter: its default, its converter (which raises ValueError if a value is not allowed), and its rule.

    ``allowed``: the values that are allowed, in words.
    """

    name: str
    default: Any
    convert: Callable[[Any], Any]
    allowed: str
    #: its description, one sentence in Markdown; empty if no page lists it
    what: str = ''


def number(low: float = -math.inf, high: float = math.inf, above: Optional[float] = None) -> Callable[[object], float]:
    """Return a converter of finite numbers in [low, high] and, if ``above`` is given, > ``above``."""
    def convert(value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError
        if not math.isfinite(value) or not low <= value <= high or (above is not None and not value > above):
            raise ValueError
        return float(value)
    SCHEMAS[convert] = {'type': 'number', **_bounds(low, high)}
    if above is not None:
        SCHEMAS[convert]['exclusiveMinimum'] = above
    return convert


def _bounds(low: float, high: float) -> Dict[str, float]:
    return {name: value for name, value in (('minimum', low), ('maximum', high)) if math.isfinite(value)}


def integer(low: int, high: float = math.inf) -> Callable[[object], int]:
    """Return a converter of whole numbers in [low, high]; 2.0 counts as one, as in roscpp."""
    def convert(value: object) -> int:
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise ValueError
        return value
    SCHEMAS[convert] = {'type': 'integer', **_bounds(low, high)}
    return convert


def boolean(value: object) -> bool:
    """Return ``value`` if it is true or false. :raises ValueError: otherwise."""
    if not isinstance(value, bool):
        raise ValueError
    return value


def text(value: object) -> str:
    """Return ``value`` if it is a string. :raises ValueError: otherwise."""
    if not isinstance(value, str):
        raise ValueError
    return value


def name(value: object) -> str:
    """Return ``value`` without leading slashes. :raises ValueError: if it is not a string, or nothing is left."""
    stripped = text(value).lstrip('/')
    if not stripped:
        raise ValueError
    return stripped


def topic(value: object) -> str:
    """Return ``value``, with its leading slash. :raises ValueError: if it is not a string, or has only slashes."""
    if not isinstance(value, str) or not value.strip('/'):
        raise ValueError
    return value


def one_of(*choices: str) -> Callable[[object], str]:
    """Return a converter of strings that are among ``choices``."""
    def convert(value: object) -> str:
        if not isinstance(value, str) or value not in choices:
            raise ValueError
        return value
    SCHEMAS[convert] = {'enum': list(choices)}
    return convert


def numbers(count: int) -> Callable[[object], Tuple[float, ...]]:
    """Return a converter of lists of ``count`` finite numbers."""
    single = number()

    def convert(value: object) -> Tuple[float, ...]:
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise ValueError
        return tuple(single(part) for part in value)
    SCHEMAS[convert] = {'type': 'array', 'items': SCHEMAS[single], 'minItems': count, 'maxItems': count}
    return convert


def ascending_pairs(first: Callable[[object], float], second: Callable[[object], float]) -> Callable[[object], Pairs]:
    """Return a converter of lists of [x, y] with ascending x to tuples of pairs; x by ``first``, y by ``second``."""
    def convert(value: object) -> Pairs:
        if not isinstance(value, (list, tuple)) or not value:
            raise ValueError
        pairs = tuple((first(x), second(y)) for x, y in value)
        if any(one[0] >= other[0] for one, other in zip(pairs, pairs[1:])):
            raise ValueError
        return pairs
    return convert


SCHEMAS[boolean] = {'type': 'boolean'}
SCHEMAS.update((one, {'type': 'string'}) for one in (text, name, topic))


def checked(raw: object, key: str, parameter: Parameter, where: str) -> Any:
    """Return the value of ``raw``, converted by ``parameter``.

    :raises ConfigurationError: if it is not allowed; the text names ``key``, the namespace ``where`` and the value.
    """
    try:
        return parameter.convert(raw)
    except (ValueError, TypeError, OverflowError):
        raise ConfigurationError('parameter {}/{}: got {}; allowed: {}'.format(
            where.rstrip('/'), key, shown(raw), parameter.allowed)) from None


def read_table(raw: Mapping[str, Any], table: Sequence[Parameter], where: str) -> Dict[str, Any]:
    """Return {name: value} for each :class:`Parameter` of ``table``, from the dictionary ``raw`` or its default.

    :raises ConfigurationError: if a value is not allowed.
    """
    return {parameter.name: checked(raw[parameter.name], parameter.name, parameter, where)
            if parameter.name in raw else parameter.default for parameter in table}


def unknown_names(raw: Mapping[str, Any], known: Sequence[str], where: str) -> List[str]:
    """Return a warning for each key of ``raw`` that is not among ``known``, with the most similar known name."""
    warnings = []
    for key in sorted(raw):
        if key in known:
            continue
        close = difflib.get_close_matches(shown_text(key), known, n=1)
        hint = "; did you mean '{}'?".format(close[0]) if close else ''
        warnings.append('parameter {}/{}: unknown, not used{}'.format(where.rstrip('/'), shown_text(key), hint))
    return warnings
