"""One robot of a fleet in plain Python: what can be asked of it, its parts, and the subscriptions to its events."""
from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn, Optional

from ..common.arguments import as_float, check_kind
from ..common.errors import ConfigurationError, FrameError
from ..common.kinds import error
from ..common.parameter_table import checked
from ..config.robot_table import ACCELERATION, SPEED
from ..driving.settings import GOALS, VELOCITIES
from ..energy.battery import STATE_OF_CHARGE
from ..faults.failures import KINDS, REQUEST, check_request
from ..goals.activity import activity, emptied
from ..goals.client import NoClient
from ..goals.events import EMPTY, ChargePassed, Warned, motion_of, new
from ..goals.navigator import GoalPose
from ..goals.outcome import ROBOT_REMOVED, ROBOT_RESET
from ..maps.map_check import MapCheck
from ..motion.geometry import STRAIGHT_AHEAD, Pose2D, quaternion_of_yaw
from ..sensing.laser import Laser
from ..tasks.arrivals import check_task
from ..tasks.place_tasks import PlaceTaskRunner
from ..tasks.places import PRIORITY
from .robot_parts import make_planner, make_robot_parts
from .robot_rows import tell_start

if TYPE_CHECKING:
    from ..driving.driver import Driver
    from ..energy.battery import Battery
    from ..faults.condition import Condition
    from ..faults.failing import Failing
    from ..goals.navigator import Navigator
    from ..maps.occupancy import OccupancyMap
    from ..scenario import RobotSpec
    from ..sensing.laser import Scan
    from ..tasks.arrivals import Task
    from .fleet import Fleet


class FleetWarning(NamedTuple):
    """At ``time_ns`` [ns] something was wrong with the goal ``goal_id`` of ``robot``; '': the robot had no goal."""

    time_ns: int
    robot: str
    goal_id: str
    text: str


