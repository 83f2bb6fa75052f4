"""What move_base does with a goal, without ROS: check it, find its place, plan, travel, end it.

Threading contract: all methods are called under the simulation's one lock, with a ``now_ns`` [ns] that is not before
the simulation's present.
"""
from __future__ import annotations

from collections import deque
from functools import partial
from typing import TYPE_CHECKING, Callable, Deque, Dict, Optional, Tuple, Union

from ..common.errors import FrameError
from ..common.units import LAST_NS, NS_PER_S, check_reachable, far_ahead
from ..engine.alarm import Agenda
from ..engine.guard import attempt_each, fault_text, guarded
from ..maps.planning import StraightLinePlanner
from ..motion.geometry import STRAIGHT_AHEAD, quaternion_fault
from .events import Abandoned, Aimed, BrokenOff, GoalChanged, Recovery, Warned, WheelsStopped
from .goal_pose import BadFramePolicy, GoalPose
from .outcome import CANCELLED, CLOCK_RESTARTED, INVALID_QUATERNION, NO_PLAN, REACHED, aborted
from .recovery import RecoveryPolicy
from .travel import Travel

if TYPE_CHECKING:
    from ..common.geometry import Pose2D
    from ..engine.series import Series
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..motion.attempts import GoalAttempts
    from ..motion.durations import GoalDurations
    from ..motion.frames import RobotFrames
    from ..motion.robot import Robot
    from .client import GoalClient
    from .ledger import GoalLedger, GoalRecord
    from .outcome import Outcome

__all__ = ['BadFramePolicy', 'GoalPose', 'Navigator']

_RETRY_NS = NS_PER_S // 20  # after which a frame that was not found is looked up again
_UNHEARD = 50  # goals and cancels kept for a silent robot; actionlib's default for the queue of a server


