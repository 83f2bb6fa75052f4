"""How time goes, as one object: whatever differs between the scaled clock and lockstep is asked here, and nowhere else.

:func:`make_timing` decides once per process. Both kinds answer the same questions; neither keeps anything.
"""
from contextlib import nullcontext

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.config.settings import EVENTS_ONLY
from move_base_abstract.engine.event_queue import NOBODY, PARTICIPANTS

from .. import lockstep
from ..messages import outlets
from ..process.clock_watch import watch_clock
from ..transforms import tf_hub, tf_watch
from .lockstep_clock import LockstepClock
from .ros_clock import RosClock
from .throttle import NoThrottle, WallThrottle

#: robots come before all nodes that declare no rank
ROBOTS_RANK = 0
#: backends that go by the time master's clock alone
EVENT_DRIVEN_BACKENDS = ('builtin', 'virtual_robots')
_STATUS_FREQUENCY = 5.0  # Hz, simulated
_TASK_FEEDBACK_FREQUENCY = 5.0  # Hz, simulated


def make_timing():
    """Return the timing of this process: in lockstep if the time master works so, or will."""
    events_only = _switch('events_only')
    if lockstep.is_lockstep():
        return LockstepTiming(events_only, _switch('log_motion'), rospy.get_param('/time_master/chaos_seed', 0),
                              rospy.get_param('/time_master/chaos_only', []))
    if events_only:
        rospy.logwarn('%s: parameter events_only is for lockstep (/time_master/mode); it has no effect here',
                      rospy.get_name())
    return ScaledTiming()


def _switch(name):
    """Return what the parameter ``name`` says, the node's own or the nearest one further up; false where none is.

    :raises ConfigurationError: if it is neither true nor false.
    """
    found = rospy.search_param(name)
    value = rospy.get_param(found) if found else False
    if not isinstance(value, bool):
        raise ConfigurationError('parameter {}: got {!r}; allowed: true or false'.format(found, value))
    return value


class ScaledTiming:
    """Time follows the wall clock, times a factor, and waits for nobody: what is said often is capped in wall time."""

    #: what a robot's settings are made of, before all that is given
    base_settings = {}
    #: how often the status is repeated, if no parameter says so [Hz, simulated]
    status_frequency = _STATUS_FREQUENCY
    #: how often tasks tell how far they are, if no parameter says so [Hz, simulated]
    task_feedback_frequency = _TASK_FEEDBACK_FREQUENCY

    @staticmethod
    def when_heard(_is_heard):
        """Return None: what is told at a rate, unless a throttle or its topic says otherwise, is told."""

    @staticmethod
    def frequency_at_rest(frequency):
        """Return how often a robot that stands tells its odometry, if no parameter says so: as on the way, [Hz]."""
        return frequency

    @staticmethod
    def make_clock():
        """Return the clock of this process, not started."""
        return RosClock()

    @staticmethod
    def answer_delay(seconds):
        """Return the shortest time between a goal and its answer [s, wall], of which ``seconds`` is asked for."""
        return seconds

    @staticmethod
    def is_audience(heard):
        """Return whether who hears, as of Outlet.is_heard, is somebody for whom things may begin."""
        return heard != NOBODY

    @staticmethod
    def throttle(rate, shortest_period):
        """Return a throttle of ``rate`` [Hz, wall] and, between two yeses, ``shortest_period()`` [s, wall]."""
        return WallThrottle(rate, shortest_period)

    @staticmethod
    def check_backend(name, private):
        """Refuse a backend, of the robot with the ``private`` namespace, that does not go with this kind of time."""

    @staticmethod
    def has_own_goal_connection(is_crowded):
        """Return whether a robot's goals from RViz go over its goal topic, not past it."""
        return not is_crowded

    @staticmethod
    def batch():
        """Return a context in which what several robots tell tf is collected into one message."""
        return tf_hub.batch()

    @staticmethod
    def begin_to_publish():
        """Robots are about to be made."""

    @staticmethod
    def claim_frames(robot, frames):
        """Warn, in the name of ``robot``, if another node publishes one of ``frames`` in tf."""
        tf_watch.claim(robot, frames)

    @staticmethod
    def await_surroundings(_clock, _listen_to_static_frames, _wait_for_maps):
        """Return True: what comes from outside may come at any time."""
        return True

    @staticmethod
    def watch():
        """Say who is gone when time stands still for good."""
        watch_clock()


