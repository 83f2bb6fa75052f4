"""The result of a trial, in the same form for every engine."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Mapping, NamedTuple

import numpy as np

from ..mission.mission_log import Activity
from ..mission.own_code import own_code

if TYPE_CHECKING:
    from ..mission.coordinator import Coordinator


class Metrics(NamedTuple):
    """The figures of one trial.

    rmse_kpa             error of the last map against the truth, over all cells; NaN without a map
    mean_variance_kpa2   mean kriging variance of the last map, over all cells; NaN without a map
    samples              number of readings, including the robots' first ones; a dwell that was cut short does not count
    distance_m           distance driven by all robots, including the driven parts of unfinished legs
    idle_s               time without a task, summed over the robots; dwells are not idle time
    waiting_s            time held up on the way to a task, summed over the robots
    task_s               mean time of all finished tasks of all robots, from the command to drive to the end of the
                         dwell; first samples are no tasks, because they have no leg; NaN without a finished task

    For each robot, idle + waiting + driving + dwelling time is the duration of the mission.
    """

    rmse_kpa: float
    mean_variance_kpa2: float
    samples: int
    distance_m: float
    idle_s: float
    waiting_s: float
    task_s: float


def measure(coordinator: Coordinator) -> Metrics:
    """Return the Metrics of a mission that has ended."""
    log = coordinator.log
    estimate: Any = coordinator.estimate
    return Metrics(
        rmse_kpa=math.nan if estimate is None else estimate.rmse,
        mean_variance_kpa2=math.nan if estimate is None else estimate.mean_variance,
        samples=len(log.samples),
        distance_m=math.fsum(log.driven_m),
        idle_s=sum(robot[Activity.IDLE] for robot in log.seconds_ns) / 1e9,
        waiting_s=sum(robot[Activity.WAITING] for robot in log.seconds_ns) / 1e9,
        task_s=sum(log.task_ns) / len(log.task_ns) / 1e9 if log.task_ns else math.nan,
    )


@dataclass(frozen=True)
class TrialResult:
    """One finished trial. Lists contain records of mission_log.py; maps have shape (rows from the south, columns)."""

    config: dict  # TrialConfig.to_dict()
    seed: int
    engine: dict  # its name under 'name' ('mesa', 'ros'), and its own options: motion, clock mode, factor, ...
    simulated_s: float  # from the start of the mission to its end
    metrics: Metrics
    events: list = field(repr=False)  # of Event
    samples: list = field(repr=False)  # of Sample
    history: list = field(repr=False)  # of Moment
    waypoints: list = field(repr=False)  # of Waypoint
    truth: np.ndarray = field(repr=False)  # kPa
    prediction: np.ndarray = field(repr=False)  # kPa; all NaN without a map
    variance: np.ndarray = field(repr=False)  # kPa^2; all NaN without a map
    cell_m: float = 1.0  # edge of a cell
    about_field: dict = field(default_factory=dict)  # its source, unit, width_m, height_m, and how its size was found
    own_code: dict = field(default_factory=dict)  # SHA-256 of the files of a user's own classes, by name
    inputs: dict = field(default_factory=dict)  # SHA-256 of the files that it read, by purpose: ground_truth/inputs.py
    wall_s: dict = field(default_factory=dict)  # wall seconds of phases: start_up, mission, kriging, allocation, ...
    moving_wall_s: float = math.nan  # wall s from the first command to the end of the mission

    @property
    def speed_up(self) -> Dict[str, float]:
        """Simulated seconds per wall second, ``overall`` (start_up, mission) and while ``moving``; NaN if unknown."""
        overall = self.wall_s.get('start_up', 0.0) + self.wall_s.get('mission', math.nan)
        return {'overall': _ratio(self.simulated_s, overall), 'moving': _ratio(self.simulated_s, self.moving_wall_s)}


def _ratio(simulated_s: float, wall_s: float) -> float:
    return simulated_s / wall_s if wall_s > 0.0 else math.nan


def collect(coordinator: Coordinator, engine: Mapping[str, str], wall_s: Mapping[str, float], moving_wall_s: float,
            inputs: Any = None) -> TrialResult:
    """Return the TrialResult of a mission that has ended; engine, inputs and wall times are those of TrialResult."""
    log, truth = coordinator.log, coordinator.truth
    unknown = np.full(truth.values.shape, np.nan)
    estimate: Any = coordinator.estimate
    return TrialResult(
        config=coordinator.config.to_dict(), seed=coordinator.seed, engine=dict(engine),
        simulated_s=log.duration_ns / 1e9, metrics=measure(coordinator), events=log.events, samples=log.samples,  # type: ignore[operator]
        history=log.history, waypoints=log.waypoints, truth=truth.values,
        prediction=unknown if estimate is None else estimate.mean,
        variance=unknown if estimate is None else estimate.variance,
        cell_m=truth.grid.cell_m, about_field=truth.about, own_code=own_code(coordinator.config),
        inputs=dict(inputs or {}), wall_s=dict(wall_s), moving_wall_s=moving_wall_s)
