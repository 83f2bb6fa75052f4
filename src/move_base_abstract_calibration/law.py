"""The law of the simulator's ``calibration`` for many legs at once, for the fit. A test checks that both agree."""
from __future__ import annotations

import math
from typing import Any, Mapping, Sequence, Tuple, Union

import numpy as np
from scipy import special, stats

from move_base_abstract.motion.calibration import LEAST_MOST

_SHARES = (np.arange(200) + 0.5) / 200  # the quantiles of a tail from which its mean is computed
#: the values of a calibration, by its parameters: numbers, and tables as lists of pairs
Values = Mapping[str, Any]


def approach_seconds(distance: np.ndarray, speed: float, acceleration: float, gain: float, offset: float) -> np.ndarray:
    """Return how long each ``distance`` [m] takes [s], as ``seconds`` of the simulator's ``approach_profile``.

    ``speed`` [m/s], ``acceleration`` [m/s^2], ``gain`` [1/s], ``offset`` [m]; or the same with angles.
    """
    distance = np.maximum(distance, 0.0)
    whole = distance + offset
    peak = np.minimum(speed, 2.0 * whole / (1.0 / gain + np.sqrt(1.0 / gain ** 2 + 2.0 * whole / acceleration)))
    brakes = peak > gain * offset
    with np.errstate(divide='ignore', invalid='ignore'):
        peak = np.where(brakes, peak, np.minimum(speed, np.sqrt(2.0 * acceleration * distance)))
        ramp = 0.0 if math.isinf(acceleration) else peak / acceleration
        cruise = np.maximum(0.0, distance - 0.5 * peak * ramp - np.where(brakes, peak / gain - offset, 0.0)) / peak
        seconds = ramp + cruise + np.where(brakes, np.log(peak / (gain * offset)) / gain, 0.0)
    return np.where(distance > 0.0, seconds, 0.0)


def motion_seconds(values: Values, ways: np.ndarray) -> np.ndarray:
    """Return how long the motion along each way takes [s], without the delay at the start.

    ``values``: {parameter of a calibration: value}; ``ways``: array of rows (length [m], start turn, end turn [rad]).
    """
    length, start_turn, end_turn = ways.T
    moves = length > values['xy_goal_tolerance']
    start_turn = np.where(moves, start_turn, 0.0)
    turned = np.abs(start_turn)
    drive = approach_seconds(length - values['xy_goal_tolerance'], values['max_speed'], values['acceleration'],
                             values['braking_gain'], values['braking_offset'])
    square = values['bow_length'] ** 2
    bowed = end_turn - start_turn * square / np.maximum(square + np.where(moves, length, 0.0) ** 2, 1e-12)
    whole = np.abs(np.remainder(bowed + math.pi, 2.0 * math.pi) - math.pi)
    turn = approach_seconds(whole - values['yaw_goal_tolerance'], values['turning_speed'], math.inf,
                            values['turning_gain'], values['turning_offset'])
    return turned * (values['start_turn_linear'] + values['start_turn_square'] * turned) + drive + turn


class Durations:
    """The distributions of the durations [s] of legs along ``ways`` (rows of length, start turn, end turn).

    Each duration is ``values['start_delay']`` plus the motion plus a rest. With the chance ``tail`` the rest has a
    gamma distribution, otherwise it is the sum of a normal and an exponential one. If the tail comes from the turn, its
    rest x becomes x m / (x + m), where m is ``values['tail_most']`` times the length.
    """

    def __init__(self, values: Values, ways: Union[Sequence[Tuple[float, float, float]], np.ndarray]) -> None:
        ways = np.asarray(ways, float)
        motion = motion_seconds(values, ways)
        self.least = values['start_delay'] + motion
        self._spread = max(values['spread'], 1e-6)
        self._delay = np.maximum(values['delay_share'] * motion, 1e-6)
        self._for_turn = np.interp(np.abs(ways[:, 1]), *np.transpose(values['tail_chance_by_turn']))
        self.tail = 1.0 - np.exp(-values['tail_rate'] * motion) * (1.0 - self._for_turn)
        self._most = np.maximum(LEAST_MOST, values.get('tail_most', math.inf) * np.maximum(ways[:, 0], 1e-9))
        self._shape = 1.0 / values['tail_cv'] ** 2
        self._tail_mean = values['tail_mean']

    def mean(self) -> np.ndarray:
        """Return the mean duration of each leg [s]."""
        late = special.gammaincinv(self._shape, _SHARES) * self._tail_mean / self._shape
        for_turn = np.mean(late / (1.0 + late / self._most[:, None]), axis=1)
        return (self.least + self._for_turn * for_turn + (self.tail - self._for_turn) * self._tail_mean
                + (1.0 - self.tail) * self._delay)

    def density(self, durations: np.ndarray) -> np.ndarray:
        """Return the density [1/s] of each leg's distribution at ``durations`` [s]."""
        excess = durations - self.least
        spread, delay = self._spread, self._delay
        usual = np.exp(0.5 * (spread / delay) ** 2 - excess / delay
                       + special.log_ndtr(excess / spread - spread / delay)) / delay
        tail, scale = stats.gamma.pdf, self._tail_mean / self._shape
        left = self._left(excess)
        for_turn = np.where(left > 0.0, tail(excess / np.maximum(left, 1e-9), self._shape, scale=scale)
                            / np.maximum(left, 1e-9) ** 2, 0.0)
        return ((1.0 - self.tail) * usual + self._for_turn * for_turn
                + (self.tail - self._for_turn) * tail(excess, self._shape, scale=scale))

    def share_below(self, durations: np.ndarray) -> np.ndarray:
        """Return the chance of each leg to take no longer than ``durations`` [s]."""
        excess = durations - self.least
        spread, delay = self._spread, self._delay
        usual = special.ndtr(excess / spread) - np.exp(0.5 * (spread / delay) ** 2 - excess / delay
                                                       + special.log_ndtr(excess / spread - spread / delay))
        late = np.maximum(0.0, excess) * self._shape / self._tail_mean
        tail = special.gammainc(self._shape, late)
        for_turn = special.gammainc(self._shape, late / np.maximum(self._left(excess), 1e-12))
        return (1.0 - self.tail) * usual + self._for_turn * for_turn + (self.tail - self._for_turn) * tail

    def _left(self, excess: np.ndarray) -> np.ndarray:
        """Return the share that is left of the largest possible tail for the turn, at most 1."""
        return np.minimum(1.0, 1.0 - excess / self._most)

    def quantile(self, share: float) -> np.ndarray:
        """Return the quantile of each leg's duration [s] at ``share`` (0 to 1), by bisection."""
        low = self.least - 10.0 * self._spread
        high = self.least + 40.0 * (self._tail_mean + self._spread + self._delay)
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = self.share_below(middle) < share
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return 0.5 * (low + high)
