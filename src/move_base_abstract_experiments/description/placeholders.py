"""{NAME} in what a system is given: it stands for a factor of the trial, for its seed or its replication."""
from __future__ import annotations

import re
from typing import Any, Dict, Iterable

from move_base_abstract.common import kinds

_PLACE = re.compile(r'\{([^{}]*)\}')


def shown(value: Any) -> str:
    """Return a scalar as a launch file's argument or a word of a command has it."""
    if isinstance(value, bool):
        return 'true' if value else 'false'
    return value if isinstance(value, str) else repr(value)


def check(where: str, value: Any, known: Iterable[str]) -> None:
    """Complain of a {NAME} in a text that stands for nothing."""
    for name in _PLACE.findall(value) if isinstance(value, str) else ():
        if name not in known:
            raise kinds.unknown(f'{where}: the factor', name, known)


def filled(value: Any, values: Dict[str, Any]) -> str:
    """Return a text with the values in the place of {NAME}."""
    return _PLACE.sub(lambda found: shown(values[found.group(1)]), shown(value))


def value_of(value: Any, values: Dict[str, Any]) -> Any:
    """Return a value filled in; a text that is one {NAME} alone is that value as it is."""
    if not isinstance(value, str):
        return value
    return values[value[1:-1]] if value[:1] == '{' and value[1:-1] in values else filled(value, values)
