"""The trials of an experiment: which there are, in which order, with which seeds, and which run a second time.

Replication k has the same seed in every configuration: common random numbers, so that configurations can be compared
pair by pair. All configurations of replication 0 come first, so that more replications change no id of a trial.
"""
import hashlib
import json
import math
import os
import platform
import re
from pathlib import Path
from typing import NamedTuple

from . import checks
from .spec import configurations

FORMAT = 1
#: conditions under which a trial runs once more, in turn; they are those of `verify` that disturb no trial beside it
CONDITIONS = ('addresses', 'delays', 'hash')
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
    found = []
    for replication in range(experiment.replications):
        for configuration in configurations(experiment):
            seed = experiment.seed + replication
            found.append(Trial(f'{len(found) + 1:04d}-{_key(configuration, replication, seed)}', configuration,
                               replication, seed, ''))
    chosen = _chosen(found, experiment.verify)
    return [one._replace(verified_by=CONDITIONS[chosen[one.id] % len(CONDITIONS)]) if one.id in chosen else one
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
    values = values_of(trial)
    return [f'{name}:={checks.filled(value, values)}' for name, value in experiment.args.items()]


def values_of(trial):
    """Return what {NAME} stands for in a trial."""
    return {**trial.configuration, 'seed': trial.seed, 'replication': trial.replication}


def describe(experiment, chosen, text):
    """Return plan.json's content. ``text``: the experiment's file (bytes)."""
    until = experiment.until
    return {
        'format': FORMAT, 'experiment': experiment.name, 'factors': experiment.factors,
        'metrics': {name: {'unit': one.unit, 'title': one.title, 'better': one.better}
                    for name, one in experiment.metrics.items()},
        'until': {'seconds': until.seconds or None, 'topic': until.topic or None, 'idle': until.idle},
        'replications': experiment.replications, 'verify': experiment.verify, 'report': list(experiment.report),
        'provenance': {**versions(), 'digest': hashlib.sha256(text).hexdigest(), 'folder': experiment.folder},
        'trials': [{'id': one.id, 'configuration': one.configuration, 'replication': one.replication,
                    'seed': one.seed} for one in chosen]}


def versions():
    """Return the versions that a trial depends on, and the machine."""
    return {'package': package_version(), 'python': platform.python_version(), 'machine': platform.platform(),
            'processor': platform.machine(), 'cpus': os.cpu_count() or 1}


def package_version():
    """Return the version of this package as its package.xml says, in the source tree or installed; or 'unknown'."""
    for folder in list(Path(__file__).resolve().parents)[1:6]:
        for file in (folder / 'package.xml', folder / 'share' / 'move_base_abstract' / 'package.xml'):
            if file.is_file():
                found = re.search(r'<version>\s*([^<\s]+)\s*</version>', file.read_text(encoding='utf-8'))
                return found.group(1) if found else 'unknown'
    return 'unknown'


def made_of(experiment, trial):
    """Return a digest of all that makes a trial the trial it is: a complete one stays if that is equal.

    The launch file's own content counts where it is found here; files of others do not.
    """
    content = [FORMAT, experiment.launch, experiment.command, experiment.participants, experiment.leave_out,
               sorted(experiment.replace.items()), launch_arguments(experiment, trial), experiment.until,
               experiment.record, experiment.function, experiment.sleep, trial.configuration, trial.replication,
               trial.seed, trial.verified_by, package_version(), platform.python_version(), _file_of(experiment)]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _file_of(experiment):
    try:
        with open(Path(experiment.folder) / experiment.launch, 'rb') as stream:
            return hashlib.sha256(stream.read()).hexdigest()
    except OSError:
        return ''
