"""Call the user's function for metrics: `module:function` gets the outputs of a trial and returns numbers by name.

It runs in a process of its own, which is no node, when the run is over. If it raises an exception or takes too long,
the terminal and the table say so.
"""
from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Dict, Iterator, Optional, Tuple

from move_base_abstract.runs import event_log
from move_base_abstract.runs.calls import call as call_apart
from move_base_abstract.runs.metrics import USUAL

from ..description.job import Job
from ..records import Result
from . import functions, run_folders

_LIMIT_S = 120.0  # wall


class TrialData:
    """The argument of the function: the outputs of a trial.

    configuration: {factor: value}; replication, seed: whole numbers; folder: a Path, with events.jsonl and
    messages.jsonl; files: a Path, the working folder of the nodes with their files; built_in: the built-in metrics;
    robots: {name: {goals, distance_m, moving_s, idle_s, waiting_s, and further states in which robots were}};
    simulated_seconds.
    """

    def __init__(self, folders: run_folders.Folders, result: Result) -> None:
        self.folder = Path(folders.own)
        self.files = Path(folders.files)
        self.configuration = result.configuration
        self.replication = result.replication
        self.seed = result.seed
        self.built_in = result.metrics
        self.robots = result.robots
        self.simulated_seconds = result.simulated_seconds

    def events(self) -> Iterator[Tuple[int, str, str, Any]]:
        """Yield (time_ns, robot, kind, values) for each event of the event log; time_ns is simulated time [ns]."""
        with event_log.opened(self.folder / run_folders.LOG) as log:
            yield from log.rows()

    def messages(self, topic: Optional[str] = None) -> Iterator[Tuple[int, str, Any]]:
        """Yield (time_ns, topic, message) for each recorded message (record.messages); the message is a mapping.

        :param topic: only messages of this topic; None: of all.
        """
        path = self.folder / run_folders.MESSAGES
        if path.exists():
            with open(path, encoding='utf-8') as stream:
                for line in stream:
                    record = json.loads(line)
                    if topic is None or record['topic'] == topic:
                        yield record['time_ns'], record['topic'], record['message']


def call(job: Job, folders: run_folders.Folders, result: Result) -> Dict[str, Optional[float]]:
    """Call the user's function for metrics; return {name: number or None}.

    :raises CallError: saying what is wrong.
    """
    experiment = job.trial.experiment

    def work() -> Dict[str, Optional[float]]:
        function = functions.load(experiment.metrics.function, job.modules)
        known = (*USUAL, *result.metrics)
        return functions.checked(function(TrialData(folders, result)), experiment.factors, known)
    found: Dict[str, Optional[float]] = call_apart(work, _LIMIT_S, os.path.join(folders.logs, 'metrics.txt'),
                                                   folders.own)
    return found
