"""Placeholders: {NAME} in the arguments of a system stands for a factor of the trial, its seed or its replication."""
from __future__ import annotations

import re
from typing import Any, Dict, Iterable

from move_base_abstract.common.kinds import unknown

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
    if isinstance(value, (list, dict)):
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            check(f'{where}.{key}', one, known)
    for name in _PLACE.findall(value) if isinstance(value, str) else ():
        if name not in known:
            raise unknown(f'{where}: the factor', name, known)


def filled(value: Any, values: Dict[str, Any]) -> str:
    """Return a text with each {NAME} replaced by its value."""
    return _PLACE.sub(lambda found: shown(values[found.group(1)]), shown(value))


def value_of(value: Any, values: Dict[str, Any]) -> Any:
    """Return a value with its placeholders filled in. A text that is one {NAME} becomes that value, of its own type."""
    if isinstance(value, list):
        return [value_of(one, values) for one in value]
    if isinstance(value, dict):
        return {key: value_of(one, values) for key, one in value.items()}
    if not isinstance(value, str):
        return value
    return values[value[1:-1]] if value[:1] == '{' and value[1:-1] in values else filled(value, values)
