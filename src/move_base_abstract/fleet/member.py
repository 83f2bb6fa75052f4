"""One robot of a fleet in plain Python: its parts, and the subscriptions to its events."""
import itertools
from typing import NamedTuple

from ..common.errors import ConfigurationError, FrameError
from ..faults.failures import KINDS
from ..goals.client import NoClient
from ..goals.events import Warned, motion_of, robot_stream
from ..goals.outcome import ROBOT_REMOVED, ROBOT_RESET
from ..maps.map_check import MapCheck
from ..sensing.laser import Laser
from ..tasks.place_tasks import PlaceTaskRunner
from .robot_parts import make_planner, make_robot_parts
from .robot_rows import tell_start


class FleetWarning(NamedTuple):
    """At ``time_ns`` [ns] something was wrong with the goal ``goal_id`` of ``robot``; '': the robot had no goal."""

    time_ns: int
    robot: str
    goal_id: str
    text: str


class Member:
    """One robot of a :class:`Fleet`, which makes it. ``tasks``: its PlaceTaskRunner; None if there are no places."""

    def __init__(self, fleet, spec, index, planner, occupancy):
        settings = spec.settings
        values = settings.values
        self._fleet = fleet
        self._settings = settings
        self.goal_numbers = itertools.count(1)
        self._stream = robot_stream()
        if fleet._rows is not None:
            fleet._rows.subscribe(self._stream, values['log_motion'])
        fleet._user_calls.subscribe(self._stream, values['log_motion'])
        self._stream.subscribe('shown', {Warned: self._warned})
        self._map_check = None
        if occupancy is not None and values['use_map']:
            self._map_check = MapCheck(occupancy, values['allow_unknown'], values['allow_occupied_goals'])
        parts = make_robot_parts(settings, spec.name, index, fleet.simulation, self._stream, NoClient(spec.name),
                                 _no_lookup, planner or make_planner(settings, self._map_check), fleet.scenario.zones,
                                 remembered_legs=1,  # this fleet never asks for past poses
                                 encounters=fleet.encounters)
        self.robot, self._ledger, self.navigator, self.condition = (
            parts.robot, parts.ledger, parts.navigator, parts.condition)
        fleet.surroundings.add(self.robot, values['global_frame'], settings.costmaps.global_footprint)
        self._laser = self.tasks = None
        tell_start(self._stream, self.robot, settings.durations, fleet.now_ns)
        self._traveller = fleet.traffic.join(self.navigator, settings.network, self._stream, values['priority'])
        if fleet._rooms is not None:
            self.tasks = PlaceTaskRunner(fleet._rooms, index, spec.name, values['seed'], self._stream,
                                         NoClient(spec.name + '-task'), self.robot,
                                         has_failed=lambda: self.condition.is_out_of_order)
        self.condition.begin(fleet.now_ns)

    @property
    def worker(self):
        """The robot's PlaceTaskRunner, which does its tasks. :raises ConfigurationError: if there are no places."""
        if self.tasks is None:
            raise ConfigurationError("robot '{}' cannot work: the scenario has no places; allowed: a list, also an "
                                     'empty one'.format(self.robot.name))
        return self.tasks

    @property
    def failing(self):
        """The robot's Failing. :raises ConfigurationError: if the robot never fails."""
        if self.condition.failing is None:
            raise ConfigurationError("robot '{}': failure_kind: got none; allowed, for a robot that is to fail: "
                                     '{}'.format(self.robot.name, ', '.join(KINDS)))
        return self.condition.failing

    @property
    def battery(self):
        """The robot's Battery. :raises ConfigurationError: if the robot has none."""
        if self.condition.battery is None:
            raise ConfigurationError("robot '{}': battery_capacity: got 0; allowed, for a battery: > 0 [Ah]".format(
                self.robot.name))
        return self.condition.battery

    def _warned(self, event):
        active = self._ledger.active
        self._fleet._note(FleetWarning(*event[:2], active.goal_id if active is not None else '', event.text))

    def set_priority(self, priority, now_ns):
        """Give the robot another priority; without zones and lanes to wait for, this changes nothing."""
        if self._traveller is not None:
            self._traveller.set_priority(priority, now_ns)

    def reset(self, now_ns):
        """Put the robot back to its start, without goals."""
        if self.tasks is not None:
            self.tasks.shut_down(ROBOT_RESET, now_ns)
        self.navigator.reset(ROBOT_RESET, now_ns)
        self._ledger.clear()
        self.condition.reset(now_ns)
        self.robot.reset(self._settings.start, now_ns)
        self._stream.tell(motion_of(self.robot, now_ns))
        self.navigator.travel.tell_stands(now_ns)

    def remove(self, now_ns):
        """Take the robot out of the fleet: its goal and its tasks end."""
        if self.tasks is not None:
            self.tasks.shut_down(ROBOT_REMOVED, now_ns)
        self.condition.close()
        self.navigator.close(ROBOT_REMOVED, now_ns)
        if self._traveller is not None:
            self._traveller.leave(now_ns)
        self._fleet.simulation.queue.guard(self.robot.index, None)
        self._fleet.surroundings.remove(self.robot)

    def use_map(self, occupancy):
        """Check goals against another map (OccupancyMap)."""
        if self._map_check is not None:
            self._map_check.use(occupancy)

    def scan(self, now_ns):
        """Return the Scan that the robot's laser measures at ``now_ns`` [ns]."""
        if self._laser is None:
            self._laser = Laser(self._settings.laser, self._settings.values['seed'], self.robot.name)
        occupancy = None if self._map_check is None else self._map_check.occupancy
        return self._fleet.surroundings.scan(self.robot, self._laser, occupancy, now_ns)


class Members(dict):
    """The robots of a fleet by name, in the order of their indices; an unknown name raises ConfigurationError."""

    def __missing__(self, name):
        raise ConfigurationError("robot '{}' is unknown; there are: {}".format(
            name, ', '.join(list(self)[:10]) or 'none'))


def _no_lookup(frame_id, _stamp_ns):
    raise FrameError("frame '{}' is unknown; without ROS there are only a robot's own frames".format(frame_id))
