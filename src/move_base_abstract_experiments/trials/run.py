"""One run of a launch file or a command in lockstep, from its start to its end; called in a process of its own.

There is no `roslaunch` process. roslaunch's own loader reads the file, and the package `launching` changes it and runs
it. When run() returns, everything that was started has ended.
"""
from __future__ import annotations

import shlex
from typing import Any, List, NamedTuple, Optional

from move_base_abstract.common import processes
from move_base_abstract.runs import ends
from move_base_abstract_ros.launching.conditions import Condition

from ..description.job import Job
from . import run_plan, termination
from .metrics import Starts
from .run_folders import Folders
from .run_plan import Run
from .termination import RunError

_BY_THEMSELVES_S, _AFTER_SIGNAL_S = 6.0, 1.0  # wall; how long processes may take when the run is over


class Ended(NamedTuple):
    """A run that has ended.

    ``starts``: where robots stood at the start, as far as parameters say it. ``processes``: how each ended.
    ``problem``: why the run failed, or None.
    """

    starts: Starts
    processes: List[ends.Process]
    problem: Optional[RunError]


def run(job: Job, folders: Folders, condition: Optional[Condition] = None) -> Ended:
    """Run a Job's launch file or command to its end.

    condition: the condition of a second run, in which each node is started as a program; None: the first run.
    :raises SimulatorError: if it cannot be started.
    """
    from move_base_abstract_ros.launching import bags, outputs, run as launching
    this = Run(job, folders, condition)
    launching.enter(folders.logs, folders.files)
    made = run_plan.plan_of(this)
    started = launching.Run(made, folders.log, outputs.Files(folders.logs),
                            launching.Patience(_BY_THEMSELVES_S, _AFTER_SIGNAL_S), folders.own,
                            this.path(run_plan.START_NOTE), job.is_warm and condition is None, heeds_onlookers=False)
    limit = this.experiment.time_limit
    try:
        started.start(commands=_commands(this))
        problem = started.wait(limit)
        found = started.end()
    finally:
        processes.end_all_children()
    bags.add_to_log(folders.log, bags.written(this.path(bags.NOTES)))
    error = None
    if problem is not None:
        is_late = problem.kind == launching.LIMIT
        error = RunError(problem.text + (f' (time_limit{_not_heeded(made)})' if is_late else ''),
                         termination.TIME_LIMIT if is_late else None)
    elif started.has_failed:
        error = RunError('the run did not end as wished: the time master: ' + started.code_of_time_master)
    return Ended(run_plan.starts_of(made.config), found, error)


def _not_heeded(made: Any) -> str:
    """Return a text about the nodes that would end the run of roslaunch, and do not end a trial."""
    from move_base_abstract_ros.launching import roles
    names = [roles.name_of(node) for node in made.config.nodes if node.required]
    looking = [one.name for one in made.roles if one.name in names and not one.takes_part]
    return '; the end of an onlooker ends no trial: ' + ', '.join(looking) if looking else ''


def _commands(this: Run) -> List[Any]:
    """Return the Commands that are started beside the nodes of the launch file."""
    from move_base_abstract_ros.launching.run import Command
    command, onlooker = this.job.trial.command, list(this.job.onlooker)
    return [Command('the command ' + shlex.quote(words[0]), words, words is command,
                    this.experiment.participants or () if words is command else ())
            for words in (command, onlooker) if words]