class Navigator:
    """Works on one robot's goals, whose states are in ``ledger`` (:class:`GoalLedger`).

    Events go to ``stream`` (Stream, see :mod:`.events`), feedback on the way goes to ``client`` (GoalClient).
    """

    __slots__ = ('robot', 'planner', '_agenda', 'travel', 'longest_wait_ns', '_bad_frame_policy', '_recovery_policy',
                 '_durations', '_simulation', '_ledger', '_frames', '_tell', '_hearers', 'feedback',
                 '_starts_from_idle', '_refusals', '_unheard', 'goal_number', 'takes_none', '__weakref__')

    def __init__(self, robot: Robot, simulation: Simulation, ledger: GoalLedger, frames: RobotFrames, stream: Stream,
                 client: GoalClient, planner: StraightLinePlanner = StraightLinePlanner(),
                 bad_frame_policy: BadFramePolicy = BadFramePolicy.ABORT,
                 recovery_policy: RecoveryPolicy = RecoveryPolicy(),
                 durations: Optional[Union[GoalDurations, GoalAttempts]] = None,
                 longest_wait_ns: int = LAST_NS) -> None:
        self.robot = robot
        self.planner = planner
        self._agenda = Agenda(simulation.queue, robot.index)
        #: the robot's travel to the goal, and its holds (Travel)
        self.travel = Travel(self, robot, planner, self._agenda, stream, durations)
        #: a goal that would have to wait for longer [ns], or travel, cannot be reached
        self.longest_wait_ns = longest_wait_ns
        self._bad_frame_policy = bad_frame_policy
        self._recovery_policy = recovery_policy
        self._durations = durations  # GoalDurations; None: durations follow from the law of motion alone
        self._simulation = simulation
        self._ledger = ledger
        self._frames = frames
        self._tell, self._hearers = stream.tell, stream.hearers
        #: the feedback with the robot's pose on its way (GoalFeedback)
        self.feedback = GoalFeedback(robot, simulation, ledger, client)
        self._starts_from_idle = True
        self._refusals: Dict[str, Outcome] = {}
        #: the Outcome of each goal of a robot that takes none, whatever it does; None: it takes goals
        self.takes_none: Optional[Outcome] = None
        self._unheard: Deque[Callable[[int], object]] = deque(maxlen=_UNHEARD)
        self.goal_number = 0  # the number of goals that the robot has begun to work on

    def set_recovery_policy(self, policy: RecoveryPolicy) -> None:
        """Use ``policy`` (RecoveryPolicy) for the next goal that cannot be reached, and for all after it."""
        self._recovery_policy = policy

    @property
    def is_active(self) -> bool:
        """Whether the robot has a goal."""
        return self._ledger.active is not None

    @property
    def must_stand(self) -> bool:
        """Whether the robot is held, or refuses goals for a reason that will end."""
        return bool(self.travel.held_for or self._refusals)

    def begin_drive(self) -> None:
        """Note that a robot that takes no goals drives from rest: encounters and failures count that as a goal."""
        self.goal_number += 1

    def receive(self, goal_id: str, stamp_ns: int, goal: GoalPose, now_ns: int) -> None:
        """Take in ``goal`` (:class:`GoalPose`). The newest goal wins; if anything is wrong with it, it is aborted."""
        ledger = self._ledger
        if ledger.is_silent:
            self._unheard.append(partial(self.receive, goal_id, stamp_ns, goal))
            return
        starts_from_idle = ledger.active is None
        try:
            if ledger.receive(goal_id, stamp_ns, now_ns) is not None:
                self._starts_from_idle = starts_from_idle
                self._work_on(goal, now_ns)
        except Exception as error:  # as :func:`guarded` does, which costs more; this is called for each goal
            self.break_off(error)

    def _work_on(self, goal: GoalPose, now_ns: int) -> None:
        """Begin to work on ``goal``, which the ledger has accepted."""
        if self.takes_none is not None:
            self._ledger.finish(self.takes_none, now_ns)
            return
        if self._durations is not None:
            self._durations.next_goal()
        self.goal_number += 1
        if not self._starts_from_idle or Abandoned in self._hearers:  # otherwise its end has forgotten the last goal
            self.travel.forget(now_ns)
        if self.robot.leg is not None:
            self.travel.halt(now_ns)
        quaternion = goal.quaternion
        fault = None if quaternion is STRAIGHT_AHEAD else quaternion_fault(quaternion)
        if fault:
            self._tell(Warned(now_ns, self.robot.name, fault))
            self.end(INVALID_QUATERNION, now_ns)
            return
        if self._refusals:
            self.end(next(iter(self._refusals.values())), now_ns)
            return
        if GoalChanged in self._hearers:
            self._tell(GoalChanged(now_ns, self.robot.name))
        if self.feedback.frequency:
            self.feedback.start(now_ns)
        self._find_place(goal, now_ns)

    def _find_place(self, goal: GoalPose, now_ns: int) -> None:
        """Transform the goal to the global frame and go there if possible.

        Where the goal's frame is at the goal's stamp may only be known later: wait for that instant, then for the pose.
        """
        planner = self.planner
        lacking = planner.lacking
        if lacking:
            self._bad_place(goal, lacking, now_ns)
            return
        if goal.stamp_ns and self._frames.is_yet_to_come(goal.frame_id, goal.stamp_ns, now_ns):
            if goal.stamp_ns - now_ns > self.longest_wait_ns:
                self.refuse_to_wait(goal.stamp_ns, "the goal's stamp", 'is it of the wall clock? Stamps are of /clock, '
                                    'which nodes follow with use_sim_time', now_ns)
            else:
                self._try_at(goal.stamp_ns if goal.stamp_ns > now_ns else now_ns + _RETRY_NS, goal, now_ns)
            return
        try:
            pose = self._frames.place(goal, now_ns)
        except FrameError as error:
            self._bad_place(goal, str(error), now_ns)
        except ValueError as error:
            self.end(aborted('The goal is not a place: {}'.format(error)), now_ns)
        else:
            self.travel.aim(pose)
            if self._starts_from_idle and WheelsStopped in self._hearers:
                self._tell(WheelsStopped(now_ns, self.robot.name))
            if Aimed in self._hearers:
                self._tell(Aimed(now_ns, self.robot.name, pose, goal.height, self._frames.orientation(goal, pose)))
            start = self.robot.pose_at(now_ns)
            corners = planner.corners(start, pose)
            if corners is None and planner.tolerance:
                corners = self._go_near(start, pose)
            self.travel.go(corners, now_ns)

    def _go_near(self, start: Pose2D, pose: Pose2D) -> Optional[Tuple[Tuple[float, float], ...]]:
        """Aim at the place nearest to ``pose`` within the planner's tolerance; return the way's corners, or None."""
        near = self.planner.nearest_to(start, pose)
        if near is None:
            return None
        self.travel.aim(near)
        return self.planner.corners(start, near)

    def _bad_place(self, goal: GoalPose, text: str, now_ns: int) -> None:
        self._tell(Warned(now_ns, self.robot.name, text))
        if self._bad_frame_policy is BadFramePolicy.ABORT:
            self.end(aborted(text), now_ns)
            return
        self._try_at(now_ns + _RETRY_NS, goal, now_ns)

    def _try_at(self, due_ns: int, goal: GoalPose, now_ns: int) -> None:
        """Look up the goal's place at ``due_ns`` [ns]."""
        if self._can_wait_for(due_ns, "the goal's frame would be looked up", now_ns):
            self._agenda.at(due_ns, lambda due_ns, _now_ns: self._find_place(goal, due_ns))

    def refuse_to_wait(self, due_ns: int, what: str, cause: str, now_ns: int) -> None:
        """Give the goal up, because ``what`` is at ``due_ns`` [ns], too far ahead; ``cause``: what is likely wrong."""
        ahead = far_ahead(what, due_ns, now_ns, self.longest_wait_ns, 'longest_wait')
        self._tell(Warned(now_ns, self.robot.name, f'The goal cannot be reached: {ahead}: {cause}'))
        self.give_up(now_ns)

    def _can_wait_for(self, due_ns: int, what: str, now_ns: int) -> bool:
        """Return whether simulated time can reach ``due_ns`` [ns]; if not, end the goal."""
        try:
            check_reachable(due_ns, what)
        except ValueError as error:
            self.end(aborted('The goal cannot be waited for: {}'.format(error)), now_ns)
            return False
        return True

    def arrive(self, due_ns: int, _now_ns: int) -> None:
        """End the goal, which the robot has reached at ``due_ns`` [ns]."""
        self.travel.halt(due_ns)
        if self.feedback.frequency:
            self.feedback.tell_last(due_ns)
        self.end(REACHED, due_ns)

    def give_up(self, now_ns: int) -> None:
        """End the active goal, to which there is no way, after all the time for which move_base would try."""
        behaviors = self._recovery_policy.behaviors
        begins, end_ns = self._recovery_policy.schedule(now_ns)
        if not self._can_wait_for(end_ns, 'the robot would give up', now_ns):
            return
        for begin_ns, index in begins:
            self._agenda.at(begin_ns, lambda due_ns, _now_ns, index=index: self._tell(Recovery(  # type: ignore[misc]
                due_ns, self.robot.name, self.robot.pose_at(due_ns), index, behaviors)))
        if end_ns == now_ns:
            self.end(NO_PLAN, now_ns)
        else:
            self._agenda.at(end_ns, lambda due_ns, _now_ns: self.end(NO_PLAN, due_ns))

    @guarded
    def cancel(self, goal_id: str, stamp_ns: int, now_ns: int) -> None:
        """Take a cancel request in; if it is for the active goal, the robot stops at its exact pose of this instant."""
        if self._ledger.is_silent:
            self._unheard.append(lambda at_ns: self.cancel(goal_id, stamp_ns, at_ns))
            return
        if self._ledger.cancel(goal_id, stamp_ns, now_ns):
            self.travel.halt(now_ns)
            self.end(CANCELLED, now_ns)

    @guarded
    def disable(self, reason: str, outcome: Outcome, now_ns: int) -> None:
        """End the active goal, and each new one, with ``outcome``, until :meth:`enable` with the same ``reason``."""
        self._refusals[reason] = outcome
        self.shut_down(outcome, now_ns)

    def enable(self, reason: str) -> None:
        """End what :meth:`disable` began for ``reason``; an unknown reason changes nothing."""
        self._refusals.pop(reason, None)

    def go_silent(self) -> None:
        """Publish nothing about goals, and take in neither goals nor cancels, until :meth:`answer_again`."""
        self._ledger.is_silent = True

    @guarded
    def answer_again(self, now_ns: int) -> None:
        """End the silence: publish the goals that have ended meanwhile; take in the goals and cancels that came.

        They are taken in in the order in which they came; of more than 50, only the last 50.
        """
        self._ledger.answer_again(now_ns)
        unheard = list(self._unheard)
        self._unheard.clear()
        for take_in in unheard:
            take_in(now_ns)

    @guarded
    def shut_down(self, outcome: Outcome, now_ns: int) -> None:
        """Stop the robot, and end the active goal, if any, with ``outcome``."""
        self.travel.halt(now_ns)
        if self.is_active:
            self.end(outcome, now_ns)

    def close(self, outcome: Outcome, now_ns: int) -> None:
        """Shut down for good: as :meth:`shut_down`, but also end a silence and drop what was not taken in during it."""
        self._unheard.clear()
        self.shut_down(outcome, now_ns)
        self._ledger.answer_again(now_ns)

    @guarded
    def reset(self, outcome: Outcome, now_ns: int) -> None:
        """End the active goal, if any, with ``outcome``, and every hold, silence and refusal of goals."""
        self.close(outcome, now_ns)
        self._refusals.clear()
        self.travel.forget_holds(now_ns)

    @guarded
    def restart(self, before_ns: int, now_ns: int) -> None:
        """Go on with a clock that has started anew at ``now_ns`` [ns]; the old one had reached ``before_ns`` [ns].

        The active goal is aborted; the robot stands where it was.
        """
        self.robot.restart(before_ns, now_ns)
        self.travel.halt(now_ns)
        if self.is_active:
            self.end(CLOCK_RESTARTED, now_ns)
        self._ledger.restart(now_ns)
        self.travel.tell_stands(now_ns)

    def end(self, outcome: Outcome, stamp_ns: int) -> None:
        """End the active goal with ``outcome`` at ``stamp_ns`` [ns]; the robot must stand already."""
        self.travel.forget(stamp_ns)
        if self.feedback.frequency:
            self.feedback.stop()
        if outcome.stops_wheels and WheelsStopped in self._hearers:
            self._tell(WheelsStopped(stamp_ns, self.robot.name))
        self._ledger.finish(outcome, stamp_ns)
        if GoalChanged in self._hearers:
            self._tell(GoalChanged(stamp_ns, self.robot.name))

    def break_off(self, error: Exception) -> None:
        """Clean up after the exception ``error``: stop the robot, and end its goal, if any, with the error's text."""
        now_ns, robot = self._simulation.now_ns, self.robot
        attempt_each(self._simulation, robot.name, error, (
            (self.travel.forget, now_ns), (robot.halt, now_ns), (self.travel.halt, now_ns),
            (self.travel.tell_stands, now_ns), (self.feedback.stop,), (self._tell, WheelsStopped(now_ns, robot.name)),
            (self._tell, BrokenOff(now_ns, robot.name)),
            (self._ledger.finish, aborted(fault_text(error)), now_ns), (self._tell, GoalChanged(now_ns, robot.name))))


