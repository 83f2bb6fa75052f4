"""The timing of a process, as one object. It alone decides what differs between the scaled clock and lockstep.

:func:`make_timing` chooses the kind, once per process. Both kinds have the same methods, and neither has a state.
"""
from __future__ import annotations

from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Dict, Optional, Sequence, Union

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import EVENTS_ONLY
from move_base_abstract.engine.series import NOBODY, PARTICIPANTS
from move_base_abstract.lockstep import wire
from move_base_abstract.motion.told import packed, told, told_of

from .. import lockstep
from ..lockstep.exchange import playing
from ..messages import outlets
from ..process.clock_watch import watch_clock
from ..transforms import tf_hub, tf_watch
from .lockstep_clock import LockstepClock
from .ros_clock import RosClock
from .throttle import NoThrottle, WallThrottle

if TYPE_CHECKING:
    from move_base_abstract.driving.odometry import Odometry
    from move_base_abstract.motion.robot import Robot

    from ..lockstep import Participant

#: the rank of robots, which come before all nodes that declare no rank
ROBOTS_RANK = 0
#: backends that use only the time master's clock
EVENT_DRIVEN_BACKENDS = ('builtin', 'virtual_robots')
_STATUS_FREQUENCY = 5.0  # Hz, simulated
_TASK_FEEDBACK_FREQUENCY = 5.0  # Hz, simulated


def make_timing() -> Timing:
    """Return the timing of this process: LockstepTiming if the time master works in lockstep, or will do so.

    :raises ConfigurationError: if ``events_only``, ``log_motion`` or ``tell_newcomers`` is neither true nor false.
    """
    events_only = _switch('events_only')
    if lockstep.is_lockstep():
        return LockstepTiming(events_only, _switch('log_motion'), rospy.get_param('/time_master/chaos_seed', 0),
                              rospy.get_param('/time_master/chaos_only', []), _switch('tell_newcomers', True))
    if events_only:
        rospy.logwarn('%s: parameter events_only is for lockstep (/time_master/mode); it has no effect here',
                      rospy.get_name())
    return ScaledTiming()


def _switch(name: str, default: bool = False) -> bool:
    """Return the parameter ``name``, the node's own or the nearest one further up; ``default`` if there is none.

    :raises ConfigurationError: if it is neither true nor false.
    """
    found = rospy.search_param(name)
    value = rospy.get_param(found) if found else default
    if not isinstance(value, bool):
        raise ConfigurationError('parameter {}: got {!r}; allowed: true or false'.format(found, value))
    return value


class ScaledTiming:
    """The scaled clock: time follows the wall clock, times a factor, and waits for no node.

    Therefore messages that come at a rate are capped in wall time.
    """

    #: {name: value} of a robot's settings, over which all given ones take precedence
    base_settings: Dict[str, Any] = {}
    #: rate of the repeated status, if no parameter sets it [Hz, simulated]
    status_frequency = _STATUS_FREQUENCY
    #: rate of the feedback of tasks, if no parameter sets it [Hz, simulated]
    task_feedback_frequency = _TASK_FEEDBACK_FREQUENCY
    #: whether who begins to listen is told present values
    tells_newcomers = False

    @staticmethod
    def when_heard(_is_heard: Callable[[], int]) -> None:
        """Return None: messages at a rate are made whether a node hears them or not."""

    @staticmethod
    def frequency_at_rest(frequency: float) -> float:
        """Return the rate [Hz, simulated] of the odometry of a robot that stands, if no parameter sets it.

        It is ``frequency``, the rate on the way.
        """
        return frequency

    def make_clock(self) -> RosClock:
        """Return the clock of this process, a RosClock, which has not started."""
        return RosClock()

    @staticmethod
    def answer_delay(seconds: float) -> float:
        """Return the shortest time between a goal and its answer [s, wall]: ``seconds``, as the parameter has it."""
        return seconds

    @staticmethod
    def is_audience(heard: int) -> bool:
        """Return whether anything may begin because a node listens. ``heard``: the result of Outlet.is_heard."""
        return heard != NOBODY

    @staticmethod
    def throttle(rate: float, shortest_period: Callable[[], float]) -> WallThrottle:
        """Return a throttle of at most ``rate`` [Hz, wall], with ``shortest_period()`` [s, wall] between two yeses."""
        return WallThrottle(rate, shortest_period)

    @staticmethod
    def check_backend(name: str, private: str) -> None:
        """Do nothing: all backends work on the scaled clock."""

    @staticmethod
    def has_own_goal_connection(is_crowded: bool) -> bool:
        """Return whether a robot's goals from RViz go over its goal topic: not if there may be very many robots."""
        return not is_crowded

    @staticmethod
    def batch() -> ContextManager[None]:
        """Return a context in which the tf of several robots is collected into one message."""
        return tf_hub.batch()

    @staticmethod
    def begin_to_publish() -> None:
        """Do nothing. It is called before robots are made."""

    @staticmethod
    def tell_motion(_robot: Robot, _sub: int, _odometry: Optional[Odometry] = None) -> None:
        """Do nothing: on the scaled clock nothing is played, and there is no radio."""

    @staticmethod
    def claim_frames(robot: str, frames: Sequence[str]) -> None:
        """Warn, in the name of ``robot``, if another node publishes one of its ``frames`` in tf."""
        tf_watch.claim(robot, frames)

    @staticmethod
    def await_surroundings(_clock: Clock, _listen_to_static_frames: Callable[[], object],
                           _wait_for_maps: Callable[[Participant], bool]) -> bool:
        """Return True at once: messages from outside may come at any time."""
        return True

    @staticmethod
    def watch() -> None:
        """Watch the clock, and log which node has gone if time stands still for good."""
        watch_clock()

    @staticmethod
    def leave_clock() -> bool:
        """Return False: a node that looks on goes on listening to ``/clock``."""
        return False


