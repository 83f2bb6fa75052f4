"""A Trial: one run of an experiment's system, and what that is given."""
from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, Dict, List

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
        """What {NAME} stands for."""
        return {**self.configuration, 'seed': self.seed, 'replication': self.replication}

    @property
    def launch(self) -> str:
        """The launch file, filled in, or ''."""
        return placeholders.filled(self.experiment.launch, self.values)

    @property
    def network(self) -> str:
        """The network's file with its values, filled in, or ''."""
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
        """What the trial's function gets as its args."""
        return {name: placeholders.value_of(value, self.values) for name, value in self.experiment.args.items()}

    @property
    def first(self) -> Trial:
        """The first replication of the same configuration: the others differ in their seeds alone."""
        return dataclasses.replace(self, replication=0, seed=self.experiment.seed)
