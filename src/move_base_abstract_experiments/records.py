"""plan.json and trial.json, read as if anybody had written them: plain files of a bounded size, with what is wanted."""
import math
import os
import re

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract.common.shown import shown

FORMAT = 1
MAX_PLAN_BYTES = 512 * 1024 * 1024  # there may be 1,000,000 trials in it
_ID = re.compile(r'[A-Za-z0-9_][A-Za-z0-9._-]{0,199}\Z')
_NUMBER = (int, float, type(None))
_TEXT = (str, type(None))
#: of each key the kinds that are allowed, and what stands for one that is not there
_PLAN = {'experiment': ((str,), ''), 'factors': ((dict,), {}), 'metrics': ((dict,), {}), 'provenance': ((dict,), {}),
         'trials': ((list,), []), 'kept': ((dict,), {})}
_PLANNED = {'made_of': (_TEXT, None), 'kept': (_TEXT, None), 'program': (_TEXT, None),
            'configuration': ((dict,), {}), 'replication': ((int,), 0), 'seed': ((int,), 0)}
_TRIAL = {'configuration': ((dict,), {}), 'replication': ((int,), 0), 'seed': ((int,), 0), 'status': ((str,), ''),
          'error': (_TEXT, None), 'metrics': ((dict,), {}),
          **dict.fromkeys(('simulated_seconds', 'wall_seconds', 'times_real_time'), (_NUMBER, None)),
          'repeatable': ((bool,), False), 'labels': ((list,), []), 'events': ((int,), 0), 'log_sha256': (_TEXT, None),
          'verified': (_TEXT, None), 'difference': (_TEXT, None), 'robots': ((dict,), {}), 'made_of': (_TEXT, None),
          'ended_by': (_TEXT, None), 'program': (_TEXT, None), 'worker': (_TEXT, ''), 'attempts': ((int,), 1)}


def read_plan(folder):
    """Return plan.json of an experiment's folder. :raises ConfigurationError: if it is none."""
    path = os.path.join(folder, 'plan.json')
    try:
        plan = load_json_mapping(path, MAX_PLAN_BYTES)
    except FileNotFoundError:
        raise ConfigurationError(f'{path}: is not there; `experiment run FILE -o OUT` makes it') from None
    _check(plan, _PLAN, path)
    for place, one in enumerate(plan['trials']):
        where = f'{path}: trials[{place}]'
        if not isinstance(one, dict) or not isinstance(one.get('id'), str) or not _ID.match(one['id']):
            raise ConfigurationError(f"{where}: must be a mapping with an 'id' of letters, digits, '.', '_' and '-', "
                                     f'got {shown(one)}')
        _check_kinds(one, _PLANNED, where)
    for name, levels in plan['factors'].items():
        _check_kinds({f'factors.{name}': levels}, {f'factors.{name}': ((list,), [])}, path)
    return plan


def read_planned(folder, planned):
    """Return trial.json of an entry of a plan's trials, or None if it is not there, or is made of something else.

    One that is kept though it is of another program says so among its labels. :raises: as read_trial().
    """
    about = read_trial(folder, planned['id'])
    if about is None or None not in (planned.get('made_of'), about['made_of']) and (
            planned['made_of'] != about['made_of']):
        return None
    return {**about, 'labels': [*about['labels'], planned['kept']]} if planned.get('kept') else about


def read_trial(folder, name):
    """Return trial.json of a trial of an experiment's folder, or None if it is not there.

    :raises ConfigurationError: if it cannot be understood; the text begins with its path.
    """
    path = os.path.join(folder, 'trials', name, 'trial.json')
    try:
        about = load_json_mapping(path)
    except FileNotFoundError:
        return None
    return checked_trial(about, name, path)


def checked_trial(about, name, where):
    """Return trial.json's content, whole. :raises ConfigurationError: if it is none of the trial ``name``."""
    _check(about, _TRIAL, where)
    if about.setdefault('id', name) != name:
        raise ConfigurationError(f"{where}: 'id' must be {name!r}, got {shown(about['id'])}")
    for label in about['labels']:
        _check_kinds({'labels': label}, {'labels': ((str,), '')}, where)
    for metric, value in about['metrics'].items():
        _check_kinds({f'metrics.{metric}': value}, {f'metrics.{metric}': (_NUMBER, None)}, where)
    return about


def _check(content, kinds, path):
    if content.get('format') != FORMAT or isinstance(content['format'], bool):
        raise ConfigurationError(f"{path}: 'format' must be {FORMAT}, got {shown(content.get('format'))}; another "
                                 'version of this program wrote it')
    _check_kinds(content, kinds, path)
    for key, (_, otherwise) in kinds.items():
        content.setdefault(key, type(otherwise)(otherwise) if isinstance(otherwise, (list, dict)) else otherwise)


def _check_kinds(content, kinds, where):
    for key, (allowed, _) in kinds.items():
        value = content.get(key)
        if key in content and (not isinstance(value, allowed) or isinstance(value, bool) and bool not in allowed
                               or isinstance(value, float) and not math.isfinite(value)):
            names = ' or '.join({dict: 'a mapping', list: 'a list', str: 'a text', int: 'a whole number', bool:
                                 'true or false', float: 'a number', type(None): 'null'}[kind] for kind in allowed)
            raise ConfigurationError(f'{where}: {key!r} must be {names}, got {shown(value)}')
