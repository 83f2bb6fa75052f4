"""Played output: messages that the time master makes and sends in the participant's place, between its turns.

Feedback, poses, heartbeats and the status follow from the instant and from how the robots move. So a report has the
first message of each such series, what differs in the later ones, and the motions. Messages of other series (scans,
batteries, shifted poses) are told one by one. The next grant says how far this was played.
To learn what a series sends, its action is done while this module records: nothing is sent then, and nothing that says
what was sent last may change.
"""
from __future__ import annotations

import struct
from contextlib import contextmanager
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep import wire

from .links import sender

if TYPE_CHECKING:
    from move_base_abstract.engine.series import Series

    from ...clocks.lockstep_clock import LockstepClock
    from ...messages.packing import Pack

#: {kind of a slot of a motion: what is added to the robot's index}
_MOVING = {wire.Slot.POSE: 0, wire.Slot.TWIST: 0, wire.Slot.ODOM_POSE: wire.ODOMETRY,
           wire.Slot.ODOM_TWIST: wire.ODOMETRY, None: 0}
_SLOT = struct.Struct('<BI')
# An onlooker that comes hears a topic from the participant's next turn on, so turns must not be too far apart.
_LONGEST_NS = 2 * NS_PER_S
# How many messages of a series are told one by one; those that do not come to pass were made in vain.
_MOST, _FEWEST = 64, 4
# To tell a series costs about as much as to send three messages. If fewer come to pass _SHORT times in turn, as with
# commands at a rate, nothing is played for _PAUSE turns.
_WORTH, _SHORT, _PAUSE = 3, 4, 16


class NotPlayable(Exception):
    """A message cannot be told beforehand, for example because an onlooker hears it."""


class Play(NamedTuple):
    """A message of a series: rospy's publisher, where it goes, its bytes, what differs in later ones, and how often."""

    impl: Any
    address: Tuple[int, int, Tuple[int, ...]]  # the number of its topic, sub, targets
    number: int
    payload: bytes
    slots: Optional[bytes]  # None: later ones are told one by one
    is_once: bool  # not if one of its topic and robot has been sent at this instant
    moves: Sequence[int]  # the indices of the motions of which it has slots


class Stretch(NamedTuple):
    """What is played of a series: its place in the order, when, how often (NEVER: once), and the messages."""

    place: int
    first_ns: int
    period_ns: int
    depth: int  # how many messages of the series were told before
    series: Series
    plays: List[Play]


class Mover(NamedTuple):
    """A robot: its name, what it drives (None: it stands), and how that is said in MOTION; or its odometry."""

    name: str
    motion: Callable[[], Any]
    packed: Callable[[Any], bytes]


class _Recording:
    """What the action that is being done would send; ``plays`` is None outside of a recording."""

    plays: Optional[List[Play]] = None
    before_ns = wire.NEVER
    numbers: Dict[Any, int] = {}  # {rospy's publisher: the number of its last message that was recorded}


_recording = _Recording()
_movers: Dict[int, Mover] = {}  # {index: robot of this process}; with ODOMETRY added: its odometry


def follow(index: int, mover: Mover) -> None:
    """Play poses and velocities of the robot with ``index``, too."""
    _movers[index] = mover


def is_recording() -> bool:
    """Return whether nothing is to be sent or kept, see the module."""
    return _recording.plays is not None


def holds_before(instant_ns: int) -> None:
    """Note that what is being recorded holds before ``instant_ns`` [ns] only."""
    _recording.before_ns = min(_recording.before_ns, instant_ns)


def refuse() -> None:
    """Say that what is being done cannot be played. Do nothing outside of a recording.

    :raises NotPlayable: in a recording.
    """
    if is_recording():
        raise NotPlayable()


@contextmanager
def _counting(impl: Any) -> Iterator[None]:
    """Give a context in which the number of ``impl``'s last message holds: rospy's thread changes it to greet."""
    impl.acquire()
    try:
        yield
    finally:
        impl.release()


def note(impl: Any, pack: Pack) -> None:
    """Record the message that ``pack`` makes for rospy's publisher ``impl``.

    :raises NotPlayable: if it cannot be played.
    """
    slots: Any = getattr(pack, 'slots', None)
    link = impl.connections[0]
    if len(impl.connections) > 1 or impl.closed or not hasattr(link, 'address'):
        raise NotPlayable(impl.resolved_name)
    address = link.address()
    movers = dict.fromkeys(address[1] + _MOVING[kind] for kind, _ in slots or () if kind in _MOVING)
    moves = [mover for mover in movers if _movers[mover].motion() is not None]
    if moves and any(kind is None for kind, _ in slots):  # packing.SHIFTED
        slots, moves = None, []
    elif slots is not None and not moves:
        slots = [slot for slot in slots if slot[0] not in _MOVING]  # of a robot that stands: they stay
    with _counting(impl):
        number = _recording.numbers[impl] = _recording.numbers.get(impl, impl.seq) + 1
    assert _recording.plays is not None
    _recording.plays.append(Play(impl, address, number, pack(number), None if slots is None else b''.join(
        [_SLOT.pack(*slot) for slot in slots]), getattr(pack, 'is_once', False), moves))


