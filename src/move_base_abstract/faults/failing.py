"""One robot that fails and is repaired. Each instant follows from numbers that are drawn in advance; nothing is polled.

Each rate has an *exposure*: the time with a goal, the distance driven, or the number of goals driven. The next failure
by a rate comes when its exposure has reached the sum of the exponential numbers that were drawn so far. So the failures
by each rate are a Poisson process of its exposure, which does not grow while the robot has failed.
"""
from __future__ import annotations

import math
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

from ..common.units import LAST_NS, NS_PER_S, seconds_to_ns
from ..engine.alarm import Alarm
from ..engine.chance import Purpose
from ..engine.instants import first_ns
from ..goals.events import Failed, GoalChanged, Repaired
from ..goals.outcome import FAILED
from .failures import ABORT, CLEARANCE, ENCOUNTER, GOAL, HOUR, KM, SCRIPT, SILENT, STALL, STUCK, Failures
from .stuck import GivingUp, Sticking

if TYPE_CHECKING:
    from ..engine.chance import Chance
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator
    from ..motion.stuck_law import StuckLaw

_PURPOSES = {HOUR: Purpose.FAILURE_HOURS, KM: Purpose.FAILURE_KM, GOAL: Purpose.FAILURE_GOALS}
#: how many units of an exposure are one unit of its rate: ns in an hour, m in a km, goals
_UNITS = {HOUR: 3600 * NS_PER_S, KM: 1000.0, GOAL: 1.0}


class Failure(NamedTuple):
    """A failure: its ``kind`` and ``cause``, when it came, and when it is repaired [ns], None if that is not known."""

    kind: str
    cause: str
    since_ns: int
    until_ns: Optional[int]


