"""Jobs of experiments, for tests: of a trial of a function, made without looking at any file."""
import dataclasses

from move_base_abstract_experiments.description import spec
from move_base_abstract_experiments.description.ingredients import Files
from move_base_abstract_experiments.description.job import Common, Job
from move_base_abstract_experiments.description.trial import Trial

FUNCTION = {'experiment': 'x', 'function': 'model:run'}


def job_of(document=FUNCTION, folder='/folder', sources=None, modules='', **trial):
    """Return a Job; the first trial's ``trial`` fields may be others."""
    one = Trial(spec.checked(document, folder), '0001-abcdef', {}, 0, 0)
    return Job(dataclasses.replace(one, **trial), Common(sources or {}, '', ()), 'm', 'p', Files('', ()), (),
               modules=modules)
