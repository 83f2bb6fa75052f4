"""The form of numbers in the report's cells."""
from __future__ import annotations

import math
from typing import Any

UNKNOWN = 'unknown'
NOT_MEASURED = '–'
ROUNDING = 1e-9  # smaller numbers are rounding errors


def number(value: Any, unknown: Any = UNKNOWN) -> Any:
    """Return a number with four significant digits; rounding errors become 0."""
    if math.isnan(value):
        return unknown
    if math.isinf(value):
        return 'infinite'
    if abs(value) < ROUNDING:
        return '0'
    return f'{value:.4g}' if abs(value) < 1e4 else f'{value:.0f}'


def percent(share: float) -> Any:
    """Return a share in per cent, with its sign; rounding errors become 0."""
    if math.isnan(share):
        return UNKNOWN
    if abs(share) < ROUNDING:
        return '0 %'
    return f'{100.0 * share:+.3g} %' if abs(share) < 10.0 else f'{100.0 * share:+.0f} %'


def duration(ns: Any) -> str:
    """Return nanoseconds in the unit that is easiest to read."""
    for size, unit in ((10**9, 's'), (10**6, 'ms'), (10**3, 'µs')):
        if abs(ns) >= size:
            return f'{ns / size:.3g} {unit}'
    return f'{ns:.0f} ns'


def span(low: float, high: float) -> str:
    """Return an interval."""
    return f'{number(low)} to {number(high)}'


def change(each: Any) -> Any:
    """Return the relative error of a comparison.Difference, or its values if the first is 0 or one is unknown."""
    if math.isnan(each.first_mean) or math.isnan(each.second_mean):
        return f'{number(each.first_mean)} became {number(each.second_mean)}'
    if each.first_mean == 0.0 and each.second_mean != 0.0:
        return f'0 became {number(each.second_mean)}'
    return percent(each.relative)


def in_deviations(each: Any) -> Any:
    """Return the standardised difference of a comparison.Difference."""
    if math.isinf(each.standardised):
        return 'no scatter'
    if math.isnan(each.standardised):
        return f'{UNKNOWN} sd'
    return f'{each.standardised:+.2f} sd' if abs(each.standardised) > ROUNDING else '0 sd'


def similarity(value: Any) -> Any:
    """Return a cosine similarity with the digits of the published table."""
    return UNKNOWN if math.isnan(value) else f'{value:.9f}'


def range_of_similarity(low: float, high: float) -> Any:
    """Return the interval of a cosine similarity."""
    return UNKNOWN if math.isnan(low) else f'{low:.4f} to {high:.4f}'
