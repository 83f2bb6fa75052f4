"""The trials of an experiment: which there are, in which order, with which seeds, and which run a second time.

Replication k has the same seed in every configuration: common random numbers, so that configurations can be compared
pair by pair. All configurations of replication 0 come first, and those that have fewer replications leave their numbers
out, so that more replications change no id of a trial.
"""
import functools
import hashlib
import json
import math
import os
import platform
import re
from pathlib import Path
from typing import NamedTuple

from . import checks, ingredients
from .spec import configurations

FORMAT = 1
#: conditions under which a trial runs once more, in turn; they are those of `verify` that disturb no trial beside it
CONDITIONS = ('addresses', 'delays', 'hash', 'order')
FUNCTION_CONDITION = 'hash'  # of a function: in a Python that is started anew, with another hash seed
_KEY_DIGITS = 6


class Trial(NamedTuple):
    """One trial. ``verified_by``: the condition under which it runs a second time, or ''."""

    id: str
    configuration: dict
    replication: int
    seed: int
    verified_by: str


def trials(experiment):
    """Return the Trials of an Experiment in the plan's order."""
    found, number = [], 0
    each = [(one, experiment.replications_of(one)) for one in configurations(experiment)]
    for replication in range(experiment.replications):
        for configuration, replications in each:
            number += 1
            if replication < replications:
                seed = experiment.seed + replication
                found.append(Trial(f'{number:04d}-{_key(configuration, replication, seed)}', configuration,
                                   replication, seed, ''))
    chosen = _chosen(found, experiment.verify)
    conditions = (FUNCTION_CONDITION,) if experiment.trial_function else CONDITIONS
    return [one._replace(verified_by=conditions[chosen[one.id] % len(conditions)]) if one.id in chosen else one
            for one in found]


def _key(configuration, replication, seed):
    text = json.dumps([configuration, replication, seed], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:_KEY_DIGITS]


def _chosen(found, share):
    """Return {id: place} of the share of trials that run twice: those whose digests come first."""
    count = math.ceil(share * len(found))
    ordered = sorted(found, key=lambda one: hashlib.sha256(('verify ' + one.id).encode()).hexdigest())
    return {one.id: place for place, one in enumerate(ordered[:count])}


def launch_arguments(experiment, trial):
    """Return the words ARG:=VALUE of a trial."""
    return ingredients.arguments_of(experiment, values_of(trial))


def function_arguments(experiment, trial):
    """Return what a trial's function gets as its args: a text that is one {NAME} alone is that value as it is."""
    values = values_of(trial)
    return {name: values[value[1:-1]] if isinstance(value, str) and value[:1] == '{' and value[1:-1] in values
            else checks.filled(value, values) if isinstance(value, str) else value
            for name, value in experiment.args.items()}


def values_of(trial):
    """Return what {NAME} stands for in a trial."""
    return {**trial.configuration, 'seed': trial.seed, 'replication': trial.replication}


def describe(experiment, chosen, text):
    """Return plan.json's content. ``text``: the experiment's file (bytes)."""
    paths = {path for one in chosen if one.replication == 0 for path in ingredients_of(experiment, one)}
    until = experiment.until
    return {
        'format': FORMAT, 'experiment': experiment.name, 'factors': experiment.factors,
        'metrics': {name: one.described() for name, one in experiment.metrics.items()},
        'primary': experiment.primary or None, 'baseline': experiment.baseline, 'at_limit': experiment.at_limit,
        'smallest_difference': experiment.smallest_difference,
        'until': {'seconds': until.seconds or None, 'topic': until.topic or None, 'idle': until.idle},
        'replications': experiment.replications, 'verify': experiment.verify, 'report': list(experiment.report),
        'provenance': {**versions(), 'digest': hashlib.sha256(text).hexdigest(), 'folder': experiment.folder,
                       'sources': ingredients.repositories([*paths, __file__])},
        'trials': [{'id': one.id, 'configuration': one.configuration, 'replication': one.replication,
                    'seed': one.seed, 'made_of': made_of(experiment, one)} for one in chosen]}


def versions():
    """Return the versions that a trial depends on, and the machine."""
    return {'package': package_version(), 'python': platform.python_version(), 'machine': platform.platform(),
            'processor': platform.machine(), 'cpus': os.cpu_count() or 1}


@functools.lru_cache(maxsize=None)
def package_version():
    """Return the version of this package as its package.xml says, in the source tree or installed; or 'unknown'."""
    for folder in list(Path(__file__).resolve().parents)[2:7]:
        for file in (folder / 'package.xml', folder / 'share' / 'move_base_abstract' / 'package.xml'):
            if file.is_file():
                found = re.search(r'<version>\s*([^<\s]+)\s*</version>', file.read_text(encoding='utf-8'))
                return found.group(1) if found else 'unknown'
    return 'unknown'


def ingredients_of(experiment, trial):
    """Return {file or name: digest} of what a trial is made of beside what the experiment's file says.

    Launch files are read as for the first replication: the others differ in their seeds alone. Files that arguments
    name are those of the trial itself.
    """
    made = ingredients.of_trial(experiment, *asked_of(experiment, trial))
    return {**made, **ingredients.of_arguments(launch_arguments(experiment, trial), experiment.folder)}


def asked_of(experiment, trial):
    """Return (arguments, launch file, functions) of the first replication, as ingredients.of_trial() asks for them."""
    first = values_of(trial._replace(replication=0, seed=experiment.seed))
    return (ingredients.arguments_of(experiment, first), checks.filled(experiment.launch, first),
            [name for name in (experiment.function, experiment.trial_function, experiment.prepare) if name])


def made_of(experiment, trial, made=None):
    """Return a digest of all that makes a trial the trial it is: a complete one stays if that is equal.

    made: its ingredients_of(), where they are known.
    """
    made = ingredients_of(experiment, trial) if made is None else made
    content = [FORMAT, experiment.launch, experiment.command, experiment.participants, experiment.leave_out,
               sorted(experiment.replace.items()), launch_arguments(experiment, trial), experiment.until,
               experiment.record, experiment.function, experiment.sleep, trial.configuration, trial.replication,
               trial.seed, trial.verified_by, package_version(), platform.python_version(),
               [experiment.trial_function, function_arguments(experiment, trial)] if experiment.trial_function else '',
               experiment.prepare, ingredients.by_content(made)]
    content += [{'lookahead': experiment.lookahead}] if experiment.lookahead else []
    content += [{'stored_topics': experiment.stored_topics}] if experiment.stored_topics else []
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode('utf-8', 'surrogateescape')).hexdigest()


def forget():
    """Look at files anew; in one process they are looked at once."""
    ingredients.forget()
