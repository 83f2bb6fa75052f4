"""What a run in lockstep is told of who hears the robots of a process: rates, and who listens in vain."""
import rospy

from move_base_abstract.lockstep import wire

from ..messages import outlets


class Hearers:
    """Of one ``participant`` (Participant), whose turn the caller has."""

    def __init__(self, participant):
        self._participant = participant
        self._silent_to = set()
        self._looked_at = {}  # (robot's index, parameter): outlets.changes() when hearers were looked at
        self._rates = None
        self._is_rates_note_due = False

    def falls_silent(self, robot, teller, parameter):
        """Name once each of ``teller.hearers()``, (topic, node), to whom ``robot`` says nothing: ``parameter`` is 0."""
        changes = outlets.changes()
        if self._looked_at.get((robot.index, parameter)) == changes:
            return
        self._looked_at[robot.index, parameter] = changes
        for hearer in teller.hearers():
            if hearer not in self._silent_to:
                self._silent_to.add(hearer)
                topic, node = hearer
                rospy.logwarn('%s: %s listens to %s, which says nothing on the way: %s is 0', rospy.get_name(), node,
                              topic, parameter)
                if self._participant.members.is_member(node):
                    self._participant.log(robot.name, 'listens_in_vain', (node, topic, parameter), sub=robot.index)

    def show_rates(self, text):
        """Have the state say ``text()``: what is told at which rate, and to whom."""
        self._rates = text

    def rates_changed(self):
        """What :meth:`show_rates` says has changed."""
        if self._rates is not None and not self._is_rates_note_due:
            self._is_rates_note_due = True
            self._participant.add(self._rates_note)

    def _rates_note(self):
        self._is_rates_note_due = False
        return wire.note(wire.NoteKind.TELLS, self._rates())


class NoHearers:
    """As of :class:`Hearers` on the scaled clock, where no run is to be told; what is off was switched off by name."""

    def falls_silent(self, _robot, _teller, _parameter):
        """Tell nobody."""

    def show_rates(self, _text):
        """Tell nobody."""

    def rates_changed(self):
        """Tell nobody."""
