"""How a robot travels to its goal: it departs, is held, goes on, is placed elsewhere, and stands.

Threading contract: as of :mod:`.navigator`.
"""
import math

from ..engine.guard import guarded
from ..motion.geometry import Pose2D
from .events import Departed, Held, Stands, Warned
from .outcome import NO_CONTROL, aborted


class Travel:
    """One robot's travelling to the target that its ``navigator`` (Navigator) has found; what comes of it, that ends.

    ``agenda`` (Agenda): what both have ahead for the goal; ``durations``: GoalDurations, None: all goes by the law
    alone.
    """

    def __init__(self, navigator, robot, planner, agenda, stream, durations):
        self._navigator = navigator
        self._robot = robot
        self._planner = planner
        self._agenda = agenda
        self._tell = stream.tell
        self._durations = durations
        self._gate = None
        #: limited(start, corners, goal): the way with the speed limits that there are on it, None: there are none
        self.limited = None
        #: the pose in the global frame that the robot works on, or None
        self.target = None
        #: the reasons for which the robot is held, texts in the order in which they came; none: it may travel
        self.held_for = ()
        self._waits_for_release = False

    def set_gate(self, gate):
        """Ask ``gate`` at each departure whether the robot may go.

        ``departs(leg, now_ns)`` returns the reason (a text) for which it is held at once, or None; ``settle(now_ns)``
        is called when the one or the other has come to pass.
        """
        self._gate = gate

    def aim(self, target):
        """Have the robot work on ``target`` (Pose2D, global frame), None: on nothing any more."""
        self.target = target
        self._waits_for_release = False

    def _go_on(self, now_ns):
        """Go on to the target from where the robot stands; to give up takes as long as for a new goal."""
        self.go(() if self._planner.goes_straight else self._planner.corners(
            self._robot.pose_at(now_ns), self.target), now_ns)

    def go(self, corners, now_ns, aside=None):
        """Go to the target by ``corners``; None: there is no way. ``aside``: to this pose first, and on from there."""
        if corners is None:
            self._fail_to_plan(now_ns)
            return
        if self.held_for:
            self._waits_for_release = True
            return
        place = aside or self.target
        try:
            if self.limited is not None:
                corners = self.limited(self._robot.pose_at(now_ns), corners, place)
            leg = self._robot.depart(place, now_ns, corners, self._durations and self._durations.paced)
        except ValueError as error:
            self._navigator.end(aborted('The goal cannot be travelled to: {}'.format(error)), now_ns)
            return
        self._tell(Departed(now_ns, self._robot.name, place, leg.corners, leg.manner))
        gate = self._gate
        reason = None if gate is None else gate.departs(leg, now_ns)
        if reason is None:
            self._await_end(leg, aside is not None)
        else:
            self._hold(reason, now_ns)
        if gate is not None:
            gate.settle(now_ns)

    def go_aside(self, reason, way, now_ns):
        """Instead of being held for ``reason`` alone, drive by ``way`` (.corners, .goal) from where it stands.

        From its end, or wherever it is stopped before, the robot goes on to its target by a way that is new. It does
        not fail on it: that is judged by the ways to the target.
        """
        self._waits_for_release = False
        self._change_holds(tuple(one for one in self.held_for if one != reason), now_ns)
        self.go(way.corners, now_ns, _beyond(way.goal, self._robot.tolerances.xy))

    def _fail_to_plan(self, now_ns):
        refusal = self._planner.refusal_of_way(self._robot.pose_at(now_ns), self.target)
        if refusal:
            self._tell(Warned(now_ns, self._robot.name, refusal))
        self._navigator.give_up(now_ns)

    def _await_end(self, leg, is_aside):
        if is_aside:
            self._agenda.at(leg.arrive_ns, lambda due_ns, _now_ns: (self.halt(due_ns), self._go_on(due_ns)))
            return
        failure_ns = None if self._durations is None else self._durations.failure_ns(leg)
        if failure_ns is None:
            self._agenda.at(leg.arrive_ns, self._navigator.arrive)
        else:
            self._agenda.at(failure_ns, self._fail_on_the_way)

    def _fail_on_the_way(self, due_ns, _now_ns):
        self.halt(due_ns)
        text = self._durations.failure_text
        self._navigator.end(aborted(text) if text else NO_CONTROL, due_ns)

    @guarded
    def hold(self, reason, now_ns):
        """Have the robot stand at its exact pose of this instant for ``reason`` (a text), until :meth:`release`.

        Its goal stays active, and a new one is taken in, planned and waits. What is no travel goes on: a goal's frame
        is looked for, a goal without a way is given up. A reason that is there already changes nothing.
        """
        if reason not in self.held_for:
            self._hold(reason, now_ns)

    def _hold(self, reason, now_ns):
        self._change_holds((*self.held_for, reason), now_ns)
        leg = self._robot.leg
        if leg is not None:
            if self._durations is not None:
                self._durations.interrupted(leg, now_ns)
            self._agenda.clear()
            self.halt(now_ns)
            self._waits_for_release = True

    @guarded
    def release(self, reason, now_ns):
        """End what :meth:`hold` began for ``reason``; without any left the robot goes on, by a way that is new.

        A reason that is not there changes nothing.
        """
        if reason not in self.held_for:
            return
        self._change_holds(tuple(one for one in self.held_for if one != reason), now_ns)
        if self._waits_for_release and not self.held_for:
            self._waits_for_release = False
            self._go_on(now_ns)

    def change_way(self, now_ns, corners=None):
        """Leave the way under way; go on from where it is, from rest, by ``corners``, None: by a way that is new."""
        if self._durations is not None:
            self._durations.interrupted(self._robot.leg, now_ns)
        self._agenda.clear()
        self.halt(now_ns)
        if corners is None:
            self._go_on(now_ns)
        else:
            self.go(corners, now_ns)

    def forget_holds(self, now_ns):
        """Hold the robot, which has no goal, for nothing any more."""
        if self.held_for:
            self._change_holds((), now_ns)

    def _change_holds(self, holds, now_ns):
        self.held_for = holds
        self._tell(Held(now_ns, self._robot.name, holds))

    @guarded
    def place(self, pose, now_ns):
        """Put the robot at ``pose`` (global frame). With a goal under way, it goes on to it from there.

        One that is held stays so, and goes on from there when it is released.
        """
        driving = self._robot.leg is not None
        self._robot.place(pose, now_ns)
        self.tell_stands(now_ns)
        if driving:
            self._agenda.clear()
            self._go_on(now_ns)

    @guarded
    def map_changed(self, now_ns):
        """Another map counts from now on: a way that it cuts is planned again, from rest; so is one that there was not.

        One that waits for its release is planned then.
        Where no way has corners a map counts for the goals that come after it only.
        """
        planner = self._planner
        if planner.goes_straight or self.target is None or planner.lacking or self._waits_for_release:
            return
        pose, leg = self._robot.pose_at(now_ns), self._robot.leg
        if leg is None:
            corners = planner.corners(pose, self.target)
            if corners is not None:
                self._agenda.clear()
                self.go(corners, now_ns)
        elif not planner.is_clear([(pose.x, pose.y), *leg.corners_ahead(now_ns), (self.target.x, self.target.y)]):
            self._agenda.clear()
            self.halt(now_ns)
            self._go_on(now_ns)

    def halt(self, now_ns):
        """Have the robot stand, if it drives, and tell where."""
        if self._robot.leg is not None:
            self._tell(Stands(now_ns, self._robot.name, self._robot.stop(now_ns)))

    def tell_stands(self, now_ns):
        """Tell where the robot stands, for who has put it there."""
        self._tell(Stands(now_ns, self._robot.name, self._robot.pose_at(now_ns)))

    def break_off(self, error):
        """As of the navigator."""
        self._navigator.break_off(error)


def _beyond(pose, distance):
    """Return the Pose2D that is ``distance`` [m] ahead of ``pose``: who stops so far short of it ends there."""
    return Pose2D(pose.x + distance * math.cos(pose.yaw), pose.y + distance * math.sin(pose.yaw), pose.yaw)