class GoalFeedback:
    """Sends the pose of ``robot`` to ``client`` (GoalClient) while ``ledger`` has an active goal."""

    __slots__ = ('_robot', '_simulation', '_ledger', '_client', '_series', 'frequency')

    def __init__(self, robot: Robot, simulation: Simulation, ledger: GoalLedger, client: GoalClient) -> None:
        self._robot = robot
        self._simulation = simulation
        self._ledger = ledger
        self._client = client
        self._series: Optional[Series] = None
        self.frequency = 0.0  # Hz, simulated; 0: never

    def set_frequency(self, frequency: float) -> None:
        """Send feedback ``frequency`` times per simulated second from now on; 0: never."""
        self.stop()
        self.frequency = frequency
        self._series = self._simulation.series(self._robot.index, frequency, self._tell,
                                               is_output=True, is_heard=self._client.is_feedback_heard)
        if self._ledger.active is not None:
            self.start(self._simulation.now_ns)

    def start(self, now_ns: int) -> None:
        """Begin to send feedback for a goal at ``now_ns`` [ns]."""
        if self._series is not None:
            self._series.start(now_ns)

    def stop(self) -> None:
        """Stop sending feedback, because the goal has ended."""
        if self._series is not None:
            self._series.stop()

    def tell_last(self, now_ns: int) -> None:
        """Send the last feedback of a goal, which the robot has reached at ``now_ns`` [ns]; it is never left out."""
        record, reported = self._ledger.active, self._robot.reported
        if record is not None and self._series is not None and not reported.is_mute:
            self._client.feedback(record, reported.pose_at(now_ns), now_ns, True)

    def present(self, now_ns: int) -> Tuple[Optional[GoalRecord], Pose2D]:
        """Return what feedback says at ``now_ns`` [ns]: (record, pose). The record is None if there is none to send."""
        record, reported = self._ledger.active, self._robot.reported
        if self._series is None or self._ledger.is_silent or reported.is_mute:
            record = None
        return record, reported.pose_at(now_ns)

    def _tell(self, due_ns: int, _now_ns: int) -> Optional[int]:
        record, pose = self.present(due_ns)
        return None if record is None else self._client.feedback(record, pose, due_ns, False)
