"""Placeholders: {NAME} in the arguments of a system stands for a factor of the trial, its seed or its replication."""
from __future__ import annotations

import re
from typing import Any, Dict, Iterable

from move_base_abstract.common import kinds

_PLACE = re.compile(r'\{([^{}]*)\}')


def shown(value: Any) -> str:
    """Return a scalar as the text of a launch file's argument or of a word of a command."""
    if isinstance(value, bool):
        return 'true' if value else 'false'
    return value if isinstance(value, str) else repr(value)


def check(where: str, value: Any, known: Iterable[str]) -> None:
    """Check that each {NAME} in a text is known.

    :param where: the place of the text, for the error. :raises ConfigurationError: naming the first that is not known.
    """
    for name in _PLACE.findall(value) if isinstance(value, str) else ():
        if name not in known:
            raise kinds.unknown(f'{where}: the factor', name, known)


def filled(value: Any, values: Dict[str, Any]) -> str:
    """Return a text with each {NAME} replaced by its value."""
    return _PLACE.sub(lambda found: shown(values[found.group(1)]), shown(value))


def value_of(value: Any, values: Dict[str, Any]) -> Any:
    """Return a value with its placeholders filled in. A text that is one {NAME} becomes that value, of its own type."""
    if not isinstance(value, str):
        return value
    return values[value[1:-1]] if value[:1] == '{' and value[1:-1] in values else filled(value, values)