class Player:
    """Has the output of one participant played, if it ``plays``. The calling thread must have the turn."""

    def __init__(self, source: LockstepClock, plays: bool = True) -> None:
        self._source = source
        self._played: List[Stretch] = []
        self._plays = plays
        self._most = _MOST
        self._short = 0  # stretches in turn that were not worth it
        self._pause = 0  # turns in which nothing is played
        self._moving: Dict[int, Any] = {}  # {index of a robot: its motion that was told last}

    def tell(self, now_ns: int, before_ns: int, items: List[Any]) -> int:
        """Append what is played before ``before_ns`` [ns] to the report's ``items``; return when it ends [ns]."""
        with self._source.lock:
            heard, before_ns = self._source.simulation.queue.heard_output(before_ns)
        if self._pause or not self._plays:
            self._pause = max(self._pause - 1, 0)
            return min([before_ns, *[due_ns for due_ns, _ in heard]])
        _recording.numbers = {}
        due = [(due_ns, place, 0) for place, (due_ns, _) in enumerate(heard)]
        heapify(due)
        found = []
        while due and due[0][0] < before_ns:
            due_ns, place, depth = heappop(due)
            series = heard[place][1]
            plays, end_ns = None, 0
            if depth < self._most and due_ns < now_ns + _LONGEST_NS:
                plays, end_ns = self._record(due_ns, series)
            if plays is None:
                before_ns = due_ns
            elif any(play.slots is None for play in plays):
                found.append(Stretch(place, due_ns, wire.NEVER, depth, series, plays))
                heappush(due, (due_ns + series.period_ns, place, depth + 1))
            else:
                end_ns = max(due_ns, min(end_ns, now_ns + _LONGEST_NS))
                before_ns = min(before_ns, due_ns - (due_ns - end_ns) // series.period_ns * series.period_ns)
                found.append(Stretch(place, due_ns, series.period_ns, 0, series, plays))
        self._played = sorted(one for one in found if one.first_ns < before_ns)
        for one in self._played:
            for play in one.plays:
                topic, sub, targets = play.address
                for mover in play.moves:
                    self._tell_motion(mover, items)
                items += [wire.play(topic, sub, target, play.is_once, play.number, one.first_ns, one.period_ns,
                                    play.payload, play.slots or b'') for target in targets]
        return before_ns

    def _record(self, due_ns: int, series: Series) -> Tuple[Optional[List[Play]], int]:
        """Return what the series sends at ``due_ns`` [ns], None: it cannot be played; and until when it holds [ns]."""
        _recording.plays, _recording.before_ns = [], wire.NEVER
        try:
            with self._source.lock, sender(None):
                self._source.simulation.tell(due_ns, series)
            return _recording.plays, _recording.before_ns
        except Exception:  # if it is an error, it is raised again in its own turn
            return None, wire.NEVER
        finally:
            _recording.plays = None

    def _tell_motion(self, sub: int, items: List[Any]) -> None:
        name, motion, packed = _movers[sub]
        leg = motion()
        if self._moving.get(sub) is not leg:
            self._moving[sub] = leg
            items.append(wire.motion(sub, name, packed(leg)))

    def happened(self, until_ns: int) -> None:
        """Go on after ``until_ns`` [ns], up to which all has been played; nothing more will be."""
        if not self._played:
            return
        played, self._played = self._played, []
        last: Dict[Series, int] = {}
        depth, is_cut, messages = 0, False, 0
        for one in played:
            if one.first_ns <= until_ns:
                count = (until_ns - one.first_ns) // one.period_ns
                messages += count + 1
                for play in one.plays:
                    with _counting(play.impl):
                        play.impl.seq += count + 1
                last[one.series] = one.first_ns + count * one.period_ns
                depth = max(depth, one.depth)
            else:
                is_cut = is_cut or one.period_ns == wire.NEVER
        self._short = self._short + 1 if messages < _WORTH * len({one.place for one in played}) else 0
        self._pause = _PAUSE if self._short >= _SHORT else 0
        self._most = max(depth + 2, _FEWEST) if is_cut else min(2 * self._most, _MOST)
        self._source.played(until_ns, sorted(((due_ns, series) for series, due_ns in last.items()),
                                             key=lambda one: one[0]))
