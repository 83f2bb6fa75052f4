"""The study as a Mesa model: the coordinator's robots are agents, in steps of one second.

A step carries out, in order, all events that are due within it. So straight motion is exact to the nanosecond, although
a step lasts a second: after an arrival in the middle of a step, the dwell starts at once. Mesa's agents show where the
robots are at the end of each step, and its data collector keeps the metrics of each step.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Tuple, Union

import mesa

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.engine.event_queue import EventQueue

from ..ground_truth.field import field_of
from ..ground_truth.inputs import inputs_of
from ..mission.commands import Drive, Place, TakeSample
from ..mission.coordinator import Coordinator
from ..results.result import collect
from ..stopwatch import Stopwatch
from .motion import motion_named

if TYPE_CHECKING:
    from ..config import TrialConfig
    from ..ground_truth.field import Field
    from ..results.result import TrialResult

STEP_NS = NS_PER_S


class RobotAgent(mesa.Agent):
    """One robot. Its pos is (x, y) in the map frame [m], at the end of the last step."""

    def __init__(self, model: SoilMappingModel, robot: int, place: Tuple[float, float]) -> None:
        super().__init__(model)
        self.robot = robot  # index
        self.pos = place
        self.trip: Any = None  # while it drives

    def place_at(self, now_ns: int) -> Tuple[float, float]:
        """Return (x, y) [m] at an instant of the present step [ns]."""
        return self.pos if self.trip is None else self.trip.place_at(now_ns)

    def step(self) -> None:
        """Move to its place at the end of the step."""
        self.pos = self.place_at(self.model.now_ns)


class SoilMappingModel(mesa.Model):
    """A mission on Mesa.

    :param config: a TrialConfig. :param seed: whole number >= 0. :param truth: the Field; None: that of config.
    :param motion: 'euclidean' (straight, constant speed) or 'eight' (one 2 m cell a second, in eight directions).
    :param stopwatch: measures the wall time of the phases; None: nothing is measured.
    :raises ConfigurationError: if motion and config contradict each other.
    """

    def __init__(self, config: TrialConfig, seed: int, truth: Optional[Field] = None, motion: str = 'euclidean',
                 stopwatch: Optional[Stopwatch] = None) -> None:
        super().__init__(seed=seed)
        self._trip: Any = motion_named(motion, config)
        self._queue = EventQueue()
        self.now_ns = 0
        truth = truth or field_of(config)
        self.coordinator = Coordinator(config, seed, truth, stopwatch)
        self.robots = [RobotAgent(self, robot, place) for robot, place in enumerate(self.coordinator.start_places)]
        self.datacollector = mesa.DataCollector(model_reporters={
            'samples': lambda model: len(model.coordinator.log.samples),
            'rmse_kpa': lambda model: getattr(model.coordinator.estimate, 'rmse', None),
            'mean_variance_kpa2': lambda model: getattr(model.coordinator.estimate, 'mean_variance', None)})
        self._carry_out(self.coordinator.start(0))

    def step(self) -> None:
        """Simulate one second, or less if the budget ends or nothing is left to do."""
        to_ns = min(self.now_ns + STEP_NS, self.coordinator.end_ns)
        self._queue.run_until(to_ns, self)
        if not self.coordinator.complete:
            self.now_ns = to_ns
        self.agents.do('step')
        if self.coordinator.complete or self.now_ns >= self.coordinator.end_ns:
            self.coordinator.end(self.now_ns, [Place(*robot.pos) for robot in self.robots])
            self.running = False
        self.datacollector.collect(self)

    def _carry_out(self, commands: Sequence[Union[Drive, TakeSample]]) -> None:
        for command in commands:
            if isinstance(command, Drive):
                self._drive(self.robots[command.robot], command)
            elif isinstance(command, TakeSample):
                self._schedule(self.now_ns + command.dwell_ns, self.robots[command.robot], self._take_sample)

    def _drive(self, robot: Any, command: Drive) -> None:
        robot.trip = self._trip.between(robot.pos, (command.x, command.y), self.coordinator.config.speed, self.now_ns)
        for time_ns, x, y in robot.trip.bends():
            self._queue.schedule(time_ns, robot.robot, lambda due_ns, _, place=Place(x, y):  # type: ignore[misc]
                                 self.coordinator.passed(robot.robot, due_ns, place))
        self._schedule(robot.trip.arrive_ns, robot, self._arrive)

    def _schedule(self, due_ns: int, robot: RobotAgent, action: Callable[..., Any]) -> None:
        self._queue.schedule(due_ns, robot.robot, lambda due_ns, _: action(robot, due_ns))

    def _arrive(self, robot: Any, now_ns: int) -> None:
        robot.pos, robot.trip = robot.trip.place_at(now_ns), None
        self._carry_out(self.coordinator.arrived(robot.robot, now_ns, Place(*robot.pos)))

    def _take_sample(self, robot: RobotAgent, now_ns: int) -> None:
        value = self.coordinator.truth.value_at(*robot.pos)
        self._carry_out(self.coordinator.sampled(robot.robot, now_ns, Place(*robot.pos), value))


def run_mesa_trial(config: TrialConfig, seed: int, motion: str = 'euclidean', truth: Optional[Field] = None,
                   stopwatch: Any = None, inputs: Any = None) -> TrialResult:
    """Run a mission to its end and return its TrialResult; arguments as for SoilMappingModel.

    inputs: as in TrialResult, if truth is given; otherwise they are read before the field is loaded.
    Wall seconds are measured for each phase: start_up (the field and the model), mission (the whole run), and within it
    kriging and allocation.
    """
    stopwatch = stopwatch or Stopwatch()
    with stopwatch.phase('start_up'):
        inputs = inputs_of(config.field) if truth is None else inputs
        model = SoilMappingModel(config, seed, truth, motion, stopwatch)
    with stopwatch.phase('mission'):
        while model.running:
            model.step()
    mission_s = stopwatch.seconds['mission']
    return collect(model.coordinator, {'name': 'mesa', 'motion': motion}, stopwatch.seconds, mission_s, inputs)
