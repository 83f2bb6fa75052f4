"""Reads values from a dictionary of parameters, with errors that name key, namespace, value and what is allowed."""
from __future__ import annotations

import functools
import os
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple, TypeVar

from .errors import ConfigurationError
from .kinds import Kind, check_keys, error, made_by, similar
from .shown import shown, shown_text

Read = TypeVar('Read')


@dataclass(frozen=True)
class Parameter:
    """One parameter: its default, its kind (a Kind, or a function that raises ValueError), and its description.

    ``what``: one sentence in Markdown; empty if no page lists it. ``allowed``: the values that are allowed, in words;
    those of the kind if empty. ``needs``: (name, value) of another parameter without which it has no effect.
    """

    name: str
    default: Any
    kind: Callable[[Any], Any]
    what: str = ''
    allowed: str = ''
    needs: Tuple[str, ...] = ()

    def __post_init__(self) -> None:
        kind = self.kind if isinstance(self.kind, Kind) else made_by(self.kind, self.allowed)
        object.__setattr__(self, 'kind', kind)
        object.__setattr__(self, 'allowed', self.allowed or kind.allowed)


def place_of(where: str, key: str) -> str:
    """Return how error texts name the parameter ``key`` in the namespace ``where``."""
    return 'parameter {}/{}'.format(where.rstrip('/'), key)


def checked(raw: object, key: str, parameter: Parameter, where: str) -> Any:
    """Return the value of ``raw``, converted by ``parameter``.

    :raises ConfigurationError: if it is not allowed; the text names ``key``, the namespace ``where`` and the value.
    """
    try:
        return parameter.kind(raw)
    except (ValueError, TypeError, OverflowError):
        raise error(place_of(where, key), raw, parameter.allowed) from None


def read_table(raw: Mapping[str, Any], table: Sequence[Parameter], where: str) -> Dict[str, Any]:
    """Return {name: value} for each :class:`Parameter` of ``table``, from the dictionary ``raw`` or its default.

    :raises ConfigurationError: if a value is not allowed.
    """
    return {parameter.name: checked(raw[parameter.name], parameter.name, parameter, where)
            if parameter.name in raw else parameter.default for parameter in table}


def kept_per_file(key: str) -> Callable[[Callable[[str], Read]], Callable[[str, str], Read]]:
    """Decorate ``read(path)``: it becomes ``read(path, where)``; results are kept, since many robots name one file.

    ``key``: the parameter that names the file, in the namespace ``where``. A file that has changed is read again.

    :raises ConfigurationError: if the path is not absolute, or there is no such file.
    """
    def decorate(read: Callable[[str], Read]) -> Callable[[str, str], Read]:
        @functools.lru_cache(maxsize=64)
        def kept(path: str, _mtime_ns: int, _size: int) -> Read:
            return read(path)

        @functools.wraps(read)
        def found(path: str, where: str) -> Read:
            if not os.path.isabs(path):
                raise error(place_of(where, key), path,
                            'an absolute path; in a scenario file also a path from its folder')
            try:
                status = os.stat(path)
            except (OSError, ValueError) as fault:
                raise ConfigurationError('{}: {}: cannot be read: {}'.format(
                    place_of(where, key), shown(path), getattr(fault, 'strerror', None) or fault)) from None
            return kept(path, status.st_mtime_ns, status.st_size)
        return found
    return decorate


def read_mapping(raw: Any, table: Sequence[Parameter], where: str, needed: Sequence[str] = ()) -> Dict[str, Any]:
    """Return as :func:`read_table` does the values in ``raw``, a mapping without other keys than those of ``table``.

    :raises ConfigurationError: if it is not, one of the keys ``needed`` is missing, or a value is not allowed.
    """
    names = tuple(parameter.name for parameter in table)
    if not isinstance(raw, dict):
        raise error(where, raw, 'a mapping with ' + ', '.join(needed or names))
    check_keys(raw, names, where, '')
    for parameter in table:
        if parameter.name in needed and parameter.name not in raw:
            raise ConfigurationError('{}: {} is missing; allowed: {}'.format(where, parameter.name, parameter.allowed))
    return read_table(raw, table, where)


def unknown_names(raw: Mapping[str, Any], known: Sequence[str], where: str) -> List[str]:
    """Return a warning for each key of ``raw`` that is not among ``known``, with the most similar known name."""
    return ['{}: unknown, not used{}'.format(place_of(where, shown_text(key)), similar(key, known))
            for key in sorted(raw) if key not in known]
