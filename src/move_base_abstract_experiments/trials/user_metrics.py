"""The user's function of a trial: `module:function`, called with what a trial has left, returns numbers by name.

It runs in a process of its own that is no node, once the run is over. An exception in it, or a time limit, is told in
the table and stops nothing.
"""
from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Dict, Iterator, Optional, Tuple

from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog

from ..description.job import Job
from ..description.metric_names import BUILT_IN
from ..records import Result
from . import functions, run_folders

_LIMIT_S = 120.0  # wall


class TrialData:
    """What the function is given.

    configuration: {factor: value}; replication, seed: whole numbers; folder: a Path, with events.jsonl and
    messages.jsonl; files: a Path, where the nodes have left files; built_in: the built-in metrics; robots: {name:
    {goals, distance_m, moving_s, idle_s, waiting_s}}; simulated_seconds.
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
        """Yield (time_ns, robot, kind, values) of the event log."""
        path = str(self.folder / run_folders.LOG)
        with event_log.open_text(path) as stream:
            for event in EventLog(stream, path):
                yield event.time_ns, event.robot, event.kind, json.loads(event.values)

    def messages(self, topic: Optional[str] = None) -> Iterator[Tuple[int, str, Any]]:
        """Yield (time_ns, topic, message) of what was recorded (record.messages), a message being a mapping."""
        path = self.folder / run_folders.MESSAGES
        if path.exists():
            with open(path, encoding='utf-8') as stream:
                for line in stream:
                    record = json.loads(line)
                    if topic is None or record['topic'] == topic:
                        yield record['time_ns'], record['topic'], record['message']


def call(job: Job, folders: run_folders.Folders, result: Result) -> Dict[str, Optional[float]]:
    """Return {name: number or None}. :raises FunctionError: saying what is wrong."""
    experiment = job.trial.experiment

    def work() -> Dict[str, Optional[float]]:
        function = functions.load(experiment.metrics.function, job.modules)
        known = (*BUILT_IN, *result.metrics)
        return functions.checked(function(TrialData(folders, result)), experiment.factors, known)
    found: Dict[str, Optional[float]] = functions.call(work, _LIMIT_S, os.path.join(folders.logs, 'metrics.txt'),
                                                       folders.own)
    return found
