"""Which value of a pair is the larger one: where the limit of time cut values off, that may be known, and no mean is.

A value that was cut off is a lower bound: it is larger than each whole value that lies below it, and of all others it
is not known. Pairs of which it is not known are left out. If nothing differed, the two values of a seed could be
exchanged, which turns the sign of a pair that is known and makes no pair known or unknown: so the signs of those that
are known are as good as chance, and the test of signs is exact. (E. A. Gehan, Biometrika 52, 203, 1965, compares what
is cut off by the same rule.)
"""

from typing import NamedTuple

import numpy as np

from . import intervals


class Order(NamedTuple):
    """In how many pairs the second value is the larger one, the smaller one, the same; and of how many nobody knows."""

    larger: int
    smaller: int
    same: int
    unknown: int
    p: float
    against: tuple  # groups in which more pairs speak against what all of them say than for it

    @property
    def known(self):
        """The number of pairs whose order is known."""
        return self.larger + self.smaller + self.same


def signs(first, second, first_cut, second_cut):
    """Return per pair 1.0 where the second value is the larger one, -1.0, 0.0 (the same), or NaN: not known.

    :param first, second: values, NaN where there is none. :param first_cut, second_cut: whether one is a lower bound.
        All of one shape.
    """
    rows, _ = intervals.contrast((-1, 1), (first, second))
    found = np.sign(rows)
    is_hidden = (first_cut & second_cut) | (first_cut & ~second_cut & ~(rows < 0.0)) | (
        second_cut & ~first_cut & ~(rows > 0.0))
    return np.where(is_hidden, np.nan, found), is_hidden & ~np.isnan(rows)


def order_of(tables, cuts, groups):
    """Return the Order of the second table's values against the first's; None where that of no pair is known.

    :param tables, cuts: two of each, shape (groups, replications). :param groups: what each row is of.
    """
    found, is_hidden = signs(*tables, *cuts)
    if np.isnan(found).all():
        return None
    total = np.nansum(found)
    counts = [int((found == sign).sum()) for sign in (1.0, -1.0, 0.0)]
    against = tuple(group for group, row in zip(groups, found) if np.nansum(row) * total < 0.0)
    return Order(*counts, int(is_hidden.sum()), intervals.flip_test(np.nansum(found, axis=0)), against)


def turned(order):
    """Return an Order the other way round, its groups too."""
    return order and order._replace(larger=order.smaller, smaller=order.larger,
                                    against=tuple(group[::-1] for group in order.against))
