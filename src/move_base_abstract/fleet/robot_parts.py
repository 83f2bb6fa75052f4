"""Makes one robot with all its parts, both for the nodes and for the plain Python fleet."""
from typing import NamedTuple

from ..common.errors import ConfigurationError
from ..common.units import seconds_to_ns
from ..energy.battery import Battery
from ..engine.chance import Chance
from ..faults.buggify import Buggifying
from ..faults.condition import Condition
from ..faults.failing import Failing
from ..faults.failures import ABORT, Failures
from ..goals.events import Beyond, Ended, new
from ..goals.ledger import GoalLedger
from ..goals.navigator import Navigator
from ..maps.planning import StraightLinePlanner
from ..maps.travel_matrix import MatrixPlanner
from ..motion.attempts import GoalAttempts
from ..motion.durations import GoalDurations
from ..motion.frames import RobotFrames
from ..motion.robot import Robot
from ..motion.route import CornerLaw


class RobotParts(NamedTuple):
    """The robot, its frames, the ledger of its goals, the navigator that works on them, and the robot's condition."""

    robot: Robot
    frames: RobotFrames
    ledger: GoalLedger
    navigator: Navigator
    condition: Condition


def make_robot_parts(settings, name, index, simulation, stream, client, lookup, planner=None, zones=(),
                     remembered_legs=64, encounters=None):
    """Return the RobotParts of the robot ``name``, which stands at the start of its ``settings`` (RobotSettings).

    ``stream`` (Stream of :mod:`.events`) gets the robot's events, ``client`` (GoalClient) all other answers.
    ``lookup(frame_id, stamp_ns)`` finds foreign frames, see RobotFrames. ``planner``: None: that of
    :func:`make_planner` without a map. ``remembered_legs``: see Robot. ``encounters``: the Encounters in which the
    robot takes part; None: it meets nobody. Feedback is not switched on: see Navigator.feedback.
    """
    values = settings.values
    robot = Robot(index, name, settings.start, settings.limits, settings.tolerances, simulation.now_ns,
                  CornerLaw(values['corners']), settings.phases, remembered_legs, settings.original)
    frames = RobotFrames(robot, values['global_frame'], settings.odom_frame,
                         settings.frame(values['robot_base_frame']), lookup)
    ledger = GoalLedger(client.publish_status, lambda record, stamp_ns: stream.tell(new(Ended, (
        stamp_ns, name, record.goal_id, record.stamp_ns, record.state, record.text))), client.new_id,
        seconds_to_ns(values['status_list_timeout']))
    planner = planner or make_planner(settings)
    durations = None
    if settings.durations is not None:
        durations = GoalDurations(settings.durations, values['seed'], name, planner, lambda recorded, found, at_ns: (
            stream.tell(Beyond(at_ns, name, found, recorded.words(found)))))
    elif settings.attempts is not None:
        durations = GoalAttempts(settings.attempts, values['seed'], name)
    navigator = Navigator(robot, simulation, ledger, frames, stream, client, planner,
                          settings.bad_frame_policy, settings.recovery, durations)
    simulation.queue.guard(index, navigator.break_off)
    failing = None
    if settings.failures is not None or settings.buggify is not None:
        failing = Failing(settings.failures or Failures(ABORT), robot, navigator, simulation,
                          Chance(values['seed'], name), stream)
    buggifying = None
    if settings.buggify is not None:
        buggifying = Buggifying(settings.buggify, robot, navigator, simulation.queue,
                                Chance(settings.buggify.seed, name), failing, stream)
    battery = None
    if settings.battery is not None:
        battery = Battery(settings.battery, robot, navigator, simulation, zones, stream)
    meeting = None if encounters is None else encounters.join(navigator, settings.encounters, stream)
    return RobotParts(robot, frames, ledger, navigator, Condition(navigator, failing, battery, (meeting, buggifying)))


def make_planner(settings, map_check=None):
    """Return the planner that ``settings`` (RobotSettings) ask for; ``map_check`` (MapCheck): the map, or None.

    :raises ConfigurationError: if ways are to be planned on a map and there is none.
    """
    routes = settings.values['routes']
    if routes == 'none':
        return StraightLinePlanner(settings.bounds, map_check)
    if routes == 'matrix':
        return MatrixPlanner(settings.network, settings.bounds, map_check)
    if routes == 'lanes':
        from ..maps.lane_planner import LanePlanner, LaneWays  # imports numpy, which only planning needs
        return LanePlanner(LaneWays.on(settings.network, settings.limits.max_speed), settings.bounds, map_check)
    if map_check is None:
        raise ConfigurationError("routes: got 'grid' for a robot without a map; allowed: with a map only")
    from ..maps.grid_planner import GridPlanner  # imports numpy, too
    return GridPlanner(map_check, settings.costmaps.global_footprint.inscribed_radius, settings.bounds)
