"""The log of a mission: events, samples, the map's history, and the times and distances of each robot."""
from __future__ import annotations

import math
from enum import Enum
from typing import TYPE_CHECKING, Any, List, NamedTuple, Sequence, Tuple

from .commands import FIRST_SAMPLE

if TYPE_CHECKING:
    from .commands import Place
    from .sampling import Task

NOBODY = -1  # as a robot's index: the event concerns the mission


class Activity(Enum):
    """What a robot does. The log adds up the time of each activity."""

    IDLE = 'idle'  # no task to do
    DRIVING = 'driving'  # from the command to drive to the arrival, or to giving up
    SAMPLING = 'sampling'  # the dwell
    WAITING = 'waiting'  # it has a task but is held up


class Event(NamedTuple):
    """One line of the event log. Values that do not apply are NaN, or -1 for whole numbers."""

    time_ns: int  # simulated ns since the start of the mission
    robot: int  # index, or NOBODY
    event: str  # start, allocate, drive, arrive, fail, dwell, sample, map, hold, resume, stop, end
    task: int  # number of the task, or FIRST_SAMPLE
    x_m: float  # place of the robot or the task, map frame
    y_m: float
    value: float  # sample: kPa; map: the RMSE in kPa; dwell: its length in s


class Sample(NamedTuple):
    """One reading of a robot."""

    time_ns: int  # end of the dwell, simulated ns since the start of the mission
    robot: int
    task: int
    x: float  # m, map frame
    y: float
    value: float  # kPa


class Moment(NamedTuple):
    """The state of the map after a sample."""

    time_ns: int  # simulated ns since the start of the mission
    samples: int
    rmse_kpa: float
    mean_variance_kpa2: float
    variogram_psill: float
    variogram_range_m: float
    variogram_nugget: float
    finished_tasks: int  # without the first samples
    distance_m: float  # sum of all legs that have ended


class Waypoint(NamedTuple):
    """A robot's place at an instant at which it began or ended something, or passed a place."""

    time_ns: int
    robot: int
    x: float
    y: float


