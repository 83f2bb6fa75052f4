"""Reads values from a dictionary of parameters, with errors that name key, namespace, value and what is allowed."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Sequence

from .errors import ConfigurationError
from .kinds import Kind, made_by, similar
from .shown import shown, shown_text


@dataclass(frozen=True)
class Parameter:
    """One parameter: its default, its kind (a Kind, or a function that raises ValueError), and its description.

    ``what``: one sentence in Markdown; empty if no page lists it. ``allowed``: the values that are allowed, in words;
    those of the kind if empty.
    """

    name: str
    default: Any
    kind: Callable[[Any], Any]
    what: str = ''
    allowed: str = ''

    def __post_init__(self) -> None:
        kind = self.kind if isinstance(self.kind, Kind) else made_by(self.kind, self.allowed)
        object.__setattr__(self, 'kind', kind)
        object.__setattr__(self, 'allowed', self.allowed or kind.allowed)


def checked(raw: object, key: str, parameter: Parameter, where: str) -> Any:
    """Return the value of ``raw``, converted by ``parameter``.

    :raises ConfigurationError: if it is not allowed; the text names ``key``, the namespace ``where`` and the value.
    """
    try:
        return parameter.kind(raw)
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
    return ['parameter {}/{}: unknown, not used{}'.format(where.rstrip('/'), shown_text(key), similar(key, known))
            for key in sorted(raw) if key not in known]
