"""The program's own loops that wait by looking at variables, such as ``while len(frontiers) < 1: pass``.

:mod:`own_code` has such loops call :class:`Turns` in each iteration. If the iterations do nothing but look, by
themselves or by functions of the program, the thread gives its turn away after :data:`loops.LOOKS` of them in a row,
exactly as in a loop that looks at rospy. A loop that calls something unknown may compute; after :data:`PATIENCE`
iterations in a row it is taken for one that waits, with a warning and a label. The same holds, after
:data:`LONG_PATIENCE`, for a loop that computes, but nothing that would end it.
"""
from __future__ import annotations

import builtins
import sys
import types
from typing import Any, Callable, Dict, Set, Tuple

import rospy

from move_base_abstract.lockstep.instrument import ACT, CALLED, CALLS, COMPUTES, LOOK, TIMES
from move_base_abstract.lockstep.loops import LOOKS, STEP_NS, TIME_STEP_NS
from move_base_abstract.lockstep.task import TurnLost

from .labels import told

#: number of iterations in a row, without a wait and without sending anything, for a loop that may compute
PATIENCE = 1000000
#: the same for a loop that computes in each iteration, but nothing that would end it
LONG_PATIENCE = 10000000
#: {(file name, name, line): whether it can return without computing} of the program's functions that such loops may
#: call; if it can, it says so before it does more than look
LOOKING: Dict[Any, bool] = {}


def install() -> None:
    """Make the program's loops call this module, before its first line runs."""
    turns = Turns()
    setattr(builtins, LOOK, turns.look)
    setattr(builtins, ACT, turns.act)
    setattr(builtins, CALLED, turns.called)


class Turns:
    """The functions that the program's loops call."""

    def __init__(self) -> None:
        self._waiting: Set[Tuple[str, int]] = set()
        self._late = 0

    def look(self, kind: int, line: int) -> None:
        """Count an iteration of a loop of this ``kind``, which begins in this ``line``; it may give the turn away.

        :raises TurnLost: if lockstep is over, and the loop waits for ever.
        """
        participant = told.participant
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

    def act(self, computes: bool) -> None:
        """Note that such a loop is about to do more than look; ``computes`` says whether it computes."""
        participant = told.participant
        if participant is not None and participant.scheduler.is_mine():
            task = participant.scheduler.current()
            task.idle_turns = 0
            if computes:
                task.turns = 0

    def called(self, function: Callable[..., Any], is_known: bool) -> Callable[..., Any]:
        """Note that such a loop is about to call ``function``, and return it.

        is_known: whether functions with the name by which it is called only look, unless they are the program's own.
        """
        own = function.__func__ if type(function) is types.MethodType else function
        code = own.__code__ if type(own) is types.FunctionType else None
        place = code and (code.co_filename, code.co_name, code.co_firstlineno)
        if not LOOKING.get(place, is_known):
            self.act(False)
        return function

    def _waits(self, turns: int, patience: int, filename: str, line: int) -> bool:
        """Return whether the loop is taken for one that waits. The first time, warn and label the run."""
        place = filename, line
        if place not in self._waiting:
            if turns < patience:
                return False
            self._waiting.add(place)
            told.tell_text('the loop in {}, line {}, went round {:,} times without a wait; it is taken for one that '
                           'waits by looking, and time goes on at it'.format(filename, line, patience))
        return True

    def _end(self) -> None:
        """End a loop that waits, since nothing will come when lockstep is over. One that looks at rospy ends itself."""
        self._late += 1
        if self._late % LOOKS == 0 and rospy.core.is_shutdown():
            raise TurnLost()
