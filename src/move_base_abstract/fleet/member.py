"""One robot of a fleet in plain Python: its parts, who is told what of it, and its rows of the trace."""
import itertools

from ..common.errors import FrameError
from ..energy.battery import EMPTY
from ..goals.navigator import NavigatorListener
from ..goals.outcome import BATTERY_EMPTY, ROBOT_REMOVED, ROBOT_RESET
from ..maps.map_check import MapCheck
from ..runs.trace import RobotTrace
from ..sensing.laser import Laser
from ..tasks.worker import Worker
from .robot_parts import make_planner, make_robot_parts


class Member(NavigatorListener):
    """One robot of a :class:`Fleet`, which makes it."""

    def __init__(self, fleet, spec, index, planner, occupancy):
        settings = spec.settings
        self._fleet = fleet
        self._settings = settings
        self._trace = RobotTrace(spec.name, fleet._record, settings.values['log_motion'])
        self.goal_numbers = itertools.count(1)
        values = settings.values
        self._map_check = None
        if occupancy is not None and values['use_map']:
            self._map_check = MapCheck(occupancy, values['allow_unknown'], values['allow_occupied_goals'])
        parts = make_robot_parts(settings, spec.name, index, fleet.simulation, self, self, _no_lookup,
                                 planner or make_planner(settings, self._map_check), fleet.scenario.zones,
                                 remembered_legs=1,  # nobody here can ask for the past
                                 encounters=fleet.encounters)
        self.robot, self._ledger, self.navigator, self.condition = (
            parts.robot, parts.ledger, parts.navigator, parts.condition)
        fleet.surroundings.add(self.robot, values['global_frame'], settings.costmaps.global_footprint)
        self._laser = self.worker = None
        self._trace.motion(self.robot, fleet.now_ns)
        self._trace.recorded(settings.durations, fleet.now_ns)
        self._traveller = fleet.traffic.join(self.navigator, settings.network, self._trace.note, self.warn)
        if fleet._rooms is not None:
            self.worker = Worker(fleet._rooms, self.robot, values['seed'], fleet._record,
                                 lambda record, stamp_ns: fleet._tell(fleet._on_worked, spec.name, record, stamp_ns),
                                 lambda: self.condition.is_out_of_order,
                                 None if self.condition.battery is None else self.condition.battery.load)
        self.condition.begin(fleet.now_ns)

    def reset(self, now_ns):
        """Bring it back to its start, without goals."""
        if self.worker is not None:
            self.worker.tasks.shut_down(ROBOT_RESET, now_ns)
        self.navigator.reset(ROBOT_RESET, now_ns)
        self._ledger.clear()
        self.condition.reset(now_ns)
        self.robot.reset(self._settings.start, now_ns)
        self._trace.motion(self.robot, now_ns)
        self.stands(self.robot, now_ns)

    def remove(self, now_ns):
        """Take it out of the fleet: its goal and its tasks end."""
        if self.worker is not None:
            self.worker.tasks.shut_down(ROBOT_REMOVED, now_ns)
        self.condition.close()
        self.navigator.close(ROBOT_REMOVED, now_ns)
        if self._traveller is not None:
            self._traveller.leave(now_ns)
        self._fleet.simulation.queue.guard(self.robot.index, None)
        self._fleet.surroundings.remove(self.robot)

    def use_map(self, occupancy):
        """Have goals judged by another map (OccupancyMap)."""
        if self._map_check is not None:
            self._map_check.use(occupancy)

    def scan(self, now_ns):
        """Return the Scan of its laser."""
        if self._laser is None:
            self._laser = Laser(self._settings.laser, self._settings.values['seed'], self.robot.name)
        occupancy = None if self._map_check is None else self._map_check.occupancy
        return self._fleet.surroundings.scan(self.robot, self._laser, occupancy, now_ns)

    def departed(self, robot, goal, now_ns):
        """It starts for ``goal``; as of NavigatorListener, and so the following."""
        self._trace.departed(goal, now_ns, robot.leg.corners)
        if self.worker is not None:
            self.worker.tasks.moved(now_ns)
        if self._traveller is not None:
            self._traveller.departed(robot.leg, now_ns)

    def stands(self, robot, now_ns):
        """It stands still."""
        try:
            self._trace.stands(robot.pose_at(now_ns), now_ns)
            if self.worker is not None:
                self.worker.tasks.moved(now_ns)
        finally:  # its places are its own, whatever goes wrong with the rest
            if self._traveller is not None:
                self._traveller.stands(now_ns)

    def beyond(self, recorded, found, now_ns):
        """Its goal lies outside of what was recorded."""
        self._trace.note('beyond', now_ns, *found)
        self._fleet._warn_of_beyond(self.robot.name, recorded.words(found))

    def abandons(self, now_ns):
        """Its goal is given up or replaced."""
        if self._traveller is not None:
            self._traveller.abandons(now_ns)

    def broken_off(self, now_ns):
        """Something went wrong in the midst of an event."""
        if self._traveller is not None:
            self._traveller.put_in_order(now_ns)

    def held(self, reasons, now_ns):
        """It is held for ``reasons``, or for none any more."""
        self._trace.held(reasons, now_ns)

    def failed(self, kind, cause, now_ns):
        """It has failed."""
        self._trace.failed(kind, cause, now_ns)
        if self.worker is not None:
            self.worker.tasks.failed(now_ns)

    def battery(self, level, what, now_ns):
        """Its state of charge has passed a level."""
        self._trace.battery(level, what, now_ns)
        if what == EMPTY and self.worker is not None:
            self.worker.tasks.shut_down(BATTERY_EMPTY, now_ns)

    def charging(self, charger, is_charging, now_ns):
        """It is charged, or no more."""
        self._trace.charging(charger, is_charging, now_ns)

    def noted(self, kind, now_ns, *values):
        """A row of its own."""
        self._trace.note(kind, now_ns, *values)

    def repaired(self, now_ns):
        """It is as before."""
        self._trace.repaired(now_ns)

    def publish_status(self):
        """Nobody is told of states here."""

    def new_id(self, now_ns):
        """Return an id for a goal without one."""
        return '{}-{}'.format(self.robot.name, now_ns)

    def publish_result(self, record, stamp_ns):
        """A goal has ended."""
        self._trace.ended(record, stamp_ns)
        self._fleet._tell(self._fleet._on_end, self.robot.name, record, stamp_ns)


def _no_lookup(frame_id, _stamp_ns):
    raise FrameError("frame '{}' is unknown; without ROS there are only a robot's own frames".format(frame_id))
