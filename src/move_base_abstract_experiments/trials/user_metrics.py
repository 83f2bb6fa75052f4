"""The user's function of a trial: `module:function`, called with what a trial has left, returns numbers by name.

It runs in a process of its own that is no node, once the run is over. An exception in it, or a time limit, is told in
the table and stops nothing.
"""
import json
import os
from pathlib import Path

from move_base_abstract.runs import event_log
from move_base_abstract.runs.event_log import EventLog

from ..description.metric_names import BUILT_IN
from . import functions, run

_LIMIT_S = 120.0  # wall


class TrialData:
    """What the function is given.

    configuration: {factor: value}; replication, seed: whole numbers; folder: a Path, with events.jsonl and
    messages.jsonl; files: a Path, where the nodes have left files; built_in: the built-in metrics; robots: {name:
    {goals, distance_m, moving_s, idle_s, waiting_s}}; simulated_seconds.
    """

    def __init__(self, folder, files, about):
        self.folder = Path(folder)
        self.files = Path(files)
        self.configuration = about['configuration']
        self.replication = about['replication']
        self.seed = about['seed']
        self.built_in = about['metrics']
        self.robots = about['robots']
        self.simulated_seconds = about['simulated_seconds']

    def events(self):
        """Yield (time_ns, robot, kind, values) of the event log."""
        path = str(self.folder / run.LOG)
        with event_log.open_text(path) as stream:
            for event in EventLog(stream, path):
                yield event.time_ns, event.robot, event.kind, json.loads(event.values)

    def messages(self, topic=None):
        """Yield (time_ns, topic, message) of what was recorded (record.messages), a message being a mapping."""
        path = self.folder / run.MESSAGES
        if path.exists():
            with open(path, encoding='utf-8') as stream:
                for line in stream:
                    record = json.loads(line)
                    if topic is None or record['topic'] == topic:
                        yield record['time_ns'], record['topic'], record['message']


def call(job, folders, about):
    """Return ({name: number or None}, what is wrong or None)."""
    def work():
        function = functions.load(job['function'], job['modules'])
        known = (*BUILT_IN, *about['metrics'])
        return functions.checked(function(TrialData(folders.own, folders.files, about)), job['factors'], known)
    try:
        return functions.call(work, _LIMIT_S, os.path.join(folders.logs, 'metrics.txt'), folders.own), None
    except functions.FunctionError as problem:
        return {}, str(problem)
