"""The condition of a robot in addition to its pose: whether it is held or has failed, and its battery."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

if TYPE_CHECKING:
    from ..goals.navigator import Navigator
    from .failing import Failing


class Condition:
    """The condition of one robot; code that shows it only reads it.

    ``failing`` (:class:`.failing.Failing`) is None for a robot that never fails, ``battery``
    (:class:`.battery.Battery`) for one without a battery. ``quiet``: parts that show nothing but must be reset,
    restarted and closed with the others.
    """

    def __init__(self, navigator: Navigator, failing: Optional[Failing] = None, battery: Any = None,
                 quiet: Sequence[Any] = ()) -> None:
        self._navigator = navigator
        self.failing = failing
        self.battery = battery
        self._parts = [part for part in (failing, battery, *quiet) if part is not None]

    @property
    def is_ordinary(self) -> bool:
        """Whether there is nothing to show of the robot: it never fails, and has no battery."""
        return self.failing is None and self.battery is None

    @property
    def is_out_of_order(self) -> bool:
        """Whether the robot cannot work: it has failed and is not repaired yet, or its battery is empty."""
        return (self.failing is not None and self.failing.failure is not None
                or self.battery is not None and self.battery.is_empty)

    @property
    def state_text(self) -> str:
        """A few words for people about failure, empty battery and holds; '' if there are none."""
        failing = self.failing
        failed = ['failed: ' + failing.failure.kind] if failing is not None and failing.failure is not None else []
        empty = ['battery empty'] if self.battery is not None and self.battery.is_empty else []
        held = [reason for reason in self._navigator.travel.held_for
                if failing is None or not failed or reason != failing.REASON]
        return ', '.join(failed + empty + (['held: ' + ', '.join(held)] if held else []))

    def begin(self, now_ns: int) -> None:
        """Begin at ``now_ns`` [ns], when all parts of the robot and all listeners exist."""
        if self.battery is not None:
            self.battery.begin(now_ns)

    def reset(self, now_ns: int) -> None:
        """Reset all parts; the navigator has been reset, and the robot is placed at its start at ``now_ns`` [ns]."""
        for part in self._parts:
            part.reset(now_ns)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]; the navigator is next."""
        for part in self._parts:
            part.restart(by_ns)

    def close(self) -> None:
        """Note that the robot is removed."""
        for part in self._parts:
            part.close()
