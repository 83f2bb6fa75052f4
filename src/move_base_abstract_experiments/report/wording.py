"""How the page writes numbers: with as many digits as their intervals justify, and with their units."""
from __future__ import annotations

import math
import unicodedata
from typing import TYPE_CHECKING, NamedTuple, Tuple

if TYPE_CHECKING:
    from .design import Metric
    from .intervals import Estimate

MINUS = '−'
NBSP = '\N{NO-BREAK SPACE}'
UNKNOWN = '–'
PLAIN_DIGITS = 4  # the digits of a number that has no interval
EXACT_DIGITS = 6  # the digits of a number that is the same in all trials
_TWO_DIGITS_BELOW = 2.95  # a half width that begins with less than this is given to two digits, otherwise to one
_MOST_DECIMALS = 6  # numbers that need more are written with a power of ten
_RAISED = str.maketrans('-0123456789', '⁻⁰¹²³⁴⁵⁶⁷⁸⁹')
_MORE = 3  # the most digits that are added so that a bound that is not 0 is not shown as 0
_SMALL_PLURALS = {'trials': 'trial', 'pairs': 'pair', 'replications': 'replication', 'configurations': 'configuration'}
#: units that read badly for large values: (the largest value from which on, factor, the other unit)
_LARGER = {
    'ns': ((1e9, 1e-9, 's'), (1e6, 1e-6, 'ms'), (1e3, 1e-3, 'µs')), 'us': ((1e6, 1e-6, 's'), (1e3, 1e-3, 'ms')),
    'µs': ((1e6, 1e-6, 's'), (1e3, 1e-3, 'ms')), 'ms': ((1e4, 1e-3, 's'),), 's': ((1e5, 1.0 / 3600.0, 'h'),),
    'm': ((1e5, 1e-3, 'km'),), 'B': ((1e9, 1e-9, 'GB'), (1e6, 1e-6, 'MB'), (1e3, 1e-3, 'kB')),
    'bytes': ((1e9, 1e-9, 'GB'), (1e6, 1e-6, 'MB')), 'J': ((1e5, 1e-3, 'kJ'),), 'Pa': ((1e5, 1e-3, 'kPa'),),
}
_PRETTY = {'us': 'µs', 'm2': 'm²', 'm^2': 'm²', 'm3': 'm³', 'm^3': 'm³', 'm/s2': 'm/s²', 'm/s^2': 'm/s²',
           'kPa2': 'kPa²', 'kPa^2': 'kPa²', 'percent': '%', 'deg': '°', '1': '', 'share': ''}


class Scale(NamedTuple):
    """The unit in which a metric is shown: shown value = factor * value in its own unit."""

    factor: float
    unit: str

    @property
    def suffix(self) -> str:
        """The unit as it follows a number."""
        return f'{NBSP}{self.unit}' if self.unit else ''

    @property
    def in_brackets(self) -> str:
        """The unit as it follows the metric's title, where the numbers have no unit of their own."""
        return f'{NBSP}[{self.unit}]' if self.unit else ''


def scale_of(metric: Metric, largest: float) -> Scale:
    """Return the Scale of a metric whose largest absolute value is ``largest``, in its own unit."""
    if metric.is_share:
        return Scale(100.0, '%')
    for bound, factor, unit in _LARGER.get(metric.unit, ()):
        if largest >= bound:
            return Scale(factor, unit)
    return Scale(1.0, _PRETTY.get(metric.unit, metric.unit))


def decimals_of(reach: float, *bounds: float) -> int:
    """Return the number of decimals of an interval with this half width; negative: to tens, hundreds, ..."""
    if not reach > 0.0 or math.isinf(reach):
        return 0
    exponent = math.floor(math.log10(reach))
    digits = 2 if reach / 10.0 ** exponent < _TWO_DIGITS_BELOW else 1
    least = digits - 1 - exponent
    for decimals in range(least, least + _MORE):
        if all(round(bound, decimals) != 0.0 for bound in bounds if bound != 0.0):
            return decimals
    return least + _MORE