class LockstepTiming:
    """Lockstep: time leaps from event to event and waits for all participants, and no message is left out.

    Each message at a rate has its instant, as long as a node hears it. ``events_only``: nothing is published at a rate
    unless its own parameter sets one. ``log_motion``: robots write how they drive into the event log.
    ``chaos_seed``, ``chaos_only``: those of the run, which decide how robots with ``buggify`` go wrong.
    ``tells_newcomers``: who begins to listen is told present values. The methods are those of :class:`ScaledTiming`.
    """

    def __init__(self, events_only: bool = False, log_motion: bool = False, chaos_seed: int = 0,
                 chaos_only: Sequence[Any] = (), tells_newcomers: bool = True) -> None:
        self.tells_newcomers = tells_newcomers
        self.base_settings = {**(EVENTS_ONLY if events_only else {}), **({'log_motion': True} if log_motion else {}),
                              **({'buggify_seed': chaos_seed, 'buggify_only': chaos_only} if chaos_seed else {})}
        self.status_frequency = 0.0 if events_only else _STATUS_FREQUENCY  # 0: transitions only
        self.task_feedback_frequency = 0.0 if events_only else _TASK_FEEDBACK_FREQUENCY

    @staticmethod
    def when_heard(is_heard: Callable[[], int]) -> Callable[[], int]:
        """Return ``is_heard``: time stops for a message at a rate only while a node hears it."""
        return is_heard

    @staticmethod
    def frequency_at_rest(_frequency: float) -> float:
        """Return 0: time would stop for each message, and a run with a participant that listens would never be idle."""
        return 0.0

    def make_clock(self) -> LockstepClock:
        """Return the clock of this process, a LockstepClock, which has not started."""
        clock = LockstepClock(lambda: lockstep.join(rank=rospy.get_param('~lockstep_rank', ROBOTS_RANK),
                                                    own_threads=False), self.tells_newcomers)
        outlets.follow_listeners(clock.listener_came, clock.listeners_changed)
        return clock

    @staticmethod
    def answer_delay(_seconds: float) -> float:
        """Return 0: an answer comes in a later round than its goal."""
        return 0.0

    @staticmethod
    def is_audience(heard: int) -> bool:
        """Return whether a participant listens. Onlookers do not count, because they may come at any time."""
        return heard == PARTICIPANTS

    @staticmethod
    def throttle(_rate: float, _shortest_period: Callable[[], float]) -> NoThrottle:
        """Return a throttle that holds nothing back: each message comes at its instant."""
        return NoThrottle()

    @staticmethod
    def check_backend(name: str, private: str) -> None:
        """Refuse the backend ``name`` of the robot with the ``private`` namespace, if it has a clock of its own.

        :raises ConfigurationError: if it has.
        """
        if name not in EVENT_DRIVEN_BACKENDS:
            raise ConfigurationError(
                "parameter {}/backend: got '{}', a simulator with a clock of its own; allowed in lockstep (parameter "
                '/time_master/mode): {}'.format(private, name, ', '.join(EVENT_DRIVEN_BACKENDS)))

    @staticmethod
    def has_own_goal_connection(_is_crowded: bool) -> bool:
        """Return True: such a connection costs nothing, and each goal has its place in the order of all messages."""
        return True

    @staticmethod
    def batch() -> ContextManager[None]:
        """Return a context that collects nothing: each robot's messages keep their place in the order of all."""
        return nullcontext()

    @staticmethod
    def begin_to_publish() -> None:
        """Make each new listener of tf get all frames, since there may be no heartbeat."""
        tf_hub.tell_newcomers()

    @staticmethod
    def tell_motion(robot: Robot, sub: int, odometry: Optional[Odometry] = None) -> None:
        """Report the motion of ``robot``, which has the index ``sub``, to the time master, if hosts have a radio.

        What is played shows it, and that of its ``odometry``.
        """
        playing.follow(sub, playing.Mover(robot.name, lambda: robot.leg, lambda leg: packed(told(leg))))
        if odometry is not None:
            playing.follow(sub + wire.ODOMETRY, playing.Mover('', lambda: odometry.motion,
                                                              lambda leg: packed(told(leg))))
        participant = lockstep.participant()
        if participant is not None and participant.has_radio:
            def tell(now_ns: int) -> None:
                participant.add(wire.motion(sub, robot.name, packed(told_of(robot, now_ns))))
            robot.follow(tell)
            tell(participant.now_ns)

    @staticmethod
    def claim_frames(_robot: str, _frames: Sequence[str]) -> None:
        """Do nothing: to listen to tf would be a part of the run."""

    @staticmethod
    def await_surroundings(clock: Any, listen_to_static_frames: Callable[[], object],
                           wait_for_maps: Callable[[Participant], bool]) -> bool:
        """Take in maps and static frames in the first round, while time stands still. False if ROS shuts down."""
        listen_to_static_frames()
        return wait_for_maps(clock.participant)

    @staticmethod
    def watch() -> None:
        """Do nothing: if the time master ends, the connection to it ends, too."""

    @staticmethod
    def leave_clock() -> bool:
        """Have a node that looks on, and knows what time it is, listen to ``/clock`` no longer; return True."""
        lockstep.leave_clock()
        return True


#: the two kinds of clocks, and of timings
Clock = Union[LockstepClock, RosClock]
Timing = Union[LockstepTiming, ScaledTiming]