class MissionLog:
    """Takes notes. Its methods get times of the clock; the times in its lists count from the start of the mission."""

    def __init__(self, robots: int) -> None:
        self.events: List[Any] = []
        self.samples: List[Any] = []
        self.history: List[Any] = []
        self.waypoints: List[Any] = []
        self.driven_m = [0.0] * robots
        self.seconds_ns = [dict.fromkeys(Activity, 0) for _ in range(robots)]
        # Simulated ns from the start of the leg to the end of the dwell, for each finished task.
        self.task_ns: List[Any] = []
        self.duration_ns = None  # simulated ns; None until the end
        self._start_ns: Any = None
        self._places = [(math.nan, math.nan)] * robots
        self._activity = [Activity.IDLE] * robots
        self._since_ns = [0] * robots
        self._leg_began_ns = [0] * robots

    def activity(self, robot: int) -> Activity:
        """Return the Activity of a robot now."""
        return self._activity[robot]

    def start(self, now_ns: Any, places: Sequence[Tuple[float, float]]) -> None:
        """Note the start and the places (x, y) of the robots."""
        self._start_ns = now_ns
        for robot, (x, y) in enumerate(places):
            self._places[robot] = (x, y)
            self._note(now_ns, robot, 'start', x=x, y=y)
            self.waypoints.append(Waypoint(0, robot, x, y))

    def allocated(self, robot: int, now_ns: int, task: Task) -> None:
        """Note that a robot got a task."""
        self._note(now_ns, robot, 'allocate', task.number, task.x, task.y)

    def driving(self, robot: int, now_ns: int, task: Task) -> None:
        """Note that a robot is sent to a task."""
        self._become(robot, now_ns, Activity.DRIVING)
        self._leg_began_ns[robot] = now_ns
        self._note(now_ns, robot, 'drive', task.number, task.x, task.y)

    def arrived(self, robot: int, now_ns: int, place: Place, task: int) -> None:
        """Note the end of a leg; the dwell follows."""
        self.passed(robot, now_ns, place)
        self._note(now_ns, robot, 'arrive', task, place.x, place.y)

    def passed(self, robot: int, now_ns: int, place: Place) -> None:
        """Note a place on the way, or at its end."""
        old = self._places[robot]
        driven = math.dist(old, (place.x, place.y)) if place.driven_m is None else place.driven_m
        self.driven_m[robot] += driven
        self._places[robot] = (place.x, place.y)
        self.waypoints.append(Waypoint(now_ns - self._start_ns, robot, place.x, place.y))

    def failed(self, robot: int, now_ns: int, place: Place, task: int) -> None:
        """Note that a leg was given up."""
        self.passed(robot, now_ns, place)
        self._become(robot, now_ns, Activity.IDLE)
        self._note(now_ns, robot, 'fail', task, place.x, place.y)

    def sampling(self, robot: int, now_ns: int, task: int, dwell_ns: int) -> None:
        """Note the beginning of a dwell."""
        self._become(robot, now_ns, Activity.SAMPLING)
        self._note(now_ns, robot, 'dwell', task, *self._places[robot], dwell_ns / 1e9)

    def sampled(self, robot: int, now_ns: int, place: Place, task: int, value: float) -> None:
        """Note the end of a dwell and its reading [kPa]."""
        self.passed(robot, now_ns, place)
        self._become(robot, now_ns, Activity.IDLE)
        if task != FIRST_SAMPLE:
            self.task_ns.append(now_ns - self._leg_began_ns[robot])
        self.samples.append(Sample(now_ns - self._start_ns, robot, task, place.x, place.y, value))
        self._note(now_ns, robot, 'sample', task, place.x, place.y, value)

    def mapped(self, now_ns: int, estimate: Any) -> None:
        """Note the Estimate of the map from all samples so far."""
        fit = estimate.variogram
        self.history.append(Moment(now_ns - self._start_ns, len(self.samples), estimate.rmse, estimate.mean_variance,
                                   fit.psill, fit.range_m, fit.nugget, len(self.task_ns), sum(self.driven_m)))
        self._note(now_ns, NOBODY, 'map', value=estimate.rmse)

    def held(self, robot: int, now_ns: int) -> None:
        """Note that a driving robot is held up."""
        if self._activity[robot] is Activity.DRIVING:
            self._become(robot, now_ns, Activity.WAITING)
            self._note(now_ns, robot, 'hold')

    def resumed(self, robot: int, now_ns: int) -> None:
        """Note that a robot that was held up drives on."""
        if self._activity[robot] is Activity.WAITING:
            self._become(robot, now_ns, Activity.DRIVING)
            self._note(now_ns, robot, 'resume')

    def end(self, now_ns: Any, places: Sequence[Place]) -> None:
        """Note the end of the mission and the Places of the robots; parts of legs count."""
        for robot, place in enumerate(places):
            if self._activity[robot] is not Activity.IDLE:
                self._note(now_ns, robot, 'stop', x=place.x, y=place.y)
            self.passed(robot, now_ns, place)
            self._become(robot, now_ns, Activity.IDLE)
        self.duration_ns = now_ns - self._start_ns
        self._note(now_ns, NOBODY, 'end')

    def _note(self, now_ns: int, robot: int, event: str, task: int = FIRST_SAMPLE, x: float = math.nan,
              y: float = math.nan, value: float = math.nan) -> None:
        self.events.append(Event(now_ns - self._start_ns, robot, event, task, float(x), float(y), float(value)))

    def _become(self, robot: int, now_ns: int, activity: Activity) -> None:
        since_ns = max(self._since_ns[robot], self._start_ns)
        self.seconds_ns[robot][self._activity[robot]] += now_ns - since_ns
        self._activity[robot] = activity
        self._since_ns[robot] = now_ns
