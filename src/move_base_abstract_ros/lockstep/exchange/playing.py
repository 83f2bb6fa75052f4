"""Played output: messages that the time master makes and sends in the participant's place, between its turns.

Feedback, poses, heartbeats and the status follow from the instant and from how the robots move. So a report has the
first message of each such series, what differs in the later ones, and the motions. The next grant says how far this was
played.
To learn what a series sends, its action is done once while this module records: nothing is sent then, and nothing that
says what was sent last may change.
"""
from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.lockstep import wire

from .links import sender

if TYPE_CHECKING:
    from move_base_abstract.engine.event_queue import Series

    from ...clocks.lockstep_clock import LockstepClock
    from ...messages.packing import Pack

_MOVING = (wire.Slot.POSE, wire.Slot.TWIST)
_SLOT = struct.Struct('<BI')
# An onlooker that comes hears a topic from the participant's next turn on, so turns must not be too far apart.
_LONGEST_NS = 2 * NS_PER_S


class NotPlayable(Exception):
    """A message cannot be played: an onlooker hears it, or it follows from more than the instant and the motion."""


class Play(NamedTuple):
    """A message of a series: rospy's publisher, where it goes, its bytes, what differs in later ones, and how often."""

    impl: Any
    address: Tuple[int, int, Tuple[int, ...]]  # the number of its topic, sub, targets
    payload: bytes
    slots: bytes
    is_once: bool  # not if one of its topic and robot has been sent at this instant
    moves: bool  # whether it has slots of the motion

    def items(self, first_ns: int, period_ns: int) -> List[bytes]:
        """Return the items of a report, if the first message is due at ``first_ns`` [ns]."""
        topic, sub, targets = self.address
        return [wire.play(topic, sub, target, self.is_once, self.impl.seq + 1, first_ns, period_ns, self.payload,
                          self.slots) for target in targets]


class Mover(NamedTuple):
    """A robot: its name, what it drives (None: it stands), and how that is said in MOTION."""

    name: str
    motion: Callable[[], Any]
    packed: Callable[[Any], bytes]


class _Recording:
    """What the action that is being done would send; ``plays`` is None outside of a recording."""

    plays: Optional[List[Play]] = None
    before_ns = wire.NEVER


_recording = _Recording()
_movers: Dict[int, Mover] = {}  # {index: robot of this process}


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


def note(impl: Any, pack: Pack) -> None:
    """Record the message that ``pack`` makes for rospy's publisher ``impl``.

    :raises NotPlayable: if it cannot be played.
    """
    slots = getattr(pack, 'slots', None)
    link = impl.connections[0]
    if slots is None or len(impl.connections) > 1 or impl.closed or not hasattr(link, 'address'):
        raise NotPlayable(impl.resolved_name)
    address = link.address()
    moves = any(kind in _MOVING for kind, _ in slots) and _movers[address[1]].motion() is not None
    if not moves:
        slots = [slot for slot in slots if slot[0] not in _MOVING]  # of a robot that stands: they stay
    elif pack.is_shifted:  # type: ignore[attr-defined]
        raise NotPlayable(impl.resolved_name)
    assert _recording.plays is not None
    _recording.plays.append(Play(impl, address, pack(impl.seq + 1), b''.join([_SLOT.pack(*slot) for slot in slots]),
                                 pack.is_once, moves))  # type: ignore[attr-defined]


class Player:
    """Has the output of one participant played. The calling thread must have the turn."""

    def __init__(self, source: LockstepClock) -> None:
        self._source = source
        self._played: List[Tuple[int, Series, List[Play]]] = []  # with the instant of the first message [ns]
        self._moving: Dict[int, Any] = {}  # {index of a robot: its motion that was told last}

    def tell(self, now_ns: int, before_ns: int, items: List[Any]) -> int:
        """Append what is played before ``before_ns`` [ns] to the report's ``items``; return when it ends [ns]."""
        heard, before_ns = self._source.heard_output(before_ns)
        found = []
        for due_ns, series in heard:
            plays, end_ns = self._record(due_ns, series)
            if plays is None:
                before_ns = min(before_ns, due_ns)
                continue
            end_ns = max(due_ns, min(end_ns, now_ns + _LONGEST_NS))
            before_ns = min(before_ns, due_ns - (due_ns - end_ns) // series.period_ns * series.period_ns)
            found.append((due_ns, series, plays))
        self._played = [one for one in found if one[0] < before_ns]
        for _due_ns, _series, plays in self._played:
            for sub in [play.address[1] for play in plays if play.moves]:
                self._tell_motion(sub, items)
        items += [item for due_ns, series, plays in self._played for play in plays
                  for item in play.items(due_ns, series.period_ns)]
        return before_ns

    def _record(self, due_ns: int, series: Series) -> Tuple[Optional[List[Play]], int]:
        """Return what the series sends at ``due_ns`` [ns], None: it cannot be played; and until when it holds [ns]."""
        _recording.plays, _recording.before_ns = [], wire.NEVER
        try:
            with sender(None):
                self._source.tell(due_ns, series)
            return _recording.plays, _recording.before_ns
        except Exception:  # if it is an error, it is raised again in its own turn
            return None, wire.NEVER
        finally:
            _recording.plays = None

    def _tell_motion(self, sub: int, items: List[Any]) -> None:
        mover = _movers[sub]
        motion = mover.motion()
        if self._moving.get(sub) is not motion:
            self._moving[sub] = motion
            items.append(wire.motion(sub, mover.name, mover.packed(motion)))

    def happened(self, until_ns: int) -> None:
        """Go on after ``until_ns`` [ns], up to which all has been played; nothing more will be."""
        played, self._played = self._played, []
        last = []
        for due_ns, series, plays in played:
            if due_ns <= until_ns:
                count = (until_ns - due_ns) // series.period_ns
                for play in plays:
                    play.impl.seq += count + 1
                last.append((due_ns + count * series.period_ns, series))
        last.sort(key=lambda one: one[0])
        self._source.played(until_ns, last)
