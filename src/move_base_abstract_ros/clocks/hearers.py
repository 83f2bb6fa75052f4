"""Report to a run in lockstep which nodes hear the robots of a process: at which rates, and which listen in vain."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Set, Tuple

import rospy

from move_base_abstract.lockstep import wire

from ..messages import outlets

if TYPE_CHECKING:
    from move_base_abstract.motion.robot import Robot


class Hearers:
    """Reports the hearers of one ``participant`` (Participant). The caller has its turn."""

    def __init__(self, participant: Any) -> None:
        self._participant = participant
        self._silent_to: Set[Tuple[str, str]] = set()  # (topic, node)
        # {(robot's index, parameter): outlets.changes() when hearers were looked at}
        self._looked_at: Dict[Tuple[int, str], int] = {}
        self._rates: Any = None
        self._is_rates_note_due = False

    def falls_silent(self, robot: Robot, teller: Any, parameter: str) -> None:
        """Warn once of each of ``teller.hearers()``, (topic, node), that gets nothing while ``robot`` drives.

        ``parameter``: the name of the parameter that is 0. If the node is a participant, the event log gets a row.
        """
        changes = outlets.changes()
        if self._looked_at.get((robot.index, parameter)) == changes:
            return
        self._looked_at[robot.index, parameter] = changes
        for hearer in teller.hearers():
            if hearer not in self._silent_to:
                self._silent_to.add(hearer)
                topic, node = hearer
                rospy.logwarn('%s: %s listens to %s, but nothing is published there while the robot drives: %s is 0',
                              rospy.get_name(), node, topic, parameter)
                if self._participant.members.is_member(node):
                    self._participant.log(robot.name, 'listens_in_vain', (node, topic, parameter), sub=robot.index)

    def show_rates(self, text: Callable[[], Any]) -> None:
        """Let ``text()`` be a part of the time master's state: it names the rates, and the nodes that hear them."""
        self._rates = text

    def rates_changed(self) -> None:
        """Note that the text of :meth:`show_rates` has changed. It is sent with the next report."""
        if self._rates is not None and not self._is_rates_note_due:
            self._is_rates_note_due = True
            self._participant.add(self._rates_note)

    def _rates_note(self) -> bytes:
        self._is_rates_note_due = False
        return wire.note(wire.NoteKind.TELLS, self._rates())


class NoHearers:
    """Takes the place of :class:`Hearers` on the scaled clock, and reports nothing: there is no run in lockstep.

    A rate of 0 needs no warning there, because only a parameter sets it.
    """

    def falls_silent(self, _robot: Robot, _teller: Any, _parameter: str) -> None:
        """Do nothing."""

    def show_rates(self, _text: Callable[[], Any]) -> None:
        """Do nothing."""

    def rates_changed(self) -> None:
        """Do nothing."""
