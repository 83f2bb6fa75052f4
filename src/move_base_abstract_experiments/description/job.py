"""The class Job: what is sent to a worker. It travels as a pickle; in a batch, what its jobs share is sent once."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, NamedTuple, Tuple

from .ingredients import Files
from .trial import Trial

ROS, NUMPY = 'ros', 'numpy'


class Common(NamedTuple):
    """The part that the jobs of all trials of an experiment share.

    ``sources``: {path: text} of the modules of the user's functions. ``view``: worker_files.view() of the computer that
    started the experiment.
    """

    sources: Dict[str, str]
    version: str  # of this package
    view: Tuple[str, ...]
    warm: Tuple[str, ...] = (ROS, NUMPY)  # what the warm process has imported, of these two


@dataclass(frozen=True)
class Job:
    """A trial that is to run, and its ingredients when the experiment was started."""

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
        """How a warm process must be prepared: None, or the function, its args, the factors and the modules."""
        experiment = self.trial.experiment
        return (experiment.prepare, experiment.args, experiment.factors,
                self.common.sources) if experiment.prepare else None

    @property
    def wall_limit(self) -> float:
        """The time that the trial's runs may take together [s, wall]."""
        return self.trial.experiment.time_limit * (2 if self.trial.verified_by else 1)
