"""The order of the two values of a pair: it may be known where the limit of time cut values off and there is no mean.

A value that was cut off is a lower bound. It is larger than each complete value below it; its order to other values is
not known. Pairs of unknown order are left out. If nothing differed, the two values of a seed could be exchanged. That
turns the sign of a known pair, and makes no pair known or unknown. So the signs of the known pairs would be by chance,
and the test of signs is exact. (E. A. Gehan, Biometrika 52, 203, 1965, compares values that were cut off by the same
rule.)
"""
from __future__ import annotations

from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from . import intervals


class Order(NamedTuple):
    """The numbers of pairs in which the second value is larger, smaller, the same, or of unknown order."""

    larger: int
    smaller: int
    same: int
    unknown: int
    p: float
    against: tuple  # the groups in which most pairs have the opposite order to that of all pairs together

    @property
    def known(self) -> int:
        """The number of pairs whose order is known."""
        return self.larger + self.smaller + self.same


def signs(first: np.ndarray, second: np.ndarray, first_cut: np.ndarray,
          second_cut: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Return the order of each pair, and which pairs have values but no known order.

    The order is 1.0 if the second value is larger, -1.0 if it is smaller, 0.0 if both are the same, NaN if it is not
    known.

    :param first, second: values, NaN where there is none. :param first_cut, second_cut: whether each is a lower bound.
        All four have the same shape.
    """
    rows, _ = intervals.contrast((-1, 1), (first, second))
    found = np.sign(rows)
    is_hidden = (first_cut & second_cut) | (first_cut & ~second_cut & ~(rows < 0.0)) | (
        second_cut & ~first_cut & ~(rows > 0.0))
    return np.where(is_hidden, np.nan, found), is_hidden & ~np.isnan(rows)


def order_of(tables: Sequence[np.ndarray], cuts: Sequence[np.ndarray],
             groups: Sequence[Tuple[int, ...]]) -> Optional[Order]:
    """Return the Order of the second table's values against the first's, or None if no pair has a known order.

    :param tables, cuts: two values, and whether they are lower bounds; each of shape (groups, replications).
    :param groups: the group of configurations of each row.
    """
    found, is_hidden = signs(*tables, *cuts)
    if np.isnan(found).all():
        return None
    total = np.nansum(found)
    same, other, none = (int((found == sign).sum()) for sign in (1.0, -1.0, 0.0))
    against = tuple(group for group, row in zip(groups, found) if np.nansum(row) * total < 0.0)
    return Order(same, other, none, int(is_hidden.sum()), intervals.flip_test(np.nansum(found, axis=0)), against)


def turned(order: Optional[Order]) -> Optional[Order]:
    """Return an Order with first and second exchanged, in its groups too; None stays None."""
    return order and order._replace(larger=order.smaller, smaller=order.larger,
                                    against=tuple(group[::-1] for group in order.against))
