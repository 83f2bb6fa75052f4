"""The topics that the robots of a process publish at rates of simulated time, in words, for `why` and the state."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Dict, Iterable, List, Tuple

from ..common.shown import first_of

_SHOWN = 5  # names


@dataclass(frozen=True)
class Rate:
    """Something that one robot publishes at a rate; ``what`` names it, for example 'feedback'."""

    what: str
    #: returns the rate, in Hz of simulated time
    frequency: Callable[[], float]
    #: returns (topic, name of a node that subscribes to it), ..., see Outlet.hearers
    hearers: Callable[[], Iterable[Tuple[str, str]]]


class Rates:
    """The rates of one process; ``changed()`` is called when one comes or goes. The caller holds the clock's lock."""

    def __init__(self, changed: Callable[[], object]) -> None:
        self._rates: Dict[Rate, bool] = {}  # in the order in which they were added
        self.changed = changed

    def add(self, what: str, frequency: Callable[[], float],
            hearers: Callable[[], Iterable[Tuple[str, str]]]) -> Rate:
        """Add something that a robot publishes at a rate, and return its :class:`Rate`."""
        rate = Rate(what, frequency, hearers)
        self._rates[rate] = True
        self.changed()
        return rate

    def remove(self, rate: Rate) -> None:
        """Remove what the robot no longer publishes."""
        del self._rates[rate]
        self.changed()

    def text(self) -> str:
        """Return all rates with the subscribers, for example 'feedback at 20 Hz to nobody; tf at 10 Hz to /viewer'."""
        groups: Dict[Tuple[str, float], List[Dict[str, bool]]] = {}
        for rate in self._rates:
            names = {name: True for _topic, name in rate.hearers()}
            groups.setdefault((rate.what, rate.frequency()), []).append(names)
        return '; '.join(_line(what, frequency, robots) for (what, frequency), robots in groups.items())


def _line(what: str, frequency: float, robots: List[Dict[str, bool]]) -> str:
    heard = [names for names in robots if names]
    names = sorted({name for names in heard for name in names})
    share = ' of {} of {} robots'.format(len(heard), len(robots)) if 0 < len(heard) < len(robots) else ''
    rate = 'at {:g} Hz'.format(frequency) if frequency else 'not at a rate'
    return '{} {}{} to {}'.format(what, rate, share, first_of(names, _SHOWN) or 'nobody')
