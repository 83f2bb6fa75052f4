"""The design of an experiment: its factors, their levels, the configurations that they make, and what is measured."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.common.shown import shown_text

if TYPE_CHECKING:
    from .outcome import Trial

NO_LEVEL = 'none'
YES_NO = 'yes/no'  # the unit of a metric that is 1 or 0 in each trial

#: per factor the place of its level; None if the configuration has none
Levels = Tuple[Optional[int], ...]


class Factor(NamedTuple):
    """A factor: something that the experiment varies, with its levels."""

    name: str
    title: str
    levels: Tuple[str, ...]  # in the order of the plan
    keys: Tuple[str, ...]  # the values of the levels as JSON
    is_numeric: bool


class Configuration(NamedTuple):
    """One combination of levels."""

    place: int
    levels: Levels
    label: str


@dataclass(frozen=True)
class Metric:
    """A number that each trial gives."""

    name: str
    title: str
    unit: str
    better: Optional[str]  # 'lower', 'higher' or None
    is_share: bool = False  # yes or no in each trial, so that means are shares
    smallest: float = 0.0  # the smallest difference that counts, in the metric's unit; 0: the plan names none
    at_limit: Optional[str] = None  # in a trial that the limit of time ended, see endings; None: not declared
    is_primary: bool = False  # whether the experiment's file names it as the primary metric
    outcome: str = ''  # 'failed' or 'limit' if this is not a measured metric, but a way in which trials ended


#: the ways in which trials end, as if they were measured
FAILED_TRIALS = Metric('failed', 'Failed trials', YES_NO, 'lower', is_share=True, outcome='failed')
LIMITED_TRIALS = Metric('limit', 'Trials ended by the limit of time', YES_NO, None, is_share=True, outcome='limit')


def factors_of(plan: Mapping[str, Any]) -> Tuple[Factor, ...]:
    """Return the Factors of a plan (a mapping): those that it names, then others that its trials have."""
    named = {str(name): {key_of(value): value for value in values} for name, values in plan.get('factors', {}).items()}
    for trial in plan['trials']:
        for name, value in trial.get('configuration', {}).items():
            named.setdefault(name, {}).setdefault(key_of(value), value)
    return tuple(_factor(name, list(levels.values())) for name, levels in named.items())


def _factor(name: str, values: Sequence[Any]) -> Factor:
    values = list({key_of(value): value for value in values}.values())
    is_numeric = bool(values) and all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in values)
    return Factor(name, words(name), tuple(map(level_text, values)), tuple(map(key_of, values)), is_numeric)


def key_of(value: Any) -> str:
    """Return a text that is equal for two values only if the values are equal."""
    return json.dumps(value, sort_keys=True)


def level_text(value: Any) -> str:
    """Return a level as the report shows it."""
    if isinstance(value, str):
        return value if value.strip() else "''"
    if value is None:
        return NO_LEVEL
    if isinstance(value, float) and math.isfinite(value):
        return f'{value:.6g}'
    return json.dumps(value, ensure_ascii=False, sort_keys=True)


def words(name: str) -> str:
    """Return the name of a factor or metric as words: 'robot_count' as 'robot count'."""
    return ' '.join(str(name).replace('_', ' ').split()) or '(no name)'


def level_label(factors: Sequence[Factor], place: int, level: int) -> str:
    """Return a level so that no level of another factor reads the same: 'auction', 'robots 4'."""
    factor = factors[place]
    text = factor.levels[level]
    elsewhere = any(text in other.levels for number, other in enumerate(factors) if number != place)
    is_word = json.loads(factor.keys[level]).__class__ is str and any(sign.isalpha() for sign in text)
    return text if is_word and not elsewhere else f'{factor.title} {text}'


def configurations_of(factors: Sequence[Factor],
                      planned: Sequence[Dict[str, Any]]) -> Tuple[Tuple[Configuration, ...], List[int]]:
    """Return the Configurations of the plan's trials, in the order of the levels, and the place of each trial's own."""
    combinations = [tuple(_place(factor, trial.get('configuration', {})) for factor in factors) for trial in planned]
    in_order = sorted(dict.fromkeys(combinations), key=lambda levels: [-1 if each is None else each for each in levels])
    configurations = tuple(Configuration(place, levels, _label(factors, levels))
                           for place, levels in enumerate(in_order))
    places = {configuration.levels: configuration.place for configuration in configurations}
    return configurations, [places[levels] for levels in combinations]


def _place(factor: Factor, configuration: Mapping[str, Any]) -> Optional[int]:
    return factor.keys.index(key_of(configuration[factor.name])) if factor.name in configuration else None


def _label(factors: Sequence[Factor], levels: Levels) -> str:
    return ', '.join(level_label(factors, place, level) for place, level in enumerate(levels)
                     if level is not None) or 'the only configuration'


def metrics_of(plan: Mapping[str, Any], trials: Sequence[Trial]) -> Tuple[Metric, ...]:
    """Return the Metrics: the primary one, the others of the plan in its order, then those that only Trials have."""
    told = {str(name): about if isinstance(about, dict) else {} for name, about in plan.get('metrics', {}).items()}
    for trial in trials:
        for name in trial.metrics:
            told.setdefault(name, {})
    smallest, at_limit = (plan.get(key) or {} for key in ('smallest_difference', 'at_limit'))
    found = []
    for name, about in told.items():
        title = str(about.get('title') or words(name).capitalize())
        unit = str(about.get('unit') or '')
        better = about.get('better') if about.get('better') in ('lower', 'higher') else None
        values = {trial.metrics[name] for trial in trials if not math.isnan(trial.metrics.get(name, math.nan))}
        found.append(Metric(name, title, unit, better, unit == YES_NO and values <= {0.0, 1.0},
                            smallest.get(name, 0.0), at_limit.get(name, about.get('at_limit')),
                            name == plan.get('primary')))
    return tuple(sorted(found, key=lambda metric: not metric.is_primary))


def unknown_names(plan: Mapping[str, Any], factors: Sequence[Factor], metrics: Sequence[Metric]) -> List[str]:
    """Return a line for each metric or baseline level that a plan names and no trial has."""
    names = [metric.name for metric in metrics]
    asked = [('primary', plan['primary'])] if plan.get('primary') else []
    asked += [(key, name) for key in ('smallest_difference', 'at_limit') for name in plan.get(key) or {}]
    lines = [f'{key}: no trial has a metric {shown_text(name)!r}.' for key, name in asked if name not in names]
    by_name = {factor.name: factor for factor in factors}
    for name, level in (plan.get('baseline') or {}).items():
        if name not in by_name or key_of(level) not in by_name[name].keys:
            lines.append(f'baseline: no trial has {shown_text(name)} {shown_text(level_text(level))}.')
    return lines


def baseline_of(plan: Mapping[str, Any], factor: Factor) -> Optional[int]:
    """Return the place of the level of a Factor that the plan names as the baseline, or None."""
    key = key_of((plan.get('baseline') or {}).get(factor.name))
    return factor.keys.index(key) if factor.name in (plan.get('baseline') or {}) and key in factor.keys else None
