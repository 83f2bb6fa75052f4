"""A warning and a label for each place at which a program does what lockstep cannot follow, with file and line.

Places that are noticed before the program takes part are reported when it does.
"""
from __future__ import annotations

import threading
from typing import Any, Dict, Optional, Tuple

import rospy


class NoticedPlaces:
    """The participant of this process, and the places that have been noticed."""

    def __init__(self) -> None:
        self.participant: Any = None
        self._places: Dict[Tuple[str, str, int, str], bool] = {}
        # an ordinary lock, not one that gives the turn away
        self._lock = threading._allocate_lock()  # type: ignore[attr-defined]

    def follow(self, participant: Any) -> None:
        """Report to ``participant`` from now on; None if the time master is not in lockstep any more."""
        self.participant = participant
        for place in list(self._places):
            self._say(place)

    def is_ordered(self) -> bool:
        """Return whether the actions of the calling thread have the same order in each run."""
        participant = self.participant
        if participant is None:
            return threading.current_thread() is threading.main_thread()
        return participant.scheduler.is_mine()

    def is_over(self) -> bool:
        """Return whether the run is over, or about to be, so that nothing decides its result any more."""
        participant = self.participant
        return participant is not None and (participant.scheduler.is_closed or rospy.core.is_shutdown_requested())

    def tell(self, frame: Any, what: str, why: str) -> None:
        """Report once that the code of ``frame`` does ``what``; ``why`` says why that is not repeatable.

        If ``frame`` is None, do nothing.
        """
        if frame is not None:
            self.tell_place((frame.f_code.co_filename, frame.f_lineno), what, why)

    def tell_place(self, place: Optional[Tuple[str, int]], what: str, why: str) -> None:
        """Report once that ``what`` is done at ``place`` (file, line). If ``place`` is None, do nothing."""
        if place is None or self.is_over():
            return
        noticed = (what, *place, why)
        with self._lock:
            if noticed in self._places:
                return
            self._places[noticed] = True
        if self.participant is not None:
            self._say(noticed)

    def _say(self, place: Tuple[str, str, int, str]) -> None:
        participant = self.participant
        if participant is not None:
            text = '{} in {}, line {}: {}'.format(*place)
            rospy.logwarn('%s: %s', participant.members.own_name, text)
            participant.label(text)


#: the labels of this process
told = NoticedPlaces()
