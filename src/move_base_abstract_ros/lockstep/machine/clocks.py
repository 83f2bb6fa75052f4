"""Python's clocks as the program sees them. They go on with simulated time, from the program's first line on."""
from __future__ import annotations

import datetime
import sys
import time
from functools import partial
from typing import TYPE_CHECKING, Any, Callable, MutableSequence, Optional

from move_base_abstract.common.units import NS_PER_S, seconds_to_ns
from move_base_abstract.lockstep import machine_view as view
from move_base_abstract.lockstep.loops import TIME_STEP_NS

from ...replacing.replaced import replace
from ..code.callers import asker, is_own, sees_run
from ..code.labels import told

if TYPE_CHECKING:
    from move_base_abstract.lockstep.machine_view import SeenClocks

_STRAY = 'reads a clock in a thread that lockstep does not order'
_KINDS = {'time': view.DATE, 'monotonic': view.UPTIME, 'perf_counter': view.UPTIME, 'process_time': view.PROCESSOR,
          'thread_time': view.PROCESSOR, 'clock_gettime': None}
_SPLIT = ('localtime', 'gmtime', 'ctime')  # without an argument they are about the present


def install(seed: int, is_simulated: bool, slept_ns: MutableSequence[int]) -> _Clocks:
    """Make the program see the run's clocks, from before its first line. Return these clocks.

    ``seed`` is the run's; ``is_simulated`` says whether time.sleep takes simulated time; ``slept_ns`` is that of
    :class:`.SeenClocks`.
    """
    clocks = _Clocks(view.SeenClocks(seed, is_simulated, slept_ns))
    for name, kind in _KINDS.items():
        for suffix, in_unit in (('', lambda ns: ns / NS_PER_S), ('_ns', lambda ns: ns)):
            replace('time.{}{}'.format(name, suffix),
                    lambda machine, kind=kind, in_unit=in_unit: _Clock(clocks, kind, machine, in_unit))
    for name in _SPLIT:
        replace('time.' + name, lambda machine: _Split(clocks, machine, machine, 0))
    for name, place in (('time.asctime', 0), ('time.strftime', 1)):
        replace(name, lambda machine, place=place: _Split(
            clocks, machine, time.localtime.machine, place))  # type: ignore[attr-defined]
    return clocks


def sleep_ns(seconds: float) -> int:
    """Return the length of a sleep [ns], at least 1: a loop that sleeps for the rest of a time must come to its end."""
    return max(1, seconds_to_ns(seconds))


class _Clocks:
    """The clocks, and what they show to the code that reads them."""

    def __init__(self, clocks: SeenClocks) -> None:
        self._clocks = clocks

    def read(self, kind: str, frame: Any) -> Optional[int]:
        """Return what a clock of a kind shows [ns] to the code of a frame; None if it sees the machine's."""
        frame = asker(frame)
        if not sees_run(frame):
            return None
        participant = told.participant
        if told.is_ordered():
            if participant is None:
                self._clocks.look()
            else:
                participant.scheduler.look(TIME_STEP_NS)
        elif not is_own(frame):
            return None
        else:
            told.tell(frame, 'a clock', _STRAY)
            self._clocks.look()
        return self.now(kind)

    def now(self, kind: str) -> int:
        """Return what a clock of a kind shows [ns]; this does not count as a look of the program."""
        participant: Any = told.participant
        return self._clocks.read(kind, 0 if participant is None else participant.now_ns)

    def start(self, kind: str) -> int:
        """Return what a clock of a kind showed at the start [ns]."""
        return self._clocks.start(kind)

    def add_sleep(self, seconds: float) -> None:
        """Move the clocks on by ``seconds``, for which the program has slept in wall time."""
        self._clocks.add_sleep(sleep_ns(seconds) if seconds > 0 else 0)

    def date_ns(self, frame: Any) -> Optional[int]:
        """Return the date [ns] that the code of a frame sees; None if it sees the machine's."""
        return self.read(view.DATE, frame)

    def moment(self, kind: Any, name: str, frame: Any) -> Callable[..., Any]:
        """Return the function that replaces the method ``name``, which asks for the present, of ``kind``.

        ``kind`` is datetime or date, or derived from them; ``name`` is 'now', 'utcnow' or 'today'.
        """
        def present(zone: Optional[datetime.tzinfo] = None) -> Any:
            now_ns = self.read(view.DATE, frame)
            if now_ns is None:
                return getattr(kind, name)(*([] if zone is None else [zone]))
            seconds = now_ns / NS_PER_S
            if name == 'utcnow':
                return kind.fromtimestamp(seconds, datetime.timezone.utc).replace(tzinfo=None)
            return kind.fromtimestamp(seconds) if zone is None else kind.fromtimestamp(seconds, zone)
        return (lambda tz=None: present(tz)) if name == 'now' else partial(present, None)


class _Clock:
    """A clock of the module time, of a kind, or by its number in the kernel if the kind is None.

    It is not a function, so that it can be an attribute of a class, as the original.
    """

    __slots__ = ('_clocks', '_kind', '_machine', '_in_unit')

    def __init__(self, clocks: _Clocks, kind: Optional[str], machine: Callable[..., float],
                 in_unit: Callable[[int], float]) -> None:
        self._clocks, self._kind, self._machine, self._in_unit = clocks, kind, machine, in_unit

    def __call__(self, *clock_id: int) -> float:
        machine = self._machine(*clock_id)
        now_ns = self._clocks.read(self._kind or view.kind_of(*clock_id), sys._getframe(1))
        return machine if now_ns is None else self._in_unit(now_ns)


class _Split:
    """Replaces time.localtime and similar functions, which take the present if no time is given at ``place``."""

    def __init__(self, clocks: _Clocks, machine: Callable[..., Any], split: Callable[..., Any], place: int) -> None:
        self._clocks, self.machine, self._split, self._place = clocks, machine, split, place

    def __call__(self, *given: Any) -> Any:
        is_present = len(given) == self._place or self.machine is self._split and given == (None,)
        now_ns = self._clocks.read(view.DATE, sys._getframe(1)) if is_present else None
        if now_ns is None:
            return self.machine(*given)
        present = now_ns // NS_PER_S
        return self.machine(*given[:self._place], present if self.machine is self._split else self._split(present))


def is_moment(function: Any) -> bool:
    """Return whether a function is a method of datetime or date that asks for the present."""
    kind = getattr(function, '__self__', None)
    is_date = isinstance(kind, type) and issubclass(kind, datetime.date)
    return is_date and function.__name__ in ('now', 'utcnow', 'today')
