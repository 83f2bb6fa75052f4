"""How a robot travels to its goal: it departs, is held, goes on, is placed elsewhere, and stands.

Threading contract: that of :mod:`.navigator`.
"""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Callable, Optional, Sequence, Tuple, Union

from ..engine.guard import guarded
from ..motion.geometry import Pose2D
from .events import Abandoned, Departed, Drives, Held, Stands, Warned, motion_of, new
from .outcome import NO_CONTROL, aborted

if TYPE_CHECKING:
    from ..engine.alarm import Agenda
    from ..engine.stream import Stream
    from ..maps.planning import StraightLinePlanner
    from ..motion.attempts import GoalAttempts
    from ..motion.durations import GoalDurations
    from ..motion.leg import MotionLimits, Tolerances
    from ..motion.pieces import Motion
    from ..motion.robot import Robot
    from ..traffic.giving_way import WayBack
    from ..traffic.traveller import Traveller
    from .navigator import Navigator

    Corners = Sequence[Tuple[float, float]]


class Travel:
    """One robot's travel to the target that its ``navigator`` (Navigator) has found. The navigator ends the goal.

    ``agenda`` (Agenda): the future events of the goal, of both. ``durations``: GoalDurations; None: durations follow
    from the law of motion alone.
    """

    __slots__ = ('_navigator', '_arrive', '_robot', '_planner', '_agenda', '_tell', '_hearers', '_durations', '_gate',
                 'limited', 'to_spot', 'target', 'held_for', 'waits_for_release', 'drop_command')

    def __init__(self, navigator: Navigator, robot: Robot, planner: StraightLinePlanner, agenda: Agenda, stream: Stream,
                 durations: Optional[Union[GoalDurations, GoalAttempts]]) -> None:
        self._navigator = navigator
        self._arrive = navigator.arrive  # made once, not for each leg
        self._robot = robot
        self._planner = planner
        self._agenda = agenda
        self._tell, self._hearers = stream.tell, stream.hearers
        self._durations = durations
        self._gate: Optional[Traveller] = None
        #: limited(start, corners, goal) returns the way with its speed limits; None: there are no limits
        self.limited: Optional[Callable[[Pose2D, Corners, Pose2D], Corners]] = None
        #: to_spot(start, corners, end, is_aside) returns the way to where the robot has to stand, and its end; None:
        #: there are no spots
        self.to_spot: Optional[Callable[[Pose2D, Corners, Pose2D, bool], Tuple[Corners, Pose2D]]] = None
        #: the pose in the global frame that the robot works on, or None
        self.target: Optional[Pose2D] = None
        #: the reasons for which the robot is held, as texts in the order in which they came; empty: it may travel
        self.held_for: Tuple[str, ...] = ()
        #: whether its way is planned when the last hold ends
        self.waits_for_release = False
        #: drop_command(now_ns): has a robot that is driven by velocities forget its command; None: it is not
        self.drop_command: Optional[Callable[[int], object]] = None

    def set_gate(self, gate: Traveller) -> None:
        """Call ``gate.departs(leg, now_ns)`` at each departure. It may hold the robot later at that instant.

        When the robot goes on, ``gate.way_on(now_ns)`` returns the way by which it has to, and whether that ends at the
        target, or None: it goes by its planner's way.
        """
        self._gate = gate

    def aim(self, target: Pose2D) -> None:
        """Set the robot's target (Pose2D, global frame)."""
        self.target = target
        self.waits_for_release = False

    def forget(self, now_ns: int) -> None:
        """Forget the target, and all that is to happen for it: its goal has ended, or another one replaces it."""
        if self._agenda.events:
            self._agenda.clear()
        self.target = None
        self.waits_for_release = False
        if Abandoned in self._hearers:
            self._tell(Abandoned(now_ns, self._robot.name))

    def _go_on(self, now_ns: int) -> None:
        """Go on to the target from where the robot stands; if there is no way, it gives up as for a new goal."""
        ordered = None if self._gate is None else self._gate.way_on(now_ns)
        if ordered is not None:
            way, is_at_target = ordered
            self.go(way.corners, now_ns, None if is_at_target else _beyond(way.goal, self._robot.tolerances.xy))
            return
        self.go(() if self._planner.goes_straight else self._planner.corners(
            self._robot.pose_at(now_ns), self._aimed), now_ns)

    @property
    def _aimed(self) -> Pose2D:
        """The target of a robot that has one."""
        assert self.target is not None
        return self.target

    def go(self, corners: Optional[Corners], now_ns: int, aside: Optional[Pose2D] = None) -> None:
        """Go to the target by ``corners``; None: there is no way. With ``aside`` (Pose2D), go there first."""
        if corners is None:
            self._fail_to_plan(now_ns)
            return
        if self.held_for:
            self.waits_for_release = True
            return
        robot = self._robot
        place: Pose2D = aside or self.target  # type: ignore[assignment]  # it has one; a call of _aimed costs more
        if self.to_spot is not None:
            corners, place = self.to_spot(robot.pose_at(now_ns), corners, place, aside is not None)
        try:
            if self.limited is not None:
                corners = self.limited(robot.pose_at(now_ns), corners, place)
            leg = robot.depart(place, now_ns, corners, None if self._durations is None else self._durations.paced)
        except ValueError as error:
            self._navigator.end(aborted('The goal cannot be travelled to: {}'.format(error)), now_ns)
            return
        if leg.arrive_ns - now_ns > self._navigator.longest_wait_ns:
            robot.stop(now_ns)
            self._navigator.refuse_to_wait(leg.arrive_ns, 'the arrival', 'are the position (m) and the speed, {:g} '
                                           'm/s, as they are meant?'.format(robot.limits.max_speed), now_ns)
            return
        hear = self._hearers.get(Departed)
        if hear is not None:
            hear(new(Departed, (now_ns, robot.name, 'departed', place.x, place.y, place.yaw)))
        if Drives in self._hearers:
            self._tell(Drives(now_ns, robot.name, leg))
        if self._gate is not None:
            self._gate.departs(leg, now_ns)
        self._await_end(leg, aside)

    def go_aside(self, reason: str, way: WayBack, now_ns: int) -> None:
        """End the hold for ``reason``, and drive by ``way`` (.corners, .goal) from where the robot stands.

        From the end of that way, or from where it is stopped before, the robot goes on to its target by a new way. On
        ``way`` the robot does not fail: failures are drawn for ways to the target only.
        """
        self.waits_for_release = False
        self._change_holds(tuple(one for one in self.held_for if one != reason), now_ns)
        self.go(way.corners, now_ns, _beyond(way.goal, self._robot.tolerances.xy))

    def _fail_to_plan(self, now_ns: int) -> None:
        refusal = self._planner.refusal_of_way(self._robot.pose_at(now_ns), self._aimed)
        if refusal:
            self._tell(Warned(now_ns, self._robot.name, refusal))
        self._navigator.give_up(now_ns)

    def _await_end(self, leg: Motion, aside: Optional[Pose2D]) -> None:
        failure_ns = None if self._durations is None or aside is not None else self._durations.failure_ns(leg)
        if failure_ns is not None:
            self._agenda.at(failure_ns, self._fail_on_the_way)
        else:
            self._agenda.at(leg.arrive_ns, self._arrive if aside is None else self._reach_aside)

    def _reach_aside(self, due_ns: int, _now_ns: int) -> None:
        self.halt(due_ns)
        self._go_on(due_ns)

    def _fail_on_the_way(self, due_ns: int, _now_ns: int) -> None:
        self.halt(due_ns)
        text = None if self._durations is None else self._durations.failure_text
        self._navigator.end(aborted(text) if text else NO_CONTROL, due_ns)

    @guarded
    def hold(self, reason: str, now_ns: int) -> None:
        """Have the robot stand at its exact pose of this instant for ``reason`` (a text), until :meth:`release`.

        Its goal stays active. A new goal is taken in and planned, and waits. Only travel is held: a goal's frame is
        still looked up, and a goal without a way is given up. A reason that holds the robot already changes nothing.
        """
        if reason not in self.held_for:
            self._hold(reason, now_ns)

    def _hold(self, reason: str, now_ns: int) -> None:
        self._change_holds((*self.held_for, reason), now_ns)
        leg = self._robot.leg
        if leg is not None:
            if self._durations is not None:
                self._durations.interrupted(leg, now_ns)
            self._agenda.clear()
        self.halt(now_ns)
        if leg is not None:
            self.waits_for_release = self.target is not None

    @guarded
    def release(self, reason: str, now_ns: int) -> None:
        """End the hold for ``reason``. If no reason is left, the robot goes on by a new way.

        A reason that does not hold the robot changes nothing.
        """
        if reason not in self.held_for:
            return
        self._change_holds(tuple(one for one in self.held_for if one != reason), now_ns)
        if self.waits_for_release and not self.held_for:
            self.waits_for_release = False
            self._go_on(now_ns)

    def change_way(self, now_ns: int, corners: Optional[Corners] = None, aside: Optional[Pose2D] = None) -> None:
        """Stop the driving robot and go on from there, from rest, by ``corners``; None: by a new way.

        With ``aside`` (Pose2D), go there first, by ``corners``.
        """
        if self._durations is not None and self._robot.leg is not None:
            self._durations.interrupted(self._robot.leg, now_ns)
        self._agenda.clear()
        self.halt(now_ns)
        if corners is None:
            self._go_on(now_ns)
        else:
            self.go(corners, now_ns, aside and _beyond(aside, self._robot.tolerances.xy))

    @guarded
    def set_motion(self, limits: MotionLimits, tolerances: Tolerances, now_ns: int) -> None:
        """Use other limits from now on, on the way from rest, and other tolerances from the next leg on.

        A way that takes a time of its own, whatever the limits, goes on as it is.
        """
        robot = self._robot
        is_changed = limits != robot.limits
        robot.set_motion(limits, tolerances)
        self._tell(motion_of(robot, now_ns))
        if is_changed and robot.leg is not None and not self._planner.keeps_times:
            self.change_way(now_ns)

    def forget_holds(self, now_ns: int) -> None:
        """End all holds of the robot, which has no goal."""
        if self.held_for:
            self._change_holds((), now_ns)

    def _change_holds(self, holds: Tuple[str, ...], now_ns: int) -> None:
        self.held_for = holds
        self._tell(Held(now_ns, self._robot.name, holds))

    @guarded
    def place(self, pose: Pose2D, now_ns: int) -> None:
        """Put the robot at ``pose`` (Pose2D, global frame). If it was driving, it goes on to its goal from there.

        A robot that is held stays held, and goes on from there when it is released.
        """
        driving = self._robot.leg is not None
        self._robot.place(pose, now_ns)
        self.tell_stands(now_ns)
        if driving:
            self._agenda.clear()
            self._go_on(now_ns)

    @guarded
    def map_changed(self, now_ns: int) -> None:
        """Plan again after a change of the map.

        A way that the new map blocks is planned again, from rest; so is the way to a target to which there was none. If
        the robot is held, its way is planned when it is released. If all ways are straight, nothing is planned again:
        the map then matters only for goals that come later.
        """
        planner = self._planner
        if planner.goes_straight or self.target is None or planner.lacking or self.waits_for_release:
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

    def halt(self, now_ns: int) -> None:
        """Stop the robot, if it drives, and send the event that it stands. A command that it has is forgotten."""
        robot = self._robot
        if self.drop_command is not None:
            self.drop_command(now_ns)
        if robot.leg is None:
            return
        pose, hear = robot.stop(now_ns), self._hearers.get(Stands)
        if hear is not None:
            hear(new(Stands, (now_ns, robot.name, 'stands', pose.x, pose.y, pose.yaw)))

    def tell_stands(self, now_ns: int) -> None:
        """Send the event that the robot stands at its present pose, after it was put there."""
        pose = self._robot.pose_at(now_ns)
        self._tell(Stands(now_ns, self._robot.name, 'stands', pose.x, pose.y, pose.yaw))

    def break_off(self, error: Exception) -> None:
        """Clean up after an unexpected error: see :meth:`Navigator.break_off`."""
        self._navigator.break_off(error)


def _beyond(pose: Pose2D, distance: float) -> Pose2D:
    """Return the Pose2D ``distance`` [m] ahead of ``pose``; a robot that stops that far short of it is at ``pose``."""
    return Pose2D(pose.x + distance * math.cos(pose.yaw), pose.y + distance * math.sin(pose.yaw), pose.yaw)
