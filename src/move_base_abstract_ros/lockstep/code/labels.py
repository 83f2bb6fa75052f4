"""What a program does that lockstep cannot follow: a warning with file and line, and a label of the run, once a place.

What is noticed before the program takes part is told when it does.
"""
import threading

import rospy


class Told:
    """Who takes part, and the places that have been told."""

    def __init__(self):
        self.participant = None
        self._places = {}
        self._lock = threading._allocate_lock()  # the machine's own, whenever this is made

    def follow(self, participant):
        """The program takes part from now on; ``participant``: None if the time master is not in lockstep any more."""
        self.participant = participant
        for place in list(self._places):
            self._say(place)

    def is_ordered(self):
        """Return whether the calling thread does what it does in the same order in each run."""
        participant = self.participant
        if participant is None:
            return threading.current_thread() is threading.main_thread()
        return participant.scheduler.is_mine()

    def is_over(self):
        """Return whether the run is over, or about to be: what is done then decides nothing."""
        participant = self.participant
        return participant is not None and (participant.scheduler.is_closed or rospy.core.is_shutdown_requested())

    def tell(self, frame, what, why):
        """Tell once what the code of a frame does; nothing if there is none."""
        if frame is not None:
            self.tell_place((frame.f_code.co_filename, frame.f_lineno), what, why)

    def tell_place(self, place, what, why):
        """Tell once what is done at a place (file, line); nothing if there is none."""
        if place is None or self.is_over():
            return
        place = (what, *place, why)
        with self._lock:
            if place in self._places:
                return
            self._places[place] = True
        if self.participant is not None:
            self._say(place)

    def _say(self, place):
        participant = self.participant
        if participant is not None:
            text = '{} in {}, line {}: {}'.format(*place)
            rospy.logwarn('%s: %s', participant.members.own_name, text)
            participant.label(text)


#: of this process
told = Told()
