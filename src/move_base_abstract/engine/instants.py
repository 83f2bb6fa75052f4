"""Finds the instant, to the nanosecond, at which a condition becomes true that then stays true."""
from __future__ import annotations

from typing import Callable, Optional, Tuple


def first_ns(begin_ns: int, end_ns: int, is_so: Callable[[int], bool], guess_ns: Optional[int] = None) -> int:
    """Return the first instant [ns] in ``begin_ns`` .. ``end_ns`` [ns] at which ``is_so(instant)`` is true.

    It must stay true from there on, and be true at ``end_ns``, for which it is not called. The search is by bisection
    and takes at most 62 calls. With a ``guess_ns`` [ns] that is off by n ns it takes some 2 log2(n) calls. The guess
    does not change the answer.
    """
    if guess_ns is not None:
        begin_ns, end_ns = _around(min(max(guess_ns, begin_ns), end_ns), begin_ns, end_ns, is_so)
    while begin_ns < end_ns:
        middle_ns = (begin_ns + end_ns) // 2
        if is_so(middle_ns):
            end_ns = middle_ns
        else:
            begin_ns = middle_ns + 1
    return end_ns


def _around(guess_ns: int, begin_ns: int, end_ns: int, is_so: Callable[[int], bool]) -> Tuple[int, int]:
    """Return a narrower (begin, end) [ns] in which the answer lies, found by growing steps from ``guess_ns`` [ns]."""
    step = 1
    if guess_ns == end_ns or is_so(guess_ns):
        end_ns = guess_ns
        while begin_ns < end_ns:
            before_ns = max(begin_ns, end_ns - step)
            if not is_so(before_ns):
                return before_ns + 1, end_ns
            end_ns = before_ns
            step *= 2
        return begin_ns, end_ns
    begin_ns = guess_ns + 1
    while begin_ns < end_ns:
        later_ns = min(begin_ns + step - 1, end_ns)
        if later_ns == end_ns or is_so(later_ns):
            return begin_ns, later_ns
        begin_ns = later_ns + 1
        step *= 2
    return begin_ns, end_ns