class LockstepTiming:
    """Time leaps from event to event and waits for all who take part: nothing is left out.

    What is told at a rate has an instant each time, as long as anybody hears it. ``events_only``: nothing is told at a
    rate unless a parameter of its own says so. ``log_motion``: robots write into the event log by which limits they
    travel. ``chaos_seed``, ``chaos_only``: those of the run, by which robots with ``buggify`` go wrong. Answers are as
    of :class:`ScaledTiming`.
    """

    def __init__(self, events_only=False, log_motion=False, chaos_seed=0, chaos_only=()):
        self.base_settings = {**(EVENTS_ONLY if events_only else {}), **({'log_motion': True} if log_motion else {}),
                              **({'buggify_seed': chaos_seed, 'buggify_only': chaos_only} if chaos_seed else {})}
        self.status_frequency = 0.0 if events_only else _STATUS_FREQUENCY  # 0: transitions only
        self.task_feedback_frequency = 0.0 if events_only else _TASK_FEEDBACK_FREQUENCY

    @staticmethod
    def when_heard(is_heard):
        """Return ``is_heard``: time stops for what is told at a rate only while somebody hears it."""
        return is_heard

    @staticmethod
    def frequency_at_rest(_frequency):
        """Return 0: time would stop for each, and go on for ever where anybody who takes part listens."""
        return 0.0

    @staticmethod
    def make_clock():
        """Return the clock of this process, not started."""
        clock = LockstepClock(lambda: lockstep.join(rank=rospy.get_param('~lockstep_rank', ROBOTS_RANK),
                                                    own_threads=False))
        outlets.follow_listeners(clock.listener_came, clock.listeners_changed)
        return clock

    @staticmethod
    def answer_delay(_seconds):
        """Return 0: an answer comes in a later round than its goal."""
        return 0.0

    @staticmethod
    def is_audience(heard):
        """As of ScaledTiming: who takes no part may come at any time."""
        return heard == PARTICIPANTS

    @staticmethod
    def throttle(_rate, _shortest_period):
        """Return what holds nothing back: what is asked for comes at its instant."""
        return NoThrottle()

    @staticmethod
    def check_backend(name, private):
        """Refuse simulators with a clock of their own.

        :raises ConfigurationError: if the backend ``name`` is one.
        """
        if name not in EVENT_DRIVEN_BACKENDS:
            raise ConfigurationError(
                "parameter {}/backend: got '{}', a simulator with a clock of its own; allowed in lockstep (parameter "
                '/time_master/mode): {}'.format(private, name, ', '.join(EVENT_DRIVEN_BACKENDS)))

    @staticmethod
    def has_own_goal_connection(_is_crowded):
        """Return True: a connection costs nothing, and each goal has its place among all others' messages."""
        return True

    @staticmethod
    def batch():
        """Return a context that collects nothing: each robot's messages keep their place among all others'."""
        return nullcontext()

    @staticmethod
    def begin_to_publish():
        """Tell newcomers where all frames are, since no heartbeat does."""
        tf_hub.tell_newcomers()

    @staticmethod
    def claim_frames(_robot, _frames):
        """Claim nothing: to listen would be a part of the run."""

    @staticmethod
    def await_surroundings(clock, listen_to_static_frames, wait_for_maps):
        """Take in what outsiders say in the first round, in which time stands still; False if ROS shuts down."""
        listen_to_static_frames()
        return wait_for_maps(clock.participant)

    @staticmethod
    def watch():
        """Watch nothing: the end of the time master is the end of its connection."""
