"""How far an experiment is, read from its folder alone."""
from . import outputs, trial

_MOST_SHOWN = 10


def lines(path):
    """Yield what `experiment status` says. :raises ConfigurationError: if the folder is none of an experiment."""
    plan = outputs.read_plan(path)
    found = [(one['id'], outputs.read_trial(path, one['id'])) for one in plan['trials']]
    complete = [about for _, about in found if about is not None and about['status'] == trial.COMPLETE]
    failed = [about for _, about in found if about is not None and about['status'] != trial.COMPLETE]
    yield f"{plan['experiment']}: {len(complete)} of {len(found)} trials complete, {len(failed)} failed, " \
          f'{len(found) - len(complete) - len(failed)} missing'
    twice = [about['verified'] for about in complete if about['verified'] is not None]
    if twice:
        yield f'run twice: {twice.count(trial.IDENTICAL)} identical, {twice.count(trial.DIFFERENT)} different'
    labelled = sum(bool(about['labels']) for about in complete)
    if labelled:
        yield f'not called repeatable: {labelled}'
    for about in failed[:_MOST_SHOWN]:
        yield f"failed: {about['id']} {about['configuration']} replication {about['replication']}: {about['error']}"
    if len(failed) > _MOST_SHOWN:
        yield f'... and {len(failed) - _MOST_SHOWN} more'
