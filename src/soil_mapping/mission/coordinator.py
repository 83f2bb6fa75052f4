"""The mission decides which robot samples where and when. An engine reports what happened, and gets commands.

An engine (the Mesa model, the ROS node) moves the robots. It calls

    coordinator.start(now_ns)                        once; the robots stand at coordinator.start_places
    coordinator.arrived(robot, now_ns, place)        a Drive has succeeded
    coordinator.failed(robot, now_ns, place)         a Drive has failed: the task is dropped
    coordinator.sampled(robot, now_ns, place, value) a TakeSample has ended
    coordinator.passed(robot, now_ns, place)         a driving robot is here; only for ways that are not straight
    coordinator.held / resumed(robot, now_ns)        a robot with a task cannot go on, or can go on again
    coordinator.end(now_ns, places)                  at coordinator.end_ns, or once coordinator.complete

and carries out the commands (commands.py) that each call returns, in their order. Times are simulated nanoseconds and
never decrease. Calls of the same instant come in the order of the robots' indices, so that every engine gets the same
mission. Events at end_ns still count if they are reported before end. Calls after the end change nothing.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple

from move_base_abstract.common.units import seconds_to_ns

from ..config import Sampling
from ..interpolation.kriging import MIN_SAMPLES, Kriging
from ..seeds import Purpose, generator
from ..stopwatch import Stopwatch
from .allocation import Allocator
from .commands import FIRST_SAMPLE, Drive, Stop, TakeSample
from .mission_log import Activity, MissionLog
from .own_code import OwnAllocator, OwnSampling, is_own
from .sampling import make_sampling, start_places

if TYPE_CHECKING:
    from ..config import TrialConfig
    from ..ground_truth.field import Field
    from .commands import Place
    from .sampling import Task


class Coordinator:
    """The state machine of one mission, from its start to its end.

    :param config: a TrialConfig.
    :param seed: whole number >= 0; it decides starts, random tasks and dwells, each with a generator of its own.
    :param truth: the Field to map; the map has its grid, and the RMSE is the difference from it.
    :param stopwatch: any object whose phase(name) is a context manager; it measures 'kriging' and 'allocation'.
    """

    def __init__(self, config: TrialConfig, seed: int, truth: Field, stopwatch: Optional[Stopwatch] = None) -> None:
        self.config = config
        self.seed = seed
        self.truth = truth
        self.start_places = start_places(config.robots, seed, truth.grid)
        self.estimate = None  # the latest Estimate; None before the third sample
        self.log = MissionLog(config.robots)
        self._stopwatch = stopwatch or Stopwatch()
        self._kriging: Any = Kriging(truth.grid)
        self._sampling = (OwnSampling if is_own(config.sampling) else make_sampling)(config, seed, truth.grid)
        if is_own(config.allocation):
            self._allocator: Any = OwnAllocator(config, seed, truth.grid, self.start_places)
        else:
            self._allocator = Allocator(config.allocation, self.start_places)
        self._dwells = [generator(seed, Purpose.DWELL, robot) for robot in range(config.robots)]
        self._current: Any = [None] * config.robots  # the Task that a robot drives to or samples
        self._start_ns: Any = None
        self._over = False

    @property
    def end_ns(self) -> Any:
        """When the budget ends [simulated ns]; None before the start."""
        return None if self._start_ns is None else self._start_ns + seconds_to_ns(self.config.budget_s)

    @property
    def complete(self) -> bool:
        """Whether nothing is left to do: no task is open, and no more tasks can be made."""
        return self._start_ns is not None and self._sampling.exhausted and not self._busy_robots() \
            and not any(self._allocator.queues)

    def queue(self, robot: int) -> Tuple[Task, ...]:
        """Return the tasks that a robot has not begun, in the order of its way."""
        return tuple(self._allocator.queues[robot])

    def current_task(self, robot: int) -> Optional[Task]:
        """Return the Task that a robot drives to or samples, or None."""
        return self._current[robot]

    # ------------------------------------------------------------------------------------------ reports

    def start(self, now_ns: Any) -> Any:
        """Begin the mission at now_ns; return the first commands.

        With random and dynamic sampling each robot first samples where it stands. With the grid all tasks exist at
        once.
        """
        self._start_ns = now_ns
        self.log.start(now_ns, self.start_places)
        if not self._sampling.first_samples:
            return self._plan(now_ns)
        return [self._take_sample(robot, now_ns, FIRST_SAMPLE) for robot in range(self.config.robots)]

    def arrived(self, robot: int, now_ns: int, place: Place) -> List[TakeSample]:
        """Note that a robot has reached its goal at a Place; return the commands that follow."""
        if self._over:
            return []
        self.log.arrived(robot, now_ns, place, self._current[robot].number)
        return [self._take_sample(robot, now_ns, self._current[robot].number)]

    def failed(self, robot: int, now_ns: int, place: Place) -> List[Drive]:
        """Note that a robot has given its goal up at a Place; drop the task, and return the commands that follow."""
        if self._over:
            return []
        self.log.failed(robot, now_ns, place, self._current[robot].number)
        self._release(robot, (place.x, place.y))
        return self._dispatch(now_ns)

    def sampled(self, robot: int, now_ns: int, place: Place, value: float) -> List[Drive]:
        """Note a value [kPa] that a robot has read at a Place; return the commands that follow."""
        if self._over:
            return []
        task: Any = self._current[robot]
        self.log.sampled(robot, now_ns, place, FIRST_SAMPLE if task is None else task.number, value)
        self._release(robot, (place.x, place.y))
        self._update_map(now_ns)
        if self._wants_tasks():
            return self._plan(now_ns)
        return self._dispatch(now_ns)

    def passed(self, robot: int, now_ns: int, place: Place) -> None:
        """Note the Place of a robot on its way, for its trajectory and its driven distance; this is no event."""
        if not self._over:
            self.log.passed(robot, now_ns, place)

    def held(self, robot: int, now_ns: int) -> None:
        """Note that a driving robot is held up."""
        if not self._over:
            self.log.held(robot, now_ns)

    def resumed(self, robot: int, now_ns: int) -> None:
        """Note that a robot that was held up drives on."""
        if not self._over:
            self.log.resumed(robot, now_ns)

    def end(self, now_ns: int, places: Sequence[Place]) -> List[Stop]:
        """End the mission; places: a Place for each robot. Return a Stop for each robot that drives or samples."""
        if self._over:
            return []
        self._over = True
        busy = self._busy_robots()
        self.log.end(now_ns, places)
        return [Stop(robot) for robot in busy]

    # ------------------------------------------------------------------------------------------ decisions

    def _busy_robots(self) -> List[int]:
        return [robot for robot in range(self.config.robots) if self.log.activity(robot) is not Activity.IDLE]

    def _wants_tasks(self) -> bool:
        """Return whether the sample that was just taken requires new tasks.

        From the third sample on, each one does. Before, there is no map. But if fewer than 3 robots have taken their
        first samples, they would wait for ever, so tasks are made when no robot has one.
        """
        if self.config.sampling is Sampling.GRID:
            return False
        return self.estimate is not None or not (self._busy_robots() or any(self._allocator.queues))

    def _take_sample(self, robot: int, now_ns: int, task_number: int) -> TakeSample:
        spread = self.config.dwell_spread_s
        dwell_s = self.config.dwell_s + (self._dwells[robot].uniform(-spread, spread) if spread else 0.0)
        command = TakeSample(robot, task_number, seconds_to_ns(dwell_s))
        self.log.sampling(robot, now_ns, task_number, command.dwell_ns)
        return command

    def _release(self, robot: int, position: Tuple[float, float]) -> None:
        self._current[robot] = None
        self._allocator.free_at(robot, position)

    def _update_map(self, now_ns: int) -> None:
        samples = self.log.samples
        if len(samples) < MIN_SAMPLES:
            return
        with self._stopwatch.phase('kriging'):
            self.estimate = self._kriging.estimate([(s.x, s.y) for s in samples], [s.value for s in samples],
                                                   self.truth.values)
        self.log.mapped(now_ns, self.estimate)

    def _plan(self, now_ns: int) -> List[Drive]:
        """Make tasks, allocate them, and send off all idle robots that have a task."""
        with self._stopwatch.phase('allocation'):
            tasks = self._sampling.new_tasks(self.estimate)
            for task in tasks:
                self.log.allocated(self._allocator.allocate(task), now_ns, task)
        return self._dispatch(now_ns)

    def _dispatch(self, now_ns: int) -> List[Drive]:
        commands = []
        for robot in range(self.config.robots):
            if self.log.activity(robot) is Activity.IDLE and self._allocator.queues[robot]:
                task = self._allocator.take(robot)
                self._current[robot] = task
                self.log.driving(robot, now_ns, task)
                commands.append(Drive(robot, task.number, task.x, task.y))
        return commands
