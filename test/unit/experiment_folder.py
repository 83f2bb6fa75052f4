"""Folders of experiments as a runner leaves them, for tests of the report: a function says what is measured."""

import itertools
import json

from move_base_abstract_experiments.report import findings, page

METRICS = {
    'makespan_s': {'unit': 's', 'title': 'Makespan', 'better': 'lower'},
    'goals': {'unit': 'goals', 'title': 'Goals reached', 'better': 'higher'},
}


def write(folder, factors, replications, measure, metrics=None, **plan):
    """Write an experiment's folder; measure(configuration, replication) gives a trial.json, or only its metrics.

    :param replications: how many, or a function of the configuration that says it.
    :param measure: None of it: the trial has not run. A mapping with 'status' is taken as the rest of trial.json.
    """
    trials = []
    for levels in itertools.product(*factors.values()):
        configuration = dict(zip(factors, levels))
        for replication in range(replications(configuration) if callable(replications) else replications):
            told = {'id': f'{len(trials) + 1:04d}-abc', 'configuration': configuration, 'replication': replication,
                    'seed': 1000 + replication}
            trials.append(told)
            _write_trial(folder, told, measure(configuration, replication))
    content = {'format': 1, 'experiment': 'allocation', 'factors': factors,
               'metrics': METRICS if metrics is None else metrics, 'until': {'seconds': 3600}, 'verify': 0.05,
               'provenance': {'versions': {'move_base_abstract': '0.1.0', 'python': '3.11.2'}, 'cpus': 2},
               'trials': trials, **plan}
    (folder / 'plan.json').write_text(json.dumps(content), encoding='utf-8')
    return folder


def _write_trial(folder, told, measured):
    if measured is None:
        return
    if 'status' not in measured:
        measured = {'status': 'complete', 'metrics': measured}
    about = {'format': 1, **told, 'error': None, 'simulated_seconds': 3600.0, 'wall_seconds': 2.5,
             'times_real_time': 1440.0, 'repeatable': True, 'labels': [], 'events': 10, 'log_sha256': '0' * 64,
             'verified': None, 'difference': None, 'robots': {}, 'worker': 'w', 'attempts': 1, **measured}
    place = folder / 'trials' / told['id']
    place.mkdir(parents=True)
    (place / 'trial.json').write_text(json.dumps(about), encoding='utf-8')
    (place / 'events.jsonl').write_text('{}\n', encoding='utf-8')


def findings_of(experiment):
    """Return the Findings about the metrics of an experiment."""
    analysis = page.analyse(experiment)
    return findings.findings(experiment, analysis.scales, analysis.mains, analysis.singles, analysis.changes)


def plain(text):
    """Return a text of the page with usual spaces."""
    return text.replace('\N{NO-BREAK SPACE}', ' ')
