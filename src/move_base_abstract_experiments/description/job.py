"""A Job: what goes to a worker. It travels as a pickle; of a batch all that its jobs share travels once."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, NamedTuple, Tuple

from .ingredients import Files
from .trial import Trial

ROS, NUMPY = 'ros', 'numpy'


class Common(NamedTuple):
    """What the jobs of all trials of an experiment share. ``sources``: {path: text} of the modules of functions."""

    sources: Dict[str, str]
    version: str  # of this package
    view: Tuple[str, ...]  # of worker_files
    warm: Tuple[str, ...] = (ROS, NUMPY)  # which of these the warm process has imported


@dataclass(frozen=True)
class Job:
    """A trial that is to run, and what it was made of when the experiment was started."""

    trial: Trial
    common: Common
    made_of: str
    program: str
    files: Files
    parameters: Tuple[Tuple[str, str], ...]  # of the launch file
    modules: str = ''  # the folder where the worker finds the modules of functions
    is_warm: bool = True
    speed_limit: float = 0.0  # times real time; 0: none
    onlooker: Tuple[str, ...] = ()  # words of a program that looks on, such as RViz
    crashed_before: Tuple[str, ...] = ()  # what crashed in its first attempt

    @property
    def prepared(self) -> Any:
        """By what a warm process must have been prepared: None, or the function, its arguments and its modules."""
        experiment = self.trial.experiment
        return (experiment.prepare, experiment.args, experiment.factors,
                self.common.sources) if experiment.prepare else None

    @property
    def wall_limit(self) -> float:
        """How long its runs may take together [s, wall]."""
        return self.trial.experiment.time_limit * (2 if self.trial.verified_by else 1)
