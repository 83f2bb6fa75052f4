"""The things that the robots of one process share: the clock, heartbeats, and a limit of all publications."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Dict, Optional, Sequence, Tuple, Union

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.parameter_table import read_table
from move_base_abstract.config.node_tables import ACTIONLIB, STATUS_FREQUENCY as _FREQUENCY
from move_base_abstract.config.rates import Rates
from move_base_abstract.driving.contacts import Contacts
from move_base_abstract.motion.recorded_range import WARNING
from move_base_abstract.sensing.surroundings import Surroundings

from ..replacing.single_connections import connect_one_at_a_time
from .diagnostics import Diagnostics
from .events_topic import EventsTopic
from .heartbeat import SHARED_INDEX, Heartbeat

if TYPE_CHECKING:
    from move_base_abstract.encounters.control import Encounters
    from move_base_abstract.goals.events import Beyond
    from move_base_abstract.traffic.zones import Zone

    from ..clocks.throttle import NoThrottle, WallThrottle
    from ..clocks.timing import Clock, Timing

_STATUS_RATE_CAP = 5.0  # Hz, wall
_PUBLICATIONS_PER_SECOND = 500.0  # wall; the limit for all robots of a process together


@dataclass(frozen=True)
class ActionOptions:
    """actionlib's own parameters. The queue sizes count messages; the frequency is in Hz of simulated time."""

    pub_queue_size: int
    sub_queue_size: int
    status_frequency: float


def read_action_options(status_frequency: float) -> ActionOptions:
    """Return the :class:`ActionOptions` of the parameter server. They are looked for as actionlib does it.

    ``status_frequency`` [Hz, simulated]: that of the status if no parameter sets it.

    :raises ConfigurationError: for a wrong type or an impossible value.
    """
    raw = {_FREQUENCY: status_frequency}
    queues = ('actionlib_server_pub_queue_size', 'actionlib_server_sub_queue_size')
    for name in queues:
        if rospy.has_param(name):
            raw[name] = rospy.get_param(name)
    frequency = rospy.search_param(_FREQUENCY)
    if frequency:
        raw[_FREQUENCY] = rospy.get_param(frequency)
    values = read_table(raw, ACTIONLIB, rospy.get_namespace())
    sizes = [values[name] if values[name] > 0 else 50 for name in queues]
    return ActionOptions(sizes[0], sizes[1], values[_FREQUENCY])


class Host:
    """The host of all robots of a process. Make one, after ``clock``, which ``timing`` made, has started.

    ``is_crowded``: whether there may be very many robots. ``zones``: the Zones of their world. ``encounters``: their
    Encounters; None if they do not meet.

    :raises ConfigurationError: if one of actionlib's parameters is not allowed, or the clock has not started.
    """

    def __init__(self, clock: Clock, timing: Timing, is_crowded: bool = False, zones: Sequence[Zone] = (),
                 encounters: Optional[Encounters] = None) -> None:
        if clock.simulation is None:
            raise ConfigurationError('the clock of a host must have started')
        connect_one_at_a_time()
        self.clock = clock
        self.timing = timing
        simulation = clock.simulation
        simulation.queue.guard(SHARED_INDEX, lambda error: simulation.report_fault(rospy.get_name(), error))
        self.options = read_action_options(timing.status_frequency)
        self.is_crowded = is_crowded
        self.zones = zones
        self.encounters = encounters
        self.robot_count = 0  # of those that share the limit of publications
        self.surroundings = Surroundings()
        self.contacts = Contacts(simulation)
        self._has_warned = False  # about goals beyond the recorded legs of a calibration
        self.rates = Rates(clock.hearers.rates_changed)
        clock.hearers.show_rates(self.rates.text)
        self.status_heartbeat = Heartbeat(self, self.options.status_frequency, _STATUS_RATE_CAP)
        self._tf_heartbeats: Dict[Tuple[float, float], Heartbeat] = {}
        self._diagnostics: Optional[Diagnostics] = None
        timing.begin_to_publish()
        self.events = EventsTopic(clock)

    def warn_of_beyond(self, event: Beyond) -> None:
        """Warn, once, that a robot's goal lies beyond the recorded legs of its calibration. ``event``: Beyond."""
        if not self._has_warned:
            self._has_warned = True
            rospy.logwarn(WARNING.format(event.robot, event.words))

    def tf_heartbeat(self, frequency: float, rate_cap: float) -> Heartbeat:
        """Return the heartbeat of tf with ``frequency`` [Hz, simulated] and at most ``rate_cap`` [Hz, wall]."""
        if (frequency, rate_cap) not in self._tf_heartbeats:
            self._tf_heartbeats[frequency, rate_cap] = Heartbeat(self, frequency, rate_cap)
        return self._tf_heartbeats[frequency, rate_cap]

    def diagnostics(self) -> Diagnostics:
        """Return the :class:`.diagnostics.Diagnostics` of the process. The first call makes it."""
        if self._diagnostics is None:
            self._diagnostics = Diagnostics(self)
        return self._diagnostics

    def throttle(self, rate: float) -> Union[NoThrottle, WallThrottle]:
        """Return a throttle of ``rate`` [Hz, wall], or of the robot's share of all publications if that is less."""
        return self.timing.throttle(rate, self.shortest_period)

    def shortest_period(self) -> float:
        """Return the shortest time [s, wall] between two publications of one robot, if all robots publish alike."""
        return self.robot_count / _PUBLICATIONS_PER_SECOND
