"""How long goals really take: an overhead, a factor and failures on the way, drawn once per goal (:mod:`.chance`)."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, ClassVar, Mapping, Optional, Tuple, Union

from ..common.bounded_yaml import load_yaml_file
from ..common.kinds import PATH, ascending_pairs, error, number, one_of
from ..common.parameter_table import Parameter, checked, kept_per_file, place_of
from ..common.units import seconds_to_ns
from ..engine.chance import Chance, Purpose
from ..engine.factors import Constant, Gamma, Lognormal, Quantiles, along
from .pace import Pace, PacedLeg

if TYPE_CHECKING:
    from ..maps.planning import StraightLinePlanner
    from .calibration import CalibratedDurations
    from .pieces import Motion
    from .recorded_range import Recorded

    Uniform = Callable[..., float]
    Beyond = Tuple[Union[str, float], ...]

#: chances of failures by the length of the way, also of a calibrated robot
FAILURES = ascending_pairs(number(low=0.0), number(0.0, 1.0))
FAILURES_ALLOWED = 'a list of [length [m], chance in 0..1], the lengths >= 0 and ascending'
_POINTS = ascending_pairs(number(0.0, 1.0), number(high=1e6, above=0.0))
_FACTORS = {'lognormal': Lognormal, 'gamma': Gamma}
DISTRIBUTIONS = ('constant', *_FACTORS, 'quantiles')

TABLE = (
    Parameter('goal_overhead', 0.0, number(0.0, 86400.0, unit='s, simulated'),
              'Time for which the robot stands before it begins to move, once for each goal.'),
    Parameter('duration_factor', 1.0, number(0.001, 1000.0),
              'Mean of the factor by which a leg takes longer than by the law of motion.'),
    Parameter('duration_distribution', 'constant', one_of(*DISTRIBUTIONS), 'Distribution of that factor.'),
    Parameter('duration_cv', 0.0, number(0.0, 10.0),
              'Coefficient of variation of the factor (standard deviation / mean), with `lognormal` and `gamma` '
              'only.'),
    Parameter('duration_quantiles', None, PATH,
              "File with the factor's quantiles, which `duration_factor` multiplies; with `quantiles` only."),
    Parameter('failure_by_length', (), FAILURES,
              'Chance that a goal fails on the way, linear between the given lengths and constant outside of them.',
              FAILURES_ALLOWED),
)
_POINTS_PARAMETER = Parameter('quantiles', None, _POINTS,
                              allowed='a list of [probability, factor > 0 and <= 1e6], the probabilities ascending '
                              'from 0 to 1')


@dataclass(frozen=True)
class Durations:
    """What may happen to each goal.

    The robot first stands for ``overhead`` [s]. The duration of its leg is multiplied by ``factor`` (one of
    :mod:`.factors`). The goal fails with a chance that depends on the length of the leg: ``failures``
    ((m, chance), ...), linear from one pair to the next.
    """

    overhead: float = 0.0
    factor: Any = Constant()
    failures: Tuple[Tuple[float, float], ...] = ()

    #: the ranges of recorded legs: none, since these numbers were not fitted to recordings
    recorded: ClassVar[Optional[Recorded]] = None

    @staticmethod
    def shaped(leg: Motion, _overhead: float, _uniform: Uniform) -> Motion:
        """Return ``leg`` itself, since the robot spends the overhead at rest."""
        return leg

    def draw(self, _leg: Motion, uniform: Uniform) -> Tuple[float, float]:
        """Return (overhead [s], factor) of a goal; ``uniform(purpose, place)`` gives the draws in (0, 1)."""
        return self.overhead, self.factor.draw(lambda place: uniform(Purpose.FACTOR, place))


def read_durations(values: Mapping[str, Any], where: str) -> Optional[Durations]:
    """Return the :class:`Durations` in ``values`` (of :data:`TABLE`), or None if goals go by the law of motion alone.

    :raises ConfigurationError: for values that do not fit together, and for a file that cannot be used.
    """
    kind, mean, cv = values['duration_distribution'], values['duration_factor'], values['duration_cv']
    if (kind in _FACTORS) != (cv > 0.0):
        raise error(place_of(where, 'duration_cv'), cv, f'> 0 with {" and ".join(_FACTORS)}, otherwise 0',
                    f' with duration_distribution: {kind}')
    if (kind == 'quantiles') != (values['duration_quantiles'] is not None):
        raise error(place_of(where, 'duration_quantiles'), values['duration_quantiles'],
                    "the path of a file with 'quantiles', otherwise none", f' with duration_distribution: {kind}')
    if kind in _FACTORS:
        factor: Any = _FACTORS[kind](mean, cv)
    else:
        factor = Constant(mean) if kind == 'constant' else Quantiles(
            mean, _read_quantiles(values['duration_quantiles'], where))
    durations = Durations(values['goal_overhead'], factor, values['failure_by_length'])
    return None if durations == Durations() else durations


@kept_per_file('duration_quantiles')
def _read_quantiles(path: str) -> Tuple[Tuple[float, float], ...]:
    raw = load_yaml_file(path)
    if not isinstance(raw, dict) or list(raw) != ['quantiles']:
        raise error(path, raw, 'a mapping with one key, quantiles')
    points = checked(raw['quantiles'], 'quantiles', _POINTS_PARAMETER, path)
    factors = [factor for _, factor in points]
    if (points[0][0], points[-1][0]) != (0.0, 1.0) or factors != sorted(factors):
        raise error(f'{path}: quantiles', raw['quantiles'],
                    f'{_POINTS_PARAMETER.allowed}, and factors that do not fall')
    return points  # type: ignore[no-any-return]


class GoalDurations:
    """Apply :class:`Durations` to the goals of one robot, one after the other.

    ``durations`` is a :class:`Durations` or has its interface. A robot that goes by the law of motion alone has no
    GoalDurations. The draws hold for the whole goal, even if the robot goes on from another place or by another way:
    it waits for its overhead once, and the length of the first leg decides whether it fails. The first leg also decides
    whether the goal lies outside the recorded ranges; if it does, ``on_beyond(recorded, found, now_ns)`` is called.
    ``planner`` knows the map, if there is one.
    """

    #: the text that the client gets when its goal fails; None: the text of move_base
    failure_text: Optional[str] = None

    def __init__(self, durations: Union[CalibratedDurations, Durations], seed: int = 0, robot_name: str = '',
                 planner: Optional[StraightLinePlanner] = None,
                 on_beyond: Optional[Callable[[Recorded, Beyond, int], object]] = None) -> None:
        self._durations = durations
        self._planner = planner
        self._on_beyond = on_beyond
        self._chance = Chance(seed, robot_name)
        self._number = 0
        self._factor: Optional[float] = None
        self._ready_ns = 0
        self._fails: Optional[bool] = None
        self._failure_ns: Optional[int] = None
        self._way_to_failure: Optional[float] = None

    def next_goal(self) -> None:
        """Note that the robot begins to work on its next goal."""
        self._number += 1
        self._factor = self._fails = self._way_to_failure = None

    def paced(self, leg: Motion) -> PacedLeg:
        """Return ``leg`` at the pace of its goal."""
        if self._factor is None:
            # A robot with a calibration has phases, so that its legs are PhasedRoutes.
            overhead, self._factor = self._durations.draw(leg, self._uniform)  # type: ignore[arg-type]
            self._ready_ns = leg.depart_ns + seconds_to_ns(overhead)
            self._judge(leg)
            shaped = self._durations.shaped(leg, overhead, self._uniform)  # type: ignore[arg-type]
            # If the shaped leg is longer, it contains that part of the overhead; the instant of arrival is the same.
            rest_ns = self._ready_ns - leg.depart_ns - (shaped.duration_ns - leg.duration_ns)
            return PacedLeg(shaped, Pace(max(0, rest_ns), self._factor))
        return PacedLeg(leg, Pace(max(0, self._ready_ns - leg.depart_ns), self._factor))

    def _judge(self, leg: Motion) -> None:
        recorded = self._durations.recorded
        if recorded is not None and self._on_beyond is not None:
            found = recorded.beyond(leg, getattr(self._planner, 'clearance_of', _unknown))
            if found:
                self._on_beyond(recorded, found, leg.depart_ns)

    def failure_ns(self, leg: Motion) -> Optional[int]:
        """Return the instant [ns] at which the robot fails on ``leg``, or None if it arrives."""
        if not self._durations.failures:
            return None
        if self._fails is None:
            self._fails = self._uniform(Purpose.FAILURE) < along(self._durations.failures, leg.distance)
        if not self._fails:
            return None
        way, self._way_to_failure = self._way_to_failure, None
        if way is None:
            self._failure_ns = leg.depart_ns + int(self._uniform(Purpose.FAILURE_PLACE) * leg.duration_ns)
        else:
            self._failure_ns = leg.covers_ns(way)
        return self._failure_ns

    def interrupted(self, leg: Motion, now_ns: int) -> None:
        """Note that the robot stops on its ``leg`` at ``now_ns`` [ns] and will go on; a failure keeps its place."""
        if self._fails and self._way_to_failure is None:
            self._way_to_failure = leg.distance_at(self._failure_ns or 0) - leg.distance_at(now_ns)

    def _uniform(self, purpose: Purpose, place: int = 0) -> float:
        return self._chance.uniform(self._number, purpose, place)


def _unknown(_points: object) -> None:
    """Return None, the clearance of a way if the planner cannot compute it (a planner of another author)."""
