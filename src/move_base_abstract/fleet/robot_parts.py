"""Makes one robot with all its parts, both for the nodes and for the plain Python fleet."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional, Sequence, Union

from ..common.errors import ConfigurationError
from ..common.units import seconds_to_ns
from ..driving.contact import shape_of
from ..driving.driver import Driver
from ..energy.battery import Battery
from ..engine.chance import Chance
from ..faults.buggify import Buggifying
from ..faults.condition import Condition
from ..faults.failing import Failing
from ..faults.failures import ABORT, Failures
from ..goals.events import Beyond
from ..goals.ledger import GoalLedger
from ..goals.navigator import Navigator
from ..goals.outcome import DRIVEN_BY_VELOCITIES
from ..maps.planning import StraightLinePlanner
from ..maps.travel_matrix import MatrixPlanner
from ..motion.attempts import GoalAttempts
from ..motion.durations import GoalDurations
from ..motion.frames import RobotFrames
from ..motion.robot import Robot
from ..motion.route import CornerLaw

if TYPE_CHECKING:
    from ..config.settings import RobotSettings
    from ..driving.contacts import Contacts
    from ..encounters.control import Encounters
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.client import GoalClient
    from ..maps.map_check import MapCheck
    from ..motion.geometry import Pose2D
    from ..traffic.zones import Zone


class RobotParts(NamedTuple):
    """The robot, its frames, the ledger of its goals, the navigator that works on them, and the robot's condition.

    ``driver``: the Driver of a robot that is driven by velocities, otherwise None.
    """

    robot: Robot
    frames: RobotFrames
    ledger: GoalLedger
    navigator: Navigator
    condition: Condition
    driver: Optional[Driver] = None


def make_robot_parts(settings: RobotSettings, name: str, index: int, simulation: Simulation, stream: Stream,
                     client: GoalClient, lookup: Callable[[str, int], Pose2D],
                     planner: Optional[StraightLinePlanner] = None, zones: Sequence[Zone] = (),
                     remembered_legs: int = 64, encounters: Optional[Encounters] = None,
                     contacts: Optional[Contacts] = None, patience_ns: Callable[[], int] = lambda: 0) -> RobotParts:
    """Return the RobotParts of the robot ``name``, which stands at the start of its ``settings`` (RobotSettings).

    ``stream`` (Stream of :mod:`.events`) gets the robot's events, ``client`` (GoalClient) all other answers.
    ``lookup(frame_id, stamp_ns)`` finds foreign frames, ``patience_ns()``: see RobotFrames. ``planner``: None: that
    of :func:`make_planner` without a map. ``remembered_legs``: see Robot. ``encounters``: the Encounters in which the
    robot takes part; None: it meets nobody. ``contacts``: the Contacts of driven robots; None: nothing stops them.
    Feedback is not switched on: see Navigator.feedback.
    """
    values = settings.values
    robot = Robot(index, name, settings.start, settings.limits, settings.tolerances, simulation.now_ns,
                  CornerLaw(values['corners']), settings.phases, remembered_legs, settings.original)
    frames = RobotFrames(robot, values['global_frame'], settings.odom_frame,
                         settings.frame(values['robot_base_frame']), lookup, patience_ns)
    ledger = GoalLedger(name, stream, client, seconds_to_ns(values['status_list_timeout']))
    planner = planner or make_planner(settings)
    durations = _durations(settings, name, planner, stream)
    navigator = Navigator(robot, simulation, ledger, frames, stream, client, planner,
                          settings.bad_frame_policy, settings.recovery, durations,
                          seconds_to_ns(values['longest_wait']))
    simulation.queue.guard(index, navigator.break_off)
    driver = _driver(settings, navigator, simulation, stream, contacts)
    failing: Any = None
    if settings.failures is not None or settings.buggify is not None:
        failing = Failing(settings.failures or Failures(ABORT), robot, navigator, simulation,
                          Chance(values['seed'], name), stream)
    buggifying = None
    if settings.buggify is not None:
        buggifying = Buggifying(settings.buggify, robot, navigator, simulation.queue,
                                Chance(settings.buggify.seed, name), failing, stream)
    battery = None
    if settings.battery is not None:
        battery = Battery(settings.battery, robot, navigator, simulation, tuple(zones), stream)
    meeting = None if encounters is None else encounters.join(navigator, settings.encounters, stream, failing)
    return RobotParts(robot, frames, ledger, navigator, Condition(navigator, failing, battery, (meeting, buggifying)),
                      driver)


def _driver(settings: RobotSettings, navigator: Navigator, simulation: Simulation, stream: Stream,
            contacts: Optional[Contacts]) -> Optional[Driver]:
    if settings.drive is None:
        return None
    navigator.takes_none = DRIVEN_BY_VELOCITIES
    driver = Driver(settings.drive, navigator, simulation, stream)
    if contacts is not None:
        contacts.join(driver, settings.values['global_frame'], shape_of(settings.costmaps.global_footprint))
    return driver


def _durations(settings: RobotSettings, name: str, planner: StraightLinePlanner,
               stream: Stream) -> Union[None, GoalDurations, GoalAttempts]:
    if settings.durations is not None:
        return GoalDurations(
            settings.durations, settings.values['seed'], name, planner, lambda recorded, found, at_ns: stream.tell(
                Beyond(at_ns, name, found, recorded.words(found))))
    if settings.attempts is not None:
        return GoalAttempts(settings.attempts, settings.values['seed'], name)
    return None


def make_planner(settings: RobotSettings, map_check: Optional[MapCheck] = None) -> StraightLinePlanner:
    """Return the planner that ``settings`` (RobotSettings) ask for; ``map_check`` (MapCheck): the map, or None.

    :raises ConfigurationError: if ways are to be planned on a map and there is none.
    """
    routes = settings.values['routes']
    network: Any = settings.network
    if routes == 'none':
        return StraightLinePlanner(settings.bounds, map_check)
    if routes == 'matrix':
        return MatrixPlanner(network, settings.bounds, map_check)
    if routes == 'lanes':
        from ..maps.lane_planner import LanePlanner, LaneWays  # imports numpy, which only planning needs
        return LanePlanner(LaneWays.on(network, settings.limits.max_speed), settings.bounds, map_check)
    if map_check is None:
        raise ConfigurationError("routes: got 'grid' for a robot without a map; allowed: with a map only")
    from ..maps.grid_planner import GridPlanner  # imports numpy, too
    return GridPlanner(map_check, settings.costmaps.global_footprint.inscribed_radius, settings.bounds,
                       settings.costmaps.inflation, settings.plan_tolerance, settings.values['leave_obstacles'])
