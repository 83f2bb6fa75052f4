"""Find a set of decisions that still fails, but not without any one of them: delta debugging, ddmin.

Zeller, Hildebrandt: Simplifying and isolating failure-inducing input. IEEE Trans. on Software Engineering 28, 2002.
"""
from __future__ import annotations

from typing import Callable, List, Optional, Sequence, Tuple

#: takes candidates; returns (the place of the first that fails, those of its names that occurred in its run), or None
Try = Callable[[List[List[str]]], Optional[Tuple[int, List[str]]]]


def ddmin(names: Sequence[str], first_failing: Try) -> List[str]:
    """Return some of the names that still fail together, and of which none can be left out by itself.

    first_failing: finds the first of several candidates that fails, in their order. It may try several at once.
    """
    left, parts = list(names), 2
    while left:
        parts = min(parts, len(left))
        chunks = [left[k * len(left) // parts:(k + 1) * len(left) // parts] for k in range(parts)]
        candidates = chunks if parts > 1 else []
        others = [[name for name in left if name not in set(chunk)] for chunk in chunks]
        candidates = candidates + (others if parts != 2 else [])
        found = first_failing(candidates)
        if found is not None:
            number, there = found
            kept = set(there)
            left = [name for name in candidates[number] if name in kept]
            parts = 2 if number < len(chunks) and parts > 1 else max(2, parts - 1)
        elif parts >= len(left):
            break
        else:
            parts *= 2
    return left
