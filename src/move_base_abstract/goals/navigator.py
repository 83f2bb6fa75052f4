"""What move_base does with a goal, decided without ROS: check it, find its place, plan, travel, end it.

Threading contract: all methods are called under one lock, by whoever holds the present, with ``now_ns`` [ns] not
before the simulation's present.
"""
from collections import deque

from ..common.errors import FrameError
from ..common.units import NS_PER_S, check_reachable
from ..engine.guard import attempt_each, fault_text, guarded
from ..maps.planning import StraightLinePlanner
from ..motion.geometry import quaternion_fault
from .events import Abandoned, Aimed, BrokenOff, Departed, GoalChanged, Held, Recovery, Stands, Warned, WheelsStopped
from .feedback import GoalFeedback
from .goal_pose import BadFramePolicy, GoalPose
from .outcome import CANCELLED, CLOCK_RESTARTED, INVALID_QUATERNION, NO_CONTROL, NO_PLAN, REACHED, aborted
from .recovery import RecoveryPolicy

__all__ = ['BadFramePolicy', 'GoalPose', 'Navigator']

_RETRY_NS = NS_PER_S // 20  # where a frame that is not known is waited for
_UNHEARD = 50  # goals and cancels that wait for a silent robot; actionlib's default of a server's queue


class Navigator:
    """The life of one robot's goals, on top of a :class:`GoalLedger` that keeps the book.

    What happens is told to ``stream`` (Stream, see :mod:`.events`), where the robot is on its way to ``client``.
    """

    def __init__(self, robot, simulation, ledger, frames, stream, client, planner=StraightLinePlanner(),
                 bad_frame_policy=BadFramePolicy.ABORT, recovery_policy=RecoveryPolicy(), durations=None):
        self.robot = robot
        self.planner = planner
        self._bad_frame_policy = bad_frame_policy
        self._recovery_policy = recovery_policy
        self._durations = durations  # GoalDurations, None: all goes by the law alone
        self._simulation = simulation
        self._ledger = ledger
        self._frames = frames
        self._tell, self._hearers = stream.tell, stream.hearers
        self._gate = None
        #: how often it is told where the robot is (GoalFeedback)
        self.feedback = GoalFeedback(robot, simulation, ledger, client)
        self._events = []
        self._target = None
        self._starts_from_idle = True
        self._holds = ()
        self._waits_for_release = False
        self._refusals = {}
        self._unheard = deque(maxlen=_UNHEARD)
        self.goal_number = 0  # how many goals it has begun to work on

    def set_recovery_policy(self, policy):
        """Give up by ``policy`` (RecoveryPolicy), from the next goal on that cannot be reached."""
        self._recovery_policy = policy

    def set_gate(self, gate):
        """Ask ``gate`` at each departure whether the robot may go.

        ``departs(leg, now_ns)`` returns the reason (a text) for which it is held at once, or None; ``settle(now_ns)``
        is called when the one or the other has come to pass.
        """
        self._gate = gate

    @property
    def is_active(self):
        """Whether the robot has a goal."""
        return self._ledger.active is not None

    @property
    def target(self):
        """The pose in the global frame that the robot works on, or None."""
        return self._target

    @property
    def held_for(self):
        """The reasons for which the robot is held, texts in the order in which they came; none: it may travel."""
        return self._holds

    @guarded
    def receive(self, goal_id, stamp_ns, goal, now_ns):
        """Take the :class:`GoalPose` ``goal`` in. The newest goal wins; whatever is wrong with it ends it."""
        if self._ledger.is_silent:
            self._unheard.append(lambda at_ns: self.receive(goal_id, stamp_ns, goal, at_ns))
            return
        starts_from_idle = self._ledger.active is None
        if self._ledger.receive(goal_id, stamp_ns, now_ns) is None:
            return
        if self._durations is not None:
            self._durations.next_goal()
        self.goal_number += 1
        self._starts_from_idle = starts_from_idle
        self._forget_goal(now_ns)
        self._halt(now_ns)
        self._work_on(goal, now_ns)

    def _work_on(self, goal, now_ns):
        fault = quaternion_fault(goal.quaternion)
        if fault:
            self._tell(Warned(now_ns, self.robot.name, fault))
            self._end(INVALID_QUATERNION, now_ns)
            return
        for refusal in self._refusals.values():
            self._end(refusal, now_ns)
            return
        if GoalChanged in self._hearers:
            self._tell(GoalChanged(now_ns, self.robot.name))
        if self.feedback.frequency:
            self.feedback.start(now_ns)
        self._find_place(goal, now_ns)

    def _find_place(self, goal, now_ns):
        """Bring the goal into the global frame, and go there if that is possible; wait if its stamp has yet to come."""
        if self.planner.lacking:
            self._bad_place(goal, self.planner.lacking, now_ns)
            return
        if goal.stamp_ns > now_ns and self._frames.moves(goal.frame_id, now_ns):
            self._try_at(goal.stamp_ns, goal, now_ns)
            return
        try:
            pose = self._frames.place(goal, now_ns)
        except FrameError as error:
            self._bad_place(goal, str(error), now_ns)
        except ValueError as error:
            self._end(aborted('The goal is not a place: {}'.format(error)), now_ns)
        else:
            self._target = pose
            if self._starts_from_idle and WheelsStopped in self._hearers:
                self._tell(WheelsStopped(now_ns, self.robot.name))
            if Aimed in self._hearers:
                self._tell(Aimed(now_ns, self.robot.name, pose, goal.height, self._frames.orientation(goal, pose)))
            self._travel(self.planner.corners(self.robot.pose_at(now_ns), pose), now_ns)

    def _bad_place(self, goal, text, now_ns):
        self._tell(Warned(now_ns, self.robot.name, text))
        if self._bad_frame_policy is BadFramePolicy.ABORT:
            self._end(aborted(text), now_ns)
            return
        self._try_at(now_ns + _RETRY_NS, goal, now_ns)

    def _try_at(self, due_ns, goal, now_ns):
        """Look for the goal's place (again) at ``due_ns`` [ns]."""
        if self._can_wait_for(due_ns, "the goal's frame would be looked up", now_ns):
            self._at(due_ns, lambda due_ns, _now_ns: self._find_place(goal, due_ns))

    def _can_wait_for(self, due_ns, what, now_ns):
        """Return whether simulated time comes as far as ``due_ns`` [ns]; if not, the goal has ended."""
        try:
            check_reachable(due_ns, what)
        except ValueError as error:
            self._end(aborted('The goal cannot be waited for: {}'.format(error)), now_ns)
            return False
        return True

    def _fail_to_plan(self, now_ns):
        refusal = self.planner.refusal_of_way(self.robot.pose_at(now_ns), self._target)
        if refusal:
            self._tell(Warned(now_ns, self.robot.name, refusal))
        self._give_up(now_ns)

    def _travel(self, corners, now_ns):
        """Go to the target by ``corners``; None: there is no way."""
        if corners is None:
            self._fail_to_plan(now_ns)
            return
        if self._holds:
            self._waits_for_release = True
            return
        try:
            leg = self.robot.depart(self._target, now_ns, corners, self._durations and self._durations.paced)
        except ValueError as error:
            self._end(aborted('The goal cannot be travelled to: {}'.format(error)), now_ns)
            return
        self._tell(Departed(now_ns, self.robot.name, self._target, leg.corners))
        gate = self._gate
        reason = None if gate is None else gate.departs(leg, now_ns)
        if reason is None:
            self._await_end(leg)
        else:
            self._hold(reason, now_ns)
        if gate is not None:
            gate.settle(now_ns)

    def _await_end(self, leg):
        failure_ns = None if self._durations is None else self._durations.failure_ns(leg)
        if failure_ns is None:
            self._at(leg.arrive_ns, self._arrive)
        else:
            self._at(failure_ns, self._fail_on_the_way)

    def _arrive(self, due_ns, _now_ns):
        self._halt(due_ns)
        if self.feedback.frequency:
            self.feedback.tell_last(due_ns)
        self._end(REACHED, due_ns)

    def _fail_on_the_way(self, due_ns, _now_ns):
        self._halt(due_ns)
        text = self._durations.failure_text
        self._end(aborted(text) if text else NO_CONTROL, due_ns)

    def _give_up(self, now_ns):
        behaviors = self._recovery_policy.behaviors
        begins, end_ns = self._recovery_policy.schedule(now_ns)
        if not self._can_wait_for(end_ns, 'the robot would give up', now_ns):
            return
        for begin_ns, index in begins:
            self._at(begin_ns, lambda due_ns, _now_ns, index=index: self._tell(Recovery(
                due_ns, self.robot.name, self.robot.pose_at(due_ns), index, behaviors)))
        if end_ns == now_ns:
            self._end(NO_PLAN, now_ns)
        else:
            self._at(end_ns, lambda due_ns, _now_ns: self._end(NO_PLAN, due_ns))

    @guarded
    def cancel(self, goal_id, stamp_ns, now_ns):
        """Take a cancel request in; the robot stops at its exact pose of this instant."""
        if self._ledger.is_silent:
            self._unheard.append(lambda at_ns: self.cancel(goal_id, stamp_ns, at_ns))
            return
        if self._ledger.cancel(goal_id, stamp_ns, now_ns):
            self._halt(now_ns)
            self._end(CANCELLED, now_ns)

    @guarded
    def hold(self, reason, now_ns):
        """Have the robot stand at its exact pose of this instant for ``reason`` (a text), until :meth:`release`.

        Its goal stays active, and a new one is taken in, planned and waits. What is no travel goes on: a goal's frame
        is looked for, a goal without a way is given up. A reason that is there already changes nothing.
        """
        if reason not in self._holds:
            self._hold(reason, now_ns)

    def _hold(self, reason, now_ns):
        self._change_holds((*self._holds, reason), now_ns)
        leg = self.robot.leg
        if leg is not None:
            if self._durations is not None:
                self._durations.interrupted(leg, now_ns)
            self._forget_events()
            self._halt(now_ns)
            self._waits_for_release = True

    @guarded
    def release(self, reason, now_ns):
        """End what :meth:`hold` began for ``reason``; without any left the robot goes on, by a way that is new.

        A reason that is not there changes nothing.
        """
        if reason not in self._holds:
            return
        self._change_holds(tuple(one for one in self._holds if one != reason), now_ns)
        if self._waits_for_release and not self._holds:
            self._waits_for_release = False
            self._plan_again(now_ns)

    def _change_holds(self, holds, now_ns):
        self._holds = holds
        self._tell(Held(now_ns, self.robot.name, holds))

    @guarded
    def disable(self, reason, outcome, now_ns):
        """End the active goal with ``outcome``, and each that comes, for ``reason`` (a text), until :meth:`enable`."""
        self._refusals[reason] = outcome
        self.shut_down(outcome, now_ns)

    def enable(self, reason):
        """End what :meth:`disable` began for ``reason``; one that is not there changes nothing."""
        self._refusals.pop(reason, None)

    def go_silent(self):
        """Say nothing of goals any more, and hear neither goals nor cancels, until :meth:`answer_again`."""
        self._ledger.go_silent()

    @guarded
    def answer_again(self, now_ns):
        """Say which goals have ended meanwhile, and take in what came, in its order (of more than 50 the latest)."""
        self._ledger.answer_again(now_ns)
        unheard = list(self._unheard)
        self._unheard.clear()
        for take_in in unheard:
            take_in(now_ns)

    @guarded
    def shut_down(self, outcome, now_ns):
        """End the active goal, if any, with ``outcome``."""
        if self.is_active:
            self._halt(now_ns)
            self._end(outcome, now_ns)

    def close(self, outcome, now_ns):
        """As :meth:`shut_down`, for good: a robot that was silent says so too, and of what it has not heard nothing."""
        self._unheard.clear()
        self.shut_down(outcome, now_ns)
        self._ledger.answer_again(now_ns)

    @guarded
    def reset(self, outcome, now_ns):
        """End the active goal, if any, with ``outcome``; nothing keeps the robot from its goals any more."""
        self.close(outcome, now_ns)
        self._refusals.clear()
        if self._holds:
            self._change_holds((), now_ns)

    @guarded
    def restart(self, before_ns, now_ns):
        """Go on at ``now_ns`` [ns] of a clock that has started anew, the old one having come to ``before_ns`` [ns].

        The goal under way is aborted; the robot stands where it was.
        """
        self.robot.restart(before_ns, now_ns)
        if self.is_active:
            self._end(CLOCK_RESTARTED, now_ns)
        self._ledger.restart(now_ns)
        self.tell_stands(now_ns)

    @guarded
    def place(self, pose, now_ns):
        """Put the robot at ``pose`` (global frame). With a goal under way, it goes on to it from there.

        One that is held stays so, and goes on from there when it is released.
        """
        driving = self.robot.leg is not None
        self.robot.place(pose, now_ns)
        self.tell_stands(now_ns)
        if driving:
            self._forget_events()
            self._plan_again(now_ns)

    @guarded
    def map_changed(self, now_ns):
        """Another map counts from now on: a way that it cuts is planned again, from rest; so is one that there was not.

        One that waits for its release is planned then.
        Where no way has corners a map counts for the goals that come after it only.
        """
        planner = self.planner
        if planner.goes_straight or self._target is None or planner.lacking or self._waits_for_release:
            return
        pose, leg = self.robot.pose_at(now_ns), self.robot.leg
        if leg is None:
            corners = planner.corners(pose, self._target)
            if corners is not None:
                self._forget_events()
                self._travel(corners, now_ns)
        elif not planner.is_clear([(pose.x, pose.y), *leg.corners_ahead(now_ns), (self._target.x, self._target.y)]):
            self._forget_events()
            self._halt(now_ns)
            self._plan_again(now_ns)

    def _plan_again(self, now_ns):
        """Go on to the goal from where the robot stands; to give up takes as long as for a new goal."""
        self._travel(() if self.planner.goes_straight else self.planner.corners(
            self.robot.pose_at(now_ns), self._target), now_ns)

    def _halt(self, now_ns):
        if self.robot.leg is not None:
            self._tell(Stands(now_ns, self.robot.name, self.robot.stop(now_ns)))

    def tell_stands(self, now_ns):
        """Tell where the robot stands, for who has put it there."""
        self._tell(Stands(now_ns, self.robot.name, self.robot.pose_at(now_ns)))

    def _end(self, outcome, stamp_ns):
        self._forget_goal(stamp_ns)
        if self.feedback.frequency:
            self.feedback.stop()
        if outcome.stops_wheels and WheelsStopped in self._hearers:
            self._tell(WheelsStopped(stamp_ns, self.robot.name))
        self._ledger.finish(outcome, stamp_ns)
        if GoalChanged in self._hearers:
            self._tell(GoalChanged(stamp_ns, self.robot.name))

    def break_off(self, error):
        """Whatever the robot was about has ended in the exception ``error``: its goal, if any, ends with its text."""
        now_ns, robot = self._simulation.now_ns, self.robot
        attempt_each(self._simulation, robot.name, error, (
            (self._forget_goal, now_ns), (robot.halt, now_ns), (self.tell_stands, now_ns), (self.feedback.stop,),
            (self._tell, WheelsStopped(now_ns, robot.name)), (self._tell, BrokenOff(now_ns, robot.name)),
            (self._ledger.finish, aborted(fault_text(error)), now_ns), (self._tell, GoalChanged(now_ns, robot.name))))

    def _at(self, due_ns, action):
        if self._events:
            self._events = [event for event in self._events if event.action is not None]
        self._events.append(self._simulation.queue.schedule(due_ns, self.robot.index, action))

    def _forget_goal(self, now_ns):
        if self._events:
            self._forget_events()
        self._target = None
        self._waits_for_release = False
        if Abandoned in self._hearers:
            self._tell(Abandoned(now_ns, self.robot.name))

    def _forget_events(self):
        for event in self._events:
            event.action = None  # as Event.cancel
        self._events.clear()