class Member:
    """One robot of a :class:`.Fleet`, which makes it: ``fleet.robot('bot').send(10.0, 0.0)``.

    Properties are those of the present. ``name``: the robot's name; ``condition``: its :class:`.condition.Condition`;
    ``navigator``: its Navigator. All else raises ConfigurationError if the robot was removed from its fleet.
    """

    def __init__(self, fleet: Fleet, spec: RobotSpec, index: int, planner: Any,
                 occupancy: Optional[OccupancyMap]) -> None:
        settings = spec.settings
        values = settings.values
        self.name = spec.name
        self._fleet = fleet
        self._settings = settings
        self._is_there = True
        self._goal_numbers = itertools.count(1)
        self._stream = fleet._streams[values['log_motion']].copy()
        self._stream.subscribe('shown', {Warned: self._warned, ChargePassed: self._charge_passed})
        self._map_check = None
        if occupancy is not None and values['use_map']:
            self._map_check = MapCheck(occupancy, values['allow_unknown'], values['allow_occupied_goals'])
        parts = make_robot_parts(settings, spec.name, index, fleet.simulation, self._stream, NoClient(spec.name),
                                 _no_lookup, planner or make_planner(settings, self._map_check), fleet.scenario.zones,
                                 remembered_legs=1,  # this fleet never asks for past poses
                                 encounters=fleet.encounters, contacts=fleet.contacts)
        self._robot, self._ledger = parts.robot, parts.ledger
        self.navigator: Navigator = parts.navigator
        self.condition: Condition = parts.condition
        self._driver: Optional[Driver] = parts.driver
        if self._map_check is not None and occupancy is not None:
            self._use_map(occupancy)
        fleet.surroundings.add(self._robot, values['global_frame'], settings.costmaps.global_footprint)
        self._laser: Optional[Laser] = None
        self._tasks: Optional[PlaceTaskRunner] = None
        tell_start(self._stream, self._robot, settings.durations, fleet.now_ns)
        self._traveller = fleet.traffic.join(self.navigator, settings.network, self._stream, values['priority'])
        if fleet._rooms is not None:
            self._tasks = PlaceTaskRunner(fleet._rooms, index, spec.name, values['seed'], self._stream,
                                          NoClient(spec.name + '-task'), self._robot,
                                          has_failed=lambda: self.condition.is_out_of_order)
        self.condition.begin(fleet.now_ns)

    @property
    def pose(self) -> Pose2D:
        """The robot's pose (m and rad, global frame)."""
        return self._robot.pose_at(self._now_ns())

    @property
    def distance(self) -> float:
        """The distance that the robot has driven so far [m]."""
        return self._robot.distance_at(self._now_ns())

    @property
    def state_of_charge(self) -> Optional[float]:
        """The state of charge of the robot's battery (0..1), or None if it has no battery."""
        self._now_ns()
        battery = self.condition.battery
        return None if battery is None else battery.soc

    @property
    def activity(self) -> str:
        """What the robot does, in a word or two: one of the states of :mod:`.runs.states`, held, or battery empty."""
        self._now_ns()
        return activity(self.navigator, self.condition, self._tasks)

    def distance_to(self, x: float, y: float) -> float:
        """Return the straight-line distance [m] from the robot to (x, y) [m]."""
        pose, x, y = self.pose, as_float(x, 'x'), as_float(y, 'y')
        return ((x - pose.x) ** 2 + (y - pose.y) ** 2) ** 0.5  # type: ignore[no-any-return]

    def send(self, x: float, y: float, yaw: float = 0.0, goal_id: str = '', frame: str = 'map') -> str:
        """Send the robot a goal [m, rad, in ``frame``] now; return its id.

        If anything is wrong with the goal, it ends with a text that says why.

        :raises ConfigurationError: if an argument is of a wrong type.
        """
        now_ns = self._fleet.simulation.now_ns if self._is_there else self._now_ns()  # a call less
        if not type(x) is type(y) is type(yaw) is float:
            x, y, yaw = as_float(x, 'x'), as_float(y, 'y'), as_float(yaw, 'yaw')
        if not type(goal_id) is type(frame) is str:
            check_kind(goal_id, str, 'goal_id')
            check_kind(frame, str, 'frame')
        goal_id = goal_id or f'{self.name}-{next(self._goal_numbers)}'
        goal = new(GoalPose, (
            frame, 0, (x, y), quaternion_of_yaw(yaw) if yaw else STRAIGHT_AHEAD, 0.0))
        self.navigator.receive(goal_id, 0, goal, now_ns)
        return goal_id

    def drive(self, forward: float, turning: float = 0.0, lateral: float = 0.0) -> None:
        """Drive with these speeds [m/s] and this turn rate [rad/s] from now on, until the watchdog stops the robot.

        :raises ConfigurationError: if the robot is not driven by velocities, or a number is not allowed.
        """
        now_ns, driver = self._now_ns(), self._driver
        if driver is None:
            raise error(f'{self._words()}: driven_by', GOALS, f'{VELOCITIES}, for a robot that is to drive() so')
        speeds = as_float(forward, 'forward'), as_float(lateral, 'lateral'), as_float(turning, 'turning')
        if lateral and not driver.settings.holonomic:
            raise error(f'{self._words()}: lateral', lateral, '0; with holonomic: true any speed')
        try:
            driver.command(*speeds, now_ns)
        except ValueError as fault:
            raise ConfigurationError(f'{self._words()}: {fault}') from None

    def cancel(self, goal_id: str = '') -> None:
        """Cancel the goal ``goal_id``, or, without an id, whatever goal the robot has."""
        check_kind(goal_id, str, 'goal_id')
        self.navigator.cancel(goal_id, 0, self._now_ns())

    def send_task(self, task: Task, goal_id: str = '') -> str:
        """Have the robot, which must stand at the place, do ``task`` (:class:`.arrivals.Task`) now; return its id.

        :raises ConfigurationError: if the scenario says nothing of places.
        """
        check_task(task)
        check_kind(goal_id, str, 'goal_id')
        now_ns, goal_id = self._now_ns(), goal_id or task.task_id
        self._worker().take(goal_id, 0, task, now_ns)
        return goal_id

    def cancel_task(self, goal_id: str = '') -> None:
        """Cancel the task ``goal_id``, or, without an id, whatever task the robot has."""
        check_kind(goal_id, str, 'goal_id')
        now_ns = self._now_ns()
        self._worker().cancel(goal_id, 0, now_ns)

    def place(self, pose: Pose2D) -> None:
        """Put the robot at ``pose`` (global frame) at once. If it has a goal or a velocity, it goes on from there."""
        check_kind(pose, Pose2D, 'pose')
        (self.navigator.travel.place if self._driver is None else self._driver.teleport)(pose, self._now_ns())

    def hold(self, reason: str) -> None:
        """Have the robot stand where it is, with its goal active, for ``reason``, until :meth:`release`."""
        check_kind(reason, str, 'reason')
        self.navigator.travel.hold(reason, self._now_ns())

    def release(self, reason: str) -> None:
        """End the hold for ``reason``. If no other reason holds the robot, its way is planned anew and it goes on."""
        check_kind(reason, str, 'reason')
        self.navigator.travel.release(reason, self._now_ns())

    def fail(self, kind: Optional[str] = None, repair: Optional[float] = None) -> bool:
        """Have the robot fail now; return whether it has. A robot that has failed already does not fail again.

        ``kind``: how it fails; None: as its ``failure_kind`` says. ``repair`` [s]: after how long it is repaired; None:
        as drawn.

        :raises ConfigurationError: if the robot never fails (``failure_kind: none``), or a value is not allowed.
        """
        now_ns, failing = self._now_ns(), self._failing()
        check_request(kind, repair, self._words())
        return failing.fail(REQUEST, now_ns, kind, repair)

    def repair(self) -> bool:
        """Repair the robot now; return whether it had failed.

        :raises ConfigurationError: if the robot never fails (``failure_kind: none``).
        """
        now_ns = self._now_ns()
        return self._failing().repair(now_ns)

    def set_charge(self, state_of_charge: float) -> None:
        """Set the state of charge (0..1) of the robot's battery now.

        :raises ConfigurationError: if the robot has no battery, or the value is not allowed.
        """
        now_ns, battery = self._now_ns(), self._battery()
        battery.set(checked(state_of_charge, 'state_of_charge', STATE_OF_CHARGE, self._words()), now_ns)

    def set_tool(self, works: bool) -> None:
        """Switch the robot's tool on or off now. While it is on, it draws ``tool_power`` from the battery.

        :raises ConfigurationError: if the robot has no battery.
        """
        check_kind(works, bool, 'works')
        now_ns = self._now_ns()
        self._battery().set_tool(works, now_ns)

    def set_priority(self, priority: int) -> None:
        """Give the robot another priority, with which it waits for zones and lanes from now on.

        :raises ConfigurationError: if it is not a whole number of 32 bits.
        """
        number, now_ns = checked(priority, 'priority', PRIORITY, self._words()), self._now_ns()
        if self._traveller is not None:
            self._traveller.set_priority(number, now_ns)

    def set_limits(self, max_speed: Optional[float] = None, acceleration: Optional[float] = None) -> None:
        """Limit the robot's speed [m/s] and acceleration [m/s^2, 0: unlimited] from now on, also on its way.

        A robot on its way goes on from rest. None: as before.

        :raises ConfigurationError: if the robot is driven by velocities, or a number is not allowed.
        """
        now_ns, limits = self._now_ns(), self._robot.limits
        if self._driver is not None:
            raise error(f'{self._words()}: driven_by', VELOCITIES, f'{GOALS}, for a robot with limits that are set')
        if max_speed is not None:
            limits = replace(limits, max_speed=checked(max_speed, 'max_speed', SPEED, self._words()))
        if acceleration is not None:
            limits = replace(limits, acceleration=checked(
                acceleration, 'acceleration', ACCELERATION, self._words()) or math.inf)
        self.navigator.travel.set_motion(limits, self._robot.tolerances, now_ns)

    def scan(self) -> Scan:
        """Return the scan that the robot's laser measures now, by its ``scan_`` parameters."""
        if self._laser is None:
            self._laser = Laser(self._settings.laser, self._settings.values['seed'], self.name)
        occupancy = None if self._map_check is None else self._map_check.occupancy
        return self._fleet.surroundings.scan(self._robot, self._laser, occupancy, self._now_ns())

    def __repr__(self) -> str:
        if not self._is_there:
            return '<robot {}, which was removed from its fleet>'.format(self.name)
        pose = self.pose
        return '<robot {}: {} at ({:.2f}, {:.2f}, {:.2f}) at {:.3f} s>'.format(
            self.name, self.activity, pose.x, pose.y, pose.yaw, self._fleet.now)

    def _now_ns(self) -> int:
        """Return the present [ns]. :raises ConfigurationError: if the robot was removed."""
        if not self._is_there:
            raise ConfigurationError('{} was removed from its fleet'.format(self._words()))
        return self._fleet.simulation.now_ns

    def _words(self) -> str:
        return "robot '{}'".format(self.name)

    def _worker(self) -> PlaceTaskRunner:
        if self._tasks is None:
            raise ConfigurationError('{} cannot work: the scenario has no list of places, which may '
                                     'be empty'.format(self._words()))
        return self._tasks

    def _failing(self) -> Failing:
        if self.condition.failing is None:
            raise ConfigurationError('{}: failure_kind: got none; allowed, for a robot that is to fail: {}'.format(
                self._words(), ', '.join(KINDS)))
        return self.condition.failing

    def _battery(self) -> Battery:
        if self.condition.battery is None:
            raise ConfigurationError('{}: battery_capacity: got 0; allowed, for a battery: > 0 [Ah]'.format(
                self._words()))
        battery: Battery = self.condition.battery
        return battery

    def _warned(self, event: Warned) -> None:
        active = self._ledger.active
        self._fleet._note(FleetWarning(
            event.time_ns, event.robot, active.goal_id if active is not None else '', event.text))

    def _charge_passed(self, event: ChargePassed) -> None:
        if event.what == EMPTY:
            self._warned(Warned(event.time_ns, event.robot, emptied(self.navigator, self._tasks, event.time_ns)))

    def _reset(self, now_ns: int) -> None:
        """Put the robot back to its start, without goals."""
        if self._tasks is not None:
            self._tasks.shut_down(ROBOT_RESET, now_ns)
        self.navigator.reset(ROBOT_RESET, now_ns)
        self._ledger.clear()
        self.condition.reset(now_ns)
        self._robot.set_motion(self._settings.limits, self._settings.tolerances)
        self._robot.reset(self._settings.start, now_ns)
        self._stream.tell(motion_of(self._robot, now_ns))
        self.navigator.travel.tell_stands(now_ns)

    def _remove(self, now_ns: int) -> None:
        """Take the robot out of the fleet: its goal and its tasks end."""
        self._is_there = False
        if self._tasks is not None:
            self._tasks.shut_down(ROBOT_REMOVED, now_ns)
        self.condition.close()
        self.navigator.close(ROBOT_REMOVED, now_ns)
        if self._driver is not None:
            self._driver.close()
        if self._traveller is not None:
            self._traveller.leave(now_ns)
        self._fleet.simulation.queue.guard(self._robot.index, None)
        self._fleet.surroundings.remove(self._robot)

    def _use_map(self, occupancy: OccupancyMap) -> None:
        """Check goals against another map, which stops a robot that is driven."""
        if self._map_check is not None:
            self._map_check.use(occupancy)
            if self._driver is not None:
                self._driver.use_map(occupancy, self._fleet.now_ns)


def _no_lookup(frame_id: str, _stamp_ns: int) -> NoReturn:
    raise FrameError("frame '{}' is unknown; without ROS there are only a robot's own frames".format(frame_id))
