"""Failures of a robot as parameters: how often it fails, in which way, and how long a repair takes."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Mapping, NamedTuple, Optional, Tuple, Union

from ..common.kinds import Pairs, ascending_pairs, error, number, one_of
from ..common.parameter_table import Parameter, checked, place_of
from ..common.units import seconds_to_ns
from ..engine.factors import Constant, Gamma, Lognormal

if TYPE_CHECKING:
    from ..motion.stuck_law import StuckLaw

ABORT, STALL, SILENT, STUCK = KINDS = ('abort', 'stall', 'silent', 'stuck')
#: the causes of failures
HOUR, KM, GOAL, CLEARANCE, ENCOUNTER, SCRIPT, REQUEST = (
    'hour', 'km', 'goal', 'clearance', 'encounter', 'script', 'request')
#: as STUCK, by the law of the robot's calibration
CALIBRATED = 'calibrated'
_NEVER = 'never'
_MOST_SECONDS = 1e9
_PATIENCE = 6.4  # s; the usual patience of a robot that is stuck
_SECONDS = number(0.0, _MOST_SECONDS, unit='s, simulated')
_KIND = one_of(*KINDS)
_KINDS_TEXT = "'abort', 'stall', 'silent' or 'stuck'"
_BY_CLEARANCE = ascending_pairs(number(0.0, 100.0), number(0.0, 1.0))


class Scripted(NamedTuple):
    """A failure at the simulated instant ``at_ns`` [ns]; ``kind`` or ``repair`` [s] None: as for other failures."""

    at_ns: int
    kind: Optional[str]
    repair: Optional[float]


def _script(value: Any) -> Tuple[Scripted, ...]:
    """Return the :class:`Scripted` of a list of seconds, or of mappings with ``at`` and perhaps kind and repair."""
    if not isinstance(value, (list, tuple)):
        raise ValueError
    return tuple(sorted((_scripted(entry) for entry in value), key=lambda one: one.at_ns))


def _scripted(entry: Union[Dict[str, Any], float]) -> Scripted:
    if not isinstance(entry, dict):
        entry = {'at': entry}
    if 'at' not in entry or not set(entry) <= {'at', 'kind', 'repair'}:
        raise ValueError
    return Scripted(seconds_to_ns(_SECONDS(entry['at'])), _KIND(entry['kind']) if 'kind' in entry else None,
                    _SECONDS(entry['repair']) if 'repair' in entry else None)


TABLE = (
    Parameter('failure_kind', 'none', one_of('none', *KINDS, CALIBRATED),
              'Behaviour of a robot that has failed; `none`: it never fails; `calibrated`: it gets stuck as its '
              'calibration says.'),
    Parameter('failures_per_hour', 0.0, number(0.0, 3600.0, unit='1/h'),
              'Mean number of failures in an hour in which the robot has a goal and has not failed.'),
    Parameter('failures_per_km', 0.0, number(0.0, 1e6, unit='1/km'), 'Mean number of failures in a kilometre driven.'),
    Parameter('failures_per_goal', 0.0, number(0.0, 1000.0), 'Mean number of failures on the way to a goal.'),
    Parameter('failure_times', (), _script,
              'Failures at these instants of `/clock`; instants before the robot exists are left out.',
              'a list of seconds in 0..1e9 [s, simulated], or of mappings {at: seconds, '
              'kind: ' + _KINDS_TEXT + ', repair: seconds}'),
    Parameter('repair_time', 60.0, _SECONDS,
              'Mean time until a failed robot is repaired.', 'a number in 0..1e9 [s, simulated]'),
    Parameter('repair_distribution', None, one_of('fixed', 'lognormal', _NEVER),
              'Distribution of that time; `never`: until you repair the robot. If it is not set, `fixed` counts; with '
              '`stuck`, `never` does; with `calibrated`, that of the calibration.'),
    Parameter('repair_cv', 0.0, number(0.0, 10.0),
              'Coefficient of variation of the time (standard deviation / mean), with `lognormal` only.'),
    Parameter('stuck_by_clearance', (), _BY_CLEARANCE,
              "With `stuck` and a map: the chance to get stuck on the way to a goal, by the way's least clearance.",
              'a list of [clearance in 0..100 [m], chance in 0..1], the clearances ascending'),
    Parameter('stuck_patience', None, _SECONDS,
              'Time for which a robot that is stuck tries before it gives the goal up. If it is not set, '
              f'{_PATIENCE} s counts; with `calibrated`, that of the calibration.',
              'a number in 0..1e9 [s, simulated]'),
)
_REQUESTED_KIND = Parameter('kind', None, _KIND)
_REQUESTED_REPAIR = Parameter('repair', None, _SECONDS)
_RATES = {HOUR: 'failures_per_hour', KM: 'failures_per_km', GOAL: 'failures_per_goal'}


@dataclass(frozen=True)
class Failures:
    """The failures of a robot.

    ``kind``: one of KINDS; ``rates``: ((cause, rate), ...), each > 0, in 1/h with a goal, 1/km, or per goal;
    ``script``: (:class:`Scripted`, ...) in the order of time; ``repair``: the distribution of the time to a repair [s],
    one of :mod:`.factors`, None: there is no repair; ``by_clearance``: ((clearance of the way [m], chance to get
    stuck), ...); ``patience`` [s]: the time after which a robot that is stuck gives up a goal; ``law``: that of the
    calibration by which robots that meet get stuck, None: they do not.
    """

    kind: str
    rates: Tuple[Tuple[str, float], ...] = ()
    script: Tuple[Scripted, ...] = ()
    repair: Any = Constant(60.0)
    by_clearance: Pairs = ()
    patience: float = _PATIENCE
    law: Optional[StuckLaw] = None


def check_request(kind: Optional[str], repair: Optional[float], where: str) -> None:
    """Check the ``kind`` and the ``repair`` [s] of a failure that a user requests, None: as for other failures.

    :raises ConfigurationError: if one is not allowed; the text names ``where`` and what is allowed.
    """
    requested: Tuple[Tuple[str, Any, Parameter], ...] = (
        ('kind', kind, _REQUESTED_KIND), ('repair', repair, _REQUESTED_REPAIR))
    for key, value, parameter in requested:
        if value is not None:
            checked(value, key, parameter, where)


def read_failures(values: Mapping[str, Any], where: str, law: Optional[StuckLaw] = None) -> Optional[Failures]:
    """Return the :class:`Failures` in ``values`` (of :data:`TABLE`), None for a robot that never fails.

    ``law``: that of the robot's calibration, for ``failure_kind: calibrated``; what ``values`` say comes first.

    :raises ConfigurationError: for values that do not fit together; ``where``: the namespace of the parameters.
    """
    kind, cv = values['failure_kind'], values['repair_cv']
    if kind == 'none':
        for key in (*_RATES.values(), 'failure_times', 'stuck_by_clearance'):
            if values[key]:
                raise error(place_of(where, 'failure_kind'), kind, _KINDS_TEXT, f' with {key}')
        return None
    if kind != CALIBRATED:
        law = None
    elif law is None:
        raise error(place_of(where, 'failure_kind'), kind, f'{_KINDS_TEXT}, or this with a calibration that has a '
                    'section stuck')
    else:
        kind = STUCK
    by_clearance = values['stuck_by_clearance']
    if by_clearance and not (kind == STUCK and values['use_map']):
        raise error(place_of(where, 'stuck_by_clearance'), by_clearance, 'with stuck and true only',
                    f' with failure_kind: {kind} and use_map: {str(values["use_map"]).lower()}')
    distribution = values['repair_distribution'] or (CALIBRATED if law else _NEVER if kind == STUCK else 'fixed')
    if (distribution == 'lognormal') != (cv > 0.0):
        raise error(place_of(where, 'repair_cv'), cv, '> 0 with lognormal, otherwise 0',
                    f' with repair_distribution: {distribution}')
    mean, patience = values['repair_time'], values['stuck_patience']
    repair: Any = None if distribution == _NEVER else Lognormal(mean, cv) if cv else Constant(mean)
    if law is not None:
        by_clearance = by_clearance or law.by_clearance
        patience = law.patience if patience is None else patience
        if distribution == CALIBRATED:
            repair = None if law.free_mean is None else Gamma(law.free_mean, 1.0)
    rates = tuple((cause, values[key]) for cause, key in _RATES.items() if values[key])
    return Failures(kind, rates, values['failure_times'], repair, by_clearance,
                    _PATIENCE if patience is None else patience, law if law and law.by_nearest else None)