class Failing:
    """Applies :class:`Failures` to one robot; ``chance``: the robot's Chance; ``stream``: its stream of events.

    ``failure``: the present :class:`Failure`, or None; ``count``: the number of failures so far.
    """

    #: the reason for which the robot is held, or its navigator refuses goals
    REASON = 'failure'

    def __init__(self, failures: Failures, robot: Any, navigator: Navigator, simulation: Simulation, chance: Chance,
                 stream: Stream) -> None:
        self.failure: Optional[Failure] = None
        self.count = 0
        self._failures: Failures = failures
        self._robot = robot
        self._navigator = navigator
        self._queue = simulation.queue
        self._chance = chance
        self._stream = stream
        self._draws = {cause: 0 for cause, _ in failures.rates}
        self._rates = dict(failures.rates)
        #: the exposures at which the next failures come: the robot's odometer [m], and the goals of _driven
        self._next = {cause: self._draw(cause) for cause in (KM, GOAL) if cause in self._rates}
        self._hours_left = self._draw_hours() if HOUR in self._rates else None  # ns
        self._hours = Alarm(self._queue, robot.index)
        self._on_leg = Alarm(self._queue, robot.index)
        self._repair = Alarm(self._queue, robot.index)
        self._driven = _DrivenGoals(navigator)
        self._sticking = Sticking(failures.by_clearance, navigator, chance)
        self._giving_up = GivingUp(failures.patience, navigator, simulation.queue, robot.index)
        self._script = [self._queue.schedule(
            one.at_ns, robot.index, lambda due_ns, _, one=one: self.fail(  # type: ignore[misc]
                SCRIPT, due_ns, one.kind, one.repair),
            keeps_going=_no) for one in failures.script if one.at_ns >= simulation.now_ns]
        robot.follow(self._motion_changed)
        stream.subscribe('failures', {GoalChanged: lambda event: self._goal_changed(event.time_ns)})

    def fail(self, cause: str, now_ns: int, kind: Optional[str] = None, repair: Optional[float] = None) -> bool:
        """Fail at ``now_ns`` [ns], for ``repair`` [s], None: a time that is drawn; return whether the robot has failed.

        A robot that has failed already does not fail again. ``kind`` None: the kind of the robot's Failures.
        """
        if self.failure is not None:
            return False
        self.count += 1
        kind = kind or self._failures.kind
        until_ns = self._repaired_at(now_ns, repair)
        self.failure = Failure(kind, cause, now_ns, until_ns)
        if until_ns is not None:
            self._repair.set(until_ns, self.repair)
        with ExitStack() as rest:  # these callbacks run even if telling fails; the last one runs first
            if kind == ABORT:
                rest.callback(self._navigator.disable, self.REASON, FAILED, now_ns)
            else:
                if kind == STUCK or cause == ENCOUNTER:
                    rest.callback(self._giving_up.begin, now_ns, kind != STUCK)
                rest.callback(self._navigator.travel.hold, self.REASON, now_ns)
                if kind == SILENT:
                    rest.callback(self._navigator.go_silent)
            self._pause(now_ns)
            self._stream.tell(Failed(now_ns, self._robot.name, kind, cause))
        return True

    def get_stuck(self, now_ns: int, keeps_goal: bool) -> bool:
        """Get stuck beside another robot at ``now_ns`` [ns]; return whether the robot has failed.

        ``keeps_goal``: whether it keeps each goal and stands, instead of giving it up.
        """
        return self.fail(ENCOUNTER, now_ns, STALL if keeps_goal else STUCK)

    @property
    def law(self) -> Optional[StuckLaw]:
        """The law by which robots that meet get stuck; None: they do not."""
        return self._failures.law

    def _repaired_at(self, now_ns: int, repair: Optional[float]) -> Optional[int]:
        if repair is None:
            if self._failures.repair is None:
                return None
            repair = self._failures.repair.draw(lambda place: self._chance.uniform(self.count, Purpose.REPAIR, place))
        until_ns = now_ns + seconds_to_ns(repair)
        return until_ns if until_ns <= LAST_NS else None

    def repair(self, now_ns: int) -> bool:
        """Repair the robot at ``now_ns`` [ns]; return whether there was anything to repair."""
        failure = self.failure
        if failure is None:
            return False
        with ExitStack() as rest:  # as in fail()
            rest.callback(self._goal_changed, now_ns)
            rest.callback(self._navigator.travel.release, self.REASON, now_ns)
            if failure.kind == ABORT:
                rest.callback(self._navigator.enable, self.REASON)
            elif failure.kind == SILENT:
                rest.callback(self._navigator.answer_again, now_ns)
            self._forget(now_ns)
        return True

    def _forget(self, now_ns: int) -> Optional[Failure]:
        failure, self.failure = self.failure, None
        self._repair.cancel()
        self._giving_up.end()
        if failure is not None:
            self._stream.tell(Repaired(now_ns, self._robot.name))
        return failure

    def reset(self, now_ns: int) -> None:
        """Forget the failure: the robot is placed at its start, its odometer goes to 0; the draws go on."""
        self._forget(now_ns)
        if KM in self._next:
            self._next[KM] -= self._robot.distance_at(now_ns)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]."""
        for alarm in (self._hours, self._on_leg, self._repair, self._giving_up):
            alarm.shift(by_ns)
        if self.failure is not None:
            until_ns = self.failure.until_ns
            self.failure = self.failure._replace(since_ns=self.failure.since_ns + by_ns,
                                                 until_ns=None if until_ns is None else until_ns + by_ns)

    def close(self) -> None:
        """Note that the robot is removed: it does not fail any more."""
        self._giving_up.end()
        for event in (self._hours, self._on_leg, self._repair):
            event.cancel()
        for scripted in self._script:
            scripted.cancel()

    def _draw(self, cause: str) -> float:
        """Return the exposure after which the robot fails again; it is drawn from an exponential distribution."""
        self._draws[cause] += 1
        number = self._chance.uniform(self._draws[cause], _PURPOSES[cause])
        return -math.log(number) / self._rates[cause] * _UNITS[cause]

    def _draw_hours(self) -> int:
        return int(min(self._draw(HOUR), LAST_NS))  # [ns]; for a tiny rate the draw is infinite

    def _goal_changed(self, now_ns: int) -> None:
        """Count time, for the failures per hour, while there is a goal, or a drive by velocities, and no failure."""
        if self.failure is not None and self.failure.kind == STUCK:
            self._giving_up.goal_changed(now_ns)
        if self._hours_left is None:
            return
        drives = self._navigator.takes_none is not None and self._robot.leg is not None
        counts = (self._navigator.is_active or drives) and self.failure is None
        if counts and self._hours.due_ns is None and now_ns + self._hours_left <= LAST_NS:
            self._hours.set(now_ns + self._hours_left, self._fail_by_hour)
        elif not counts:
            self._pause(now_ns)

    def _pause(self, now_ns: int) -> None:
        if self._hours.due_ns is not None:
            self._hours_left = self._hours.due_ns - now_ns
            self._hours.cancel()

    def _fail_by_hour(self, due_ns: int) -> None:
        self._hours_left = self._draw_hours()
        self.fail(HOUR, due_ns)

    def _motion_changed(self, now_ns: int) -> None:
        self._driven.leg_ends(now_ns)
        self._on_leg.cancel()
        if self._navigator.takes_none is not None:
            self._goal_changed(now_ns)
        leg = self._robot.leg
        if leg is None:
            if self.failure is not None and self._giving_up.was_moved(now_ns):
                self.repair(now_ns)
            return
        self._driven.leg_begins(leg)
        found = [(due_ns, cause) for cause, due_ns in (
            (KM, self._km_due_ns(leg)), (GOAL, self._driven.reached_ns(self._next.get(GOAL, math.inf))),
            (CLEARANCE, self._sticking.due_ns(leg))) if due_ns is not None]
        if found:
            due_ns, cause = min(found, key=lambda one: one[0])  # at equal instants the first one, the distance
            self._on_leg.set(due_ns, lambda at_ns: self._fail_on_leg(cause, at_ns))

    def _km_due_ns(self, leg: Any) -> Optional[int]:
        at = self._next.get(KM)
        if at is None or self._robot.distance_at(leg.arrive_ns) < at:
            return None
        return first_ns(leg.depart_ns, leg.arrive_ns, lambda at_ns: self._robot.distance_at(at_ns) >= at)

    def _fail_on_leg(self, cause: str, due_ns: int) -> None:
        if cause == CLEARANCE:
            self._sticking.got_stuck(due_ns)
        else:
            self._next[cause] += self._draw(cause)
        self.fail(cause, due_ns)


def _no() -> bool:
    """Return False: a run need not go on because of a failure that is to come."""
    return False


class _DrivenGoals:
    """The number of goals to which a robot has driven.

    A goal that is under way, or that was left, counts by the share of its leg's time. If the robot goes on to a goal on
    another leg, that leg counts as the share that was left.
    """

    def __init__(self, navigator: Navigator) -> None:
        self._navigator = navigator
        self._done = 0.0
        self._of_goal = 0.0  # the share of the goal _number that is in _done
        self._number = 0
        self._leg: Any = None

    def leg_begins(self, leg: Any) -> None:
        self._leg = leg
        if self._navigator.goal_number != self._number:
            self._number, self._of_goal = self._navigator.goal_number, 0.0

    def leg_ends(self, now_ns: int) -> None:
        leg, self._leg = self._leg, None
        if leg is not None:
            share = 1.0 if now_ns >= leg.arrive_ns else (now_ns - leg.depart_ns) / leg.duration_ns
            self._done += share * (1.0 - self._of_goal)
            self._of_goal += share * (1.0 - self._of_goal)

    def reached_ns(self, goals: float) -> Optional[int]:
        """Return the instant [ns] of the leg at which the number of goals reaches ``goals``, or None."""
        whole = 1.0 - self._of_goal
        if self._done + whole < goals:
            return None
        share = max(0.0, goals - self._done) / whole if whole else 0.0
        duration_ns: int = self._leg.duration_ns
        depart_ns: int = self._leg.depart_ns
        return depart_ns + min(duration_ns, math.ceil(share * duration_ns))
