"""The broken properties of many runs: the number of runs that broke each one, and the first of them."""
from __future__ import annotations

from typing import Any, Dict, Iterator, List, Tuple

from ..runs.built_in import BUILT_IN, SOMETIMES
from .statements import HELD


class Gathering:
    """Collects the broken properties of runs, one run after the other. ``runs``: the number of runs.

    ``rows``: a mapping for each property that some run has broken, with property, node, text and details (of the first
    break), runs (the number of runs that broke it), first_run, first_seed and first_instant_ns [ns]. ``sometimes``:
    {(node, text): (number of runs that made this statement, number of these in which it held)}.
    """

    def __init__(self) -> None:
        self.runs = 0
        self._rows: Dict[Tuple[str, ...], Dict[str, Any]] = {}
        self.sometimes: Dict[Tuple[str, str], Tuple[int, int]] = {}

    def take(self, name: str, seed: int, told: Dict[str, Any]) -> None:
        """Take the next run: its name, its seed, and the result of ``Judgement.told()``."""
        self.runs += 1
        seen = set()
        for one in told['broken']:
            is_built_in = one['property'] in BUILT_IN
            key = (one['property'],) if is_built_in else (one['property'], one['node'], one['text'])
            row = self._rows.setdefault(key, {
                **one, 'runs': 0, 'first_run': name, 'first_seed': seed, 'first_instant_ns': one['instant_ns']})
            row['runs'] += key not in seen
            seen.add(key)
        for node, kind, text, outcome in told['statements']:
            if kind == SOMETIMES:
                made, held = self.sometimes.get((node, text), (0, 0))
                self.sometimes[node, text] = made + 1, held + (outcome == HELD)

    @property
    def rows(self) -> List[Dict[str, Any]]:
        """The rows of all broken properties, in the order of their first breaks."""
        return list(self._rows.values())

    def never_held(self) -> List[Tuple[str, str]]:
        """Return (node, text) of each ``sometimes`` that held in no run."""
        return [key for key, (_, held) in self.sometimes.items() if not held]

    def lines(self) -> Iterator[str]:
        """Yield the lines of a report."""
        for row in self.rows:
            at = '' if row['first_instant_ns'] is None else ' at {:.9f} s'.format(row['first_instant_ns'] * 1e-9)
            yield 'broken in {} of {} runs, first in {} (seed {}){}: {}: {}: {}'.format(
                row['runs'], self.runs, row['first_run'], row['first_seed'], at, row['property'], row['node'],
                row['text'])
        for node, text in self.never_held():
            yield 'held in none of {} runs: {}: {}: {}'.format(self.runs, SOMETIMES, node, text)