def fixed(value: float, decimals: int) -> str:
    """Return a number with this many decimals, commas between thousands, and a true minus sign."""
    text = f'{round(value, decimals):,.{max(0, decimals)}f}'
    if float(text.replace(',', '')) == 0.0:
        text = text.lstrip('-')
    return text.replace('-', MINUS)


def digits(value: float, count: int = PLAIN_DIGITS) -> str:
    """Return a number with this many significant digits and without trailing zeros."""
    if math.isnan(value):
        return UNKNOWN
    if value == 0.0:
        return '0'
    if not 1e-4 <= abs(value) < 1e15:
        mantissa, _, exponent = f'{value:.{count - 1}e}'.partition('e')
        return f'{float(mantissa):g}·10'.replace('-', MINUS) + str(int(exponent)).translate(_RAISED)
    text = fixed(value, max(0, count - 1 - math.floor(math.log10(abs(value)))))
    return text.rstrip('0').rstrip('.') if '.' in text else text


def whole(number: int) -> str:
    """Return a whole number with commas between thousands."""
    return f'{number:,}'.replace('-', MINUS)


def counted(number: int, noun: str) -> str:
    """Return '1 trial', '30 trials'."""
    return f'{whole(number)} {_SMALL_PLURALS.get(noun, noun) if number == 1 else noun}'


def estimate_texts(estimate: Estimate, scale: Scale) -> Tuple[str, str, str]:
    """Return (value, low, high) of an Estimate as texts without unit; low and high are '' if there is no interval."""
    value, low, high = (each * scale.factor for each in estimate[:3])
    if math.isnan(value):
        return UNKNOWN, '', ''
    if math.isnan(low):
        return digits(value), '', ''
    if low == high:
        text = digits(value, 3 if scale.unit in ('%', 'percentage points') else EXACT_DIGITS)
        return text, text, text
    decimals = _decimals_of_estimate(value, low, high)
    if decimals > _MOST_DECIMALS:
        return digits(value, 2), digits(low, 2), digits(high, 2)
    return fixed(value, decimals), fixed(low, decimals), fixed(high, decimals)


def _decimals_of_estimate(value: float, low: float, high: float) -> int:
    reaches = [each for each in (value - low, high - value) if each > 0.0]
    return decimals_of(min((high - low) / 2.0, 2.0 * min(reaches)) if reaches else high - low, low, high)


def with_interval(estimate: Estimate, scale: Scale) -> str:
    """Return '612 s (598 to 626 s)'; without an interval '612 s', without a value a dash."""
    value, low, high = estimate_texts(estimate, scale)
    if value == UNKNOWN:
        return UNKNOWN
    if not low:
        return f'{value}{scale.suffix}'
    if estimate.method == 'constant':
        return f'{value}{scale.suffix} in all'
    return f'{value}{scale.suffix} ({low} to {high}{scale.suffix})'


def probability(p: float) -> str:
    """Return a probability as sentences have it: '= 0.03', '< 0.001'."""
    if math.isnan(p):
        return UNKNOWN
    if p < 0.001:
        return f'<{NBSP}0.001'
    return f'={NBSP}{min(p, 1.0):.2g}' if p < 0.0995 else f'={NBSP}{min(p, 1.0):.2f}'


def duration(seconds: float) -> str:
    """Return a duration in the unit in which it reads best."""
    if math.isnan(seconds):
        return UNKNOWN
    for size, unit in ((86400.0 * 2, 'days'), (3600.0 * 2, 'h'), (60.0 * 2, 'min')):
        if seconds >= size:
            return f'{digits(seconds * 2 / size, 3)}{NBSP}{unit}'
    return f'{digits(seconds, 3)}{NBSP}s'


def shortened(text: str, length: int) -> str:
    """Return a text that is at most ``length`` characters wide: a longer one loses its middle.

    Wide characters, as those of Chinese, count double.
    """
    if _width(text) <= length:
        return text
    keep = len(text)
    while keep > 2 and _width(text[:(keep + 1) // 2] + text[len(text) - keep // 2:]) >= length:
        keep = min(keep - 1, length)
    return f'{text[:(keep + 1) // 2]}…{text[len(text) - keep // 2:]}'


def _width(text: str) -> float:
    return sum(2 if unicodedata.east_asian_width(sign) in 'WF' else 1 for sign in text)
