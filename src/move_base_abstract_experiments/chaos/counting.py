"""How many of the seeds fail, in words and in the file that runs the failure again."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, Optional, Tuple

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import first_of, shown

from .variation import Variation

_MOST_SEEDS = 10  # named, of one failure


@dataclass
class Count:
    """The seeds that fail: ``failed`` {seed: the name of its failure}, of ``seeds``, the first and the last one.

    ``delay``, ``starts``: those of a Variation; ``wanted``: the names of the failures that count; []: all.
    """

    seeds: Tuple[int, int]
    delay: Optional[float]
    starts: Optional[float]
    wanted: List[str]
    failed: Dict[int, str] = field(default_factory=dict)

    @property
    def variation(self) -> Variation:
        """What the seeds vary."""
        return Variation(self.delay, self.starts)

    @property
    def size(self) -> int:
        """The number of seeds."""
        return self.seeds[1] - self.seeds[0] + 1

    def said(self) -> str:
        """Return the count in words: "3 of 100 seeds fail: crash /a (6, 12), deadlock (40)"."""
        of_name: Dict[str, List[int]] = {}
        for seed, name in self.failed.items():
            of_name.setdefault(name, []).append(seed)
        kinds = [f'{name} ({_listed(seeds)})' for name, seeds in of_name.items()]
        return (f"{len(self.failed)} of {self.size} seed{'s' * (self.size != 1)} fail{'s' * (len(self.failed) == 1)}"
                + (f': {", ".join(kinds)}' if kinds else ''))

    def compared(self, before: Count) -> List[str]:
        """Return the lines that compare this count with that of the same seeds ``before`` a repair."""
        new = [seed for seed in self.failed if seed not in before.failed]
        return [f'before: {before.said()}', f'now:    {self.said()}',
                *([f'these fail now, and did not before: {_listed(new)}'] if new else [])]


def of_file(path: str, told: Dict[str, Any]) -> Count:
    """Return the Count that a Replay holds, from the file ``path``. :raises ConfigurationError: if it is none."""
    if not told:
        raise ConfigurationError(f'{path}: has no count of seeds; `chaos --count` writes one')
    try:
        first, last = map(int, told['seeds'])
        delay, starts = (None if told[key] is None else float(told[key]) for key in ('delay', 'starts'))
        failed = {int(seed): str(name) for seed, name in told['failed'].items()}
        return Count((first, last), delay, starts, list(map(str, told['wanted'])), failed)
    except (AttributeError, KeyError, TypeError, ValueError):
        raise ConfigurationError(f'{path}: count must be as `chaos --count` writes it; got {shown(told)}') from None


def _listed(seeds: List[int]) -> str:
    return first_of(list(map(str, seeds)), _MOST_SEEDS)
