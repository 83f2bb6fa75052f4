"""The program's own loops that wait by looking at variables: ``while len(frontiers) < 1: pass``.

:mod:`own_code` has such loops call :class:`Turns` each time round. Whose turns do nothing but look gives the turn of
its thread away after :data:`loops.LOOKS` of them in a row, exactly as those that look at rospy. One whose turns call
something unknown may compute; after :data:`PATIENCE` in a row it is taken for one that waits, with a warning and a
label. So is one that computes, but nothing that would end it, after :data:`LONG_PATIENCE`.
"""
import builtins
import sys

import rospy

from move_base_abstract.lockstep.instrument import ACT, CALLS, COMPUTES, LOOK, TIMES
from move_base_abstract.lockstep.loops import LOOKS, STEP_NS, TIME_STEP_NS
from move_base_abstract.lockstep.scheduler import TurnLost

#: so many turns in a row, without a wait and without anything that is sent, of a loop that may compute
PATIENCE = 1000000
#: the same of a loop that computes in each turn, but nothing that would end it
LONG_PATIENCE = 10000000


def install():
    """Have the program's loops look; to be called before its first line. Return what follows the participant."""
    turns = Turns()
    setattr(builtins, LOOK, turns.look)
    setattr(builtins, ACT, turns.act)
    return turns


class Turns:
    """What the program's loops call."""

    def __init__(self):
        self._participant = None
        self._waiting = set()
        self._late = 0

    def follow(self, participant):
        """The program takes part from now on."""
        self._participant = participant

    def look(self, kind, line):
        """Once more round a loop of this kind, which begins in this line."""
        participant = self._participant
        if participant is None:
            return
        scheduler = participant.scheduler
        if not scheduler.is_mine():
            if scheduler.is_closed and scheduler.current() is not None:
                self._end()
            return
        task = scheduler.turn()
        if kind == COMPUTES:
            task.idle_turns = 0
        elif task.idle_turns >= LOOKS and kind != CALLS:
            scheduler.look_away(TIME_STEP_NS if kind == TIMES else STEP_NS)
            return
        patience = LONG_PATIENCE if kind == COMPUTES else PATIENCE
        if task.turns % LOOKS == 0 and self._waits(task.turns, patience, sys._getframe(1).f_code.co_filename, line):
            scheduler.look_away(STEP_NS)

    def act(self, computes):
        """Such a loop is about to do more than look."""
        participant = self._participant
        if participant is not None and participant.scheduler.is_mine():
            task = participant.scheduler.current()
            task.idle_turns = 0
            if computes:
                task.turns = 0

    def _waits(self, turns, patience, filename, line):
        """Return whether the loop is one that waits: it has been called that, or is called that now."""
        place = filename, line
        if place not in self._waiting:
            if turns < patience:
                return False
            self._waiting.add(place)
            text = ('the loop in {}, line {}, went round {:,} times without a wait; it is taken for one that waits by '
                    'looking, and time goes on at it'.format(filename, line, patience))
            rospy.logwarn('%s: %s', rospy.get_name(), text)
            self._participant.label(text)
        return True

    def _end(self):
        """Lockstep is over: nothing that such a loop waits for will come. One that looks at rospy ends itself."""
        self._late += 1
        if self._late % LOOKS == 0 and rospy.core.is_shutdown():
            raise TurnLost()
