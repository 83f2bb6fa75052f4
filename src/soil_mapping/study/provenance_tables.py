"""Tables on the origin of the report's figures: field, parameters of the mission, programs and machines."""
from __future__ import annotations

from typing import Any, Dict

from move_base_abstract_experiments.report.parts import Table

from .outcomes import CONFIGURATION_NAMES
from .tables import group_title

CHOSEN = ('allocation', 'sampling')  # they differ between configurations, and the tables name them
HIDDEN = ('field', *CHOSEN)


def provenance(groups: Any) -> Any:
    """Return the tables on the origin of the trials of all groups."""
    return [_parameters(groups), _groups(groups), _programs(groups)]


def _parameters(groups: Any) -> Any:
    """Return the table of field and mission. If trials differ in a value, each value has the groups that have it."""
    rows = []
    fields = _by_value(groups, _field)
    rows += [('field', value, where) for value, where in fields]
    names = sorted({name for trials in groups.values() for trial in trials for name in trial.about['config']})
    for name in names:
        if name not in HIDDEN:
            rows += [(name, value or "''", where) for value, where
                     in _by_value(groups, lambda about, name=name: str(about['config'].get(name, 'not recorded')))]
    return Table('Parameters', ('parameter', 'value', 'of'), tuple(rows),
                 'As recorded by the trials (files-trial.json). Names as in TrialConfig; '
                 'docs/soil_study.md has their units.')


def _field(about: Any) -> str:
    field = about.get('field') or {}
    size = f', {field["width_m"]:g} x {field["height_m"]:g} m' if 'width_m' in field else ''
    extent = f'; {field["extent"]}' if field.get('extent') else ''
    return f'{about["config"]["field"]}{size}{extent}'


def _groups(groups: Any) -> Any:
    rows = []
    for name, trials in groups.items():
        engines = sorted({_listed(trial.about['engine']) for trial in trials})
        configurations: Dict[Any, Any] = {}
        for trial in trials:
            configurations.setdefault(trial.configuration, []).append(trial.seed)
        seeds = '; '.join(f'{CONFIGURATION_NAMES.get(key, key)}: {_ranges(own)}' for key, own in configurations.items())
        rows.append((group_title(name), ' / '.join(engines), seeds))
    return Table('Trials', ('trials of', 'engine', 'seeds'), tuple(rows))


def _programs(groups: Any) -> Any:
    rows = []
    for name in ('versions', 'machine'):
        rows += [(name, value, where) for value, where
                 in _by_value(groups, lambda about, name=name: _listed(about.get(name, {})))]
    return Table('Programs and machines', ('what', 'value', 'of'), tuple(rows))


def _listed(mapping: Any) -> str:
    return ', '.join(f'{key} {value}' for key, value in mapping.items())


def _by_value(groups: Any, value_of: Any) -> Any:
    """Return (value, groups that have it) pairs; 'all' if there is one value only. The most common value is last."""
    found: Dict[Any, Any] = {}
    for name, trials in groups.items():
        for trial in trials:
            found.setdefault(value_of(trial.about), {})[group_title(name)] = None
    most = max(found.values(), key=len)
    rows = []
    for value, names in sorted(found.items(), key=lambda item: item[1] is most):
        others = names is most and len(names) > 2
        rows.append((value, 'all' if len(found) == 1 else 'all others' if others else '; '.join(names)))
    return rows


def _ranges(seeds: Any) -> str:
    """Return whole numbers as '0 to 9' or '0, 2, 5'."""
    seeds = sorted(seeds)
    if len(seeds) > 2 and seeds[-1] - seeds[0] == len(seeds) - 1:
        return f'{seeds[0]} to {seeds[-1]}'
    return ', '.join(map(str, seeds))
