"""The plan: the trials of an experiment, their order and seeds, and which of them run a second time.

Replication k has the same seed in every configuration (common random numbers), so configurations can be compared pair
by pair. All configurations of replication 0 come first. The numbers of replications that a configuration does not have
stay unused. So with more replications the IDs of the trials stay the same.

Whether a trial runs twice follows from the trial alone, so a plan that grows runs no other trials twice than before.
"""
from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import platform
from typing import Any, Dict, List, Optional

from move_base_abstract.common.version import package_version
from move_base_abstract.runs.metrics import METRICS, Metric

from ..records import Plan, Planned
from . import ingredients
from .experiment import Experiment
from .spec import configurations
from .trial import Trial

FORMAT = 1
#: the conditions under which trials run a second time: those of `verify` that do not disturb other trials
CONDITIONS = ('addresses', 'delays', 'hash', 'order')
FUNCTION_CONDITION = 'hash'  # a function runs again in a new Python process with another hash seed
_KEY_DIGITS = 6
_DRAW_DIGITS = 12  # of a digest, in base 16; a float holds them


def trials(experiment: Experiment) -> List[Trial]:
    """Return the Trials of an Experiment in the plan's order."""
    found, number = [], 0
    each = [(one, experiment.replications_of(one)) for one in configurations(experiment)]
    for replication in range(experiment.replications.all):
        for configuration, replications in each:
            number += 1
            if replication < replications:
                seed = experiment.seed + replication
                key = json.dumps([configuration, replication, seed], sort_keys=True)
                found.append(Trial(experiment, f'{number:04d}-{_digest(key)[:_KEY_DIGITS]}', configuration,
                                   replication, seed, _condition(number, key, experiment)))
    return found


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _condition(number: int, key: str, experiment: Experiment) -> str:
    """Return the condition under which a trial runs a second time, or '' if it runs once.

    The digest of its key decides, as a draw. The first trial of the plan runs twice in each case, so that at least one
    does.
    """
    digest = _digest('verify ' + key)
    draw = int(digest[:_DRAW_DIGITS], 16) / 16 ** _DRAW_DIGITS
    if draw >= experiment.verify and (number > 1 or not experiment.verify):
        return ''
    return FUNCTION_CONDITION if experiment.function else CONDITIONS[int(digest[_DRAW_DIGITS:], 16) % len(CONDITIONS)]


def describe(experiment: Experiment, chosen: List[Trial], text: bytes) -> Plan:
    """Return the Plan of an experiment's trials. ``text``: the bytes of its file."""
    paths = {path for one in chosen if one.replication == 0 for path in ingredients.of_trial(one)}
    until, primary, metrics = experiment.until, experiment.primary or None, experiment.known_metrics
    if primary:  # tables have its column and rows also if no trial has a value
        metrics.setdefault(primary, METRICS.get(primary, Metric(primary)))
    return Plan(
        experiment=experiment.name, factors={name: list(values) for name, values in experiment.factors.items()},
        metrics={name: one.described() for name, one in metrics.items()}, primary=primary,
        baseline=experiment.baseline, at_limit=experiment.at_limit, smallest_difference=experiment.smallest_difference,
        until={'seconds': until.seconds or None, 'topic': until.topic or None, 'idle': until.idle,
               **({'at': until.at} if until.at else {})},
        replications=experiment.replications.all, verify=experiment.verify, report=list(experiment.report),
        provenance={**versions(), 'digest': hashlib.sha256(text).hexdigest(), 'folder': experiment.folder,
                    'sources': ingredients.repositories([*paths, __file__])},
        trials=[Planned(one.id, one.configuration, one.replication, one.seed, made_of(one)) for one in chosen])


def versions() -> Dict[str, Any]:
    """Return the versions on which a trial depends, and the machine."""
    return {'package': package_version(), 'python': platform.python_version(), 'machine': platform.platform(),
            'processor': platform.machine(), 'cpus': os.cpu_count() or 1}


def made_of(trial: Trial, made: Optional[Dict[str, str]] = None) -> str:
    """Return a digest of everything on which a trial depends. A complete trial does not run again if it is the same.

    made: the trial's ingredients.of_trial(), if they are known already.
    """
    made = ingredients.of_trial(trial) if made is None else made
    experiment = trial.experiment
    content = [FORMAT, experiment.launch, experiment.command, experiment.participants, experiment.leave_out,
               sorted(experiment.replace.items()), trial.arguments,
               [experiment.until.seconds, experiment.until.topic, experiment.until.idle],
               [*vars(experiment.record).values()], experiment.metrics.function, experiment.sleep,
               trial.configuration, trial.replication, trial.seed, trial.verified_by, package_version(),
               platform.python_version(),
               [experiment.function, trial.function_arguments] if experiment.function else '', experiment.prepare,
               ingredients.by_content(made),
               *experiment.digest_options]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode('utf-8', 'surrogateescape')).hexdigest()


def made_of_each(trial: Trial, made: Dict[str, str]) -> Dict[str, str]:
    """Return {condition: made_of() of a trial that runs a second time under it}; '': if it runs once."""
    return {condition: made_of(dataclasses.replace(trial, verified_by=condition), made)
            for condition in ('', *CONDITIONS)}


def forget() -> None:
    """Forget all files, so that they are read again; otherwise a process reads each once."""
    ingredients.forget()
