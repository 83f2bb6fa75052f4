"""The settings of a dispatcher: which robot gets which order, when robots charge, and what happens after a failure.

    dispatcher: {policy: batch, charge_below: 0.3, charge_until: 0.9, charge_when_idle: 0.7}

Key by key: docs/orders.md.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Tuple

from ..common.kinds import FLAG, error, integer, number, one_of
from ..common.parameter_table import Parameter, read_mapping
from .policies import POLICIES

RESTART, RESUME = 'restart', 'resume'


def _policy(value: Any) -> str:
    if not isinstance(value, str) or not (value in POLICIES or _is_reference(value)):
        raise ValueError
    return value


def _is_reference(value: str) -> bool:
    module, colon, name = value.partition(':')
    return bool(colon) and name.isidentifier() and all(part.isidentifier() for part in module.split('.'))


_SHARE = number(0.0, 1.0)
DISPATCHER_TABLE = (
    Parameter('policy', 'nearest', _policy, allowed='{}, or module:Class'.format(', '.join(POLICIES))),
    Parameter('distances', 'ways', one_of('ways', 'straight')),
    Parameter('attempts', 3, integer(1, 1000)),
    Parameter('after_failure', RESTART, one_of(RESTART, RESUME)),
    Parameter('charge_below', 0.3, _SHARE),
    Parameter('charge_until', 0.9, _SHARE),
    Parameter('charge_full', None, number(0.0, 1.0, note='or none: as charge_until')),
    Parameter('charge_when_idle', 0.0, number(0.0, 1.0, note='0 = never')),
    Parameter('charge_reserve', None, number(0.0, 1.0, note='or none: robots do not look ahead')),
    Parameter('park_when_idle', False, FLAG),
)


@dataclass(frozen=True)
class DispatchSettings:
    """The values of :data:`DISPATCHER_TABLE`. ``levels``: the states of charge whose crossing a robot must report."""

    policy: str = 'nearest'
    distances: str = 'ways'
    attempts: int = 3
    after_failure: str = RESTART
    charge_below: float = 0.3
    charge_until: float = 0.9
    charge_full: Optional[float] = None
    charge_when_idle: float = 0.0
    charge_reserve: Optional[float] = None
    park_when_idle: bool = False

    @property
    def levels(self) -> Tuple[float, ...]:
        """The states of charge between 0 and 1 on which decisions depend, highest first.

        If robots look ahead, these are also all whole percents, so that each charge is known to a percent.
        """
        given = {self.charge_below, self.charge_until, self.charge_full or 0.0, self.charge_when_idle}
        if self.charge_reserve is not None:
            given.update(percent / 100 for percent in range(1, 100))
        return tuple(sorted((level for level in given if 0.0 < level < 1.0), reverse=True))


def read_dispatcher(raw: Any, where: str) -> DispatchSettings:
    """Return the :class:`DispatchSettings` in the mapping ``raw``.

    :raises ConfigurationError: if a value is not allowed; the text names ``where``, the key and what is allowed.
    """
    here = '{}: dispatcher'.format(where)
    return settings_of(read_mapping(raw, DISPATCHER_TABLE, here), here)


def settings_of(values: Mapping[str, Any], where: str) -> DispatchSettings:
    """Return the settings in ``values`` of :data:`DISPATCHER_TABLE`.

    :raises ConfigurationError: if ``charge_until`` is not above ``charge_below``, or ``charge_full`` is below it.
    """
    settings = DispatchSettings(**{one.name: values[one.name] for one in DISPATCHER_TABLE})
    if not settings.charge_below < settings.charge_until:
        raise error(f'{where}: charge_until', settings.charge_until, 'more than that',
                    f' with charge_below: {settings.charge_below:g}')
    if settings.charge_full is not None and settings.charge_full < settings.charge_until:
        raise error(f'{where}: charge_full', settings.charge_full, 'at least that',
                    f' with charge_until: {settings.charge_until:g}')
    return settings


def with_levels(parameters: Dict[str, Any], levels: Tuple[float, ...], default: Tuple[float, ...]) -> Dict[str, Any]:
    """Return a robot's ``parameters`` with ``levels`` added to its battery's thresholds.

    ``default``: the thresholds if the parameters have none. Without a battery the parameters stay as they are.
    """
    given = parameters.get('battery_thresholds', list(default))
    if not levels or not parameters.get('battery_capacity') or not isinstance(given, (list, tuple)):
        return parameters
    return {**parameters, 'battery_thresholds': [*given, *(level for level in levels if level not in given)]}
