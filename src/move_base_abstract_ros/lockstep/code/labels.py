"""A warning and a label for each place at which a program does what lockstep cannot follow, with file and line.

Places that are noticed before the program takes part are reported when it does.
"""
from __future__ import annotations

import sys
import threading
from typing import Any, Dict, Optional, Tuple

import rospy

#: why numbers of processes and connections label a run
NUMBER = 'is another number in another run'


class NoticedPlaces:
    """The participant of this process, and the places that have been noticed."""

    def __init__(self) -> None:
        self.participant: Any = None
        self._texts: Dict[str, bool] = {}
        # an ordinary lock, not one that gives the turn away
        self._lock = threading._allocate_lock()  # type: ignore[attr-defined]

    def follow(self, participant: Any) -> None:
        """Report to ``participant`` from now on; None if the time master is not in lockstep any more."""
        self.participant = participant
        for text in list(self._texts):
            self._say(text)

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
        if place is not None and not self.is_over():
            self.tell_text('{} in {}, line {}: {}'.format(what, *place, why))

    def tell_text(self, text: str) -> None:
        """Warn of ``text`` once, and label the run with it."""
        with self._lock:
            if text in self._texts:
                return
            self._texts[text] = True
        self._say(text)

    def _say(self, text: str) -> None:
        participant = self.participant
        if participant is not None:
            _warn('{}: {}'.format(participant.members.own_name, text))
            participant.label(text)


def _warn(text: str) -> None:
    """Print a warning; inside rospy.init_node, where rospy's own output needs a time that is not there yet, too."""
    if rospy.rostime.is_rostime_initialized():
        rospy.logwarn('%s', text)
    else:
        print(text, file=sys.stderr, flush=True)


#: the labels of this process
told = NoticedPlaces()
