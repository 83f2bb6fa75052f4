"""The class Trial: one run of an experiment's system, and the arguments of the system."""
from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Dict, List

from move_base_abstract.common.options import options_of
from move_base_abstract.lockstep.run_options import POSE, RunOptions

from . import placeholders
from .experiment import Experiment


@dataclass(frozen=True)
class Trial:
    """One trial of an Experiment. ``verified_by``: the condition under which it runs a second time, or ''."""

    experiment: Experiment
    id: str
    configuration: Dict[str, Any]  # {factor: value}
    replication: int
    seed: int
    verified_by: str = ''

    @property
    def values(self) -> Dict[str, Any]:
        """The values of the placeholders: {NAME: value}."""
        return {**self.configuration, 'seed': self.seed, 'replication': self.replication}

    @property
    def launch(self) -> str:
        """The launch file, filled in, or ''."""
        return placeholders.filled(self.experiment.launch, self.values)

    @property
    def network(self) -> str:
        """The network file with its values, filled in, or ''."""
        return placeholders.filled(self.experiment.network, self.values)

    @property
    def command(self) -> List[str]:
        """The words of the command, filled in."""
        return [placeholders.filled(word, self.values) for word in self.experiment.command]

    @property
    def arguments(self) -> List[str]:
        """The launch file's arguments, ARG:=VALUE."""
        return [f'{name}:={placeholders.filled(value, self.values)}' for name, value in self.experiment.args.items()]

    @property
    def function_arguments(self) -> Dict[str, Any]:
        """The args of the trial's function."""
        return {name: placeholders.value_of(value, self.values) for name, value in self.experiment.args.items()}

    @property
    def run_options(self) -> RunOptions:
        """The options of the trial's run, filled in: its seed, its network, its parameters, where its robots start.

        ``until`` is not among them.

        :raises ConfigurationError: if a pose, filled in, is none.
        """
        given = {one.field: getattr(self.experiment, one.field) for one in options_of(RunOptions).values()}
        start = {name: POSE.check(f'start.{name}', placeholders.filled(pose, self.values))
                 for name, pose in self.experiment.start.items()}
        param = {name: placeholders.value_of(value, self.values) for name, value in self.experiment.param.items()}
        return RunOptions(**{**given, 'start': start, 'param': param, 'seed': self.seed, 'network': self.network,
                             'until': 0.0})

    @property
    def first(self) -> Trial:
        """The first replication of the same configuration. The others differ from it only in replication and seed."""
        return dataclasses.replace(self, replication=0, seed=self.experiment.seed)
