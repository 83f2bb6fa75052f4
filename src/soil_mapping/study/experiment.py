"""The study as an experiment: makes the file that `study.py run` writes."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Union

from soil_mapping.config import PUBLISHED_CONFIGURATIONS
from soil_mapping.ground_truth.readings import MEUSE_FILE

from .groups import FACTORS

if TYPE_CHECKING:
    from ..config import TrialConfig

CHOSEN = ('allocation', 'sampling', 'coarse_cells')  # these are factors, or follow from them
GUARD_S = 300.0  # wall, in addition to the time that the clock needs; ends a trial that would never end
COLUMNS = {
    'rmse_kpa': {'title': 'Error of the map (RMSE)', 'unit': 'kPa', 'better': 'lower'},
    'mean_variance_kpa2': {'title': 'Mean kriging variance', 'unit': 'kPa²', 'better': 'lower'},
    'samples': {'title': 'Samples', 'better': 'higher'},
    'distance_m': {'title': 'Distance driven by all robots', 'unit': 'm'},
    'idle_s': {'title': 'Time without a task, all robots', 'unit': 's', 'better': 'lower'},
    'waiting_s': {'title': 'Time held up, all robots', 'unit': 's', 'better': 'lower'},
    'task_s': {'title': 'Mean time of a task', 'unit': 's', 'better': 'lower'},
}


def document(config: TrialConfig, groups: Sequence[str], seeds: int, scaled_seeds: int, verify: float = 0.0,
             pictures: bool = False) -> Dict[str, Union[List[str], Dict[str, Any], str]]:
    """Return the experiment's file as a mapping.

    config: a TrialConfig, whose allocation and sampling are not used: they are factors. groups: names of groups.py.
    seeds: number of seeds, from 0 on. scaled_seeds: the same for the scaled clock, which is slower. verify: share of
    the trials that run twice. pictures: whether trials draw pictures.
    """
    values: Any = config.to_dict()
    kind, _, path = values['field'].partition(':')
    if kind == 'csv':
        values['field'] = f'csv:{os.path.abspath(path)}'
    files = [os.path.abspath(path)] if kind == 'csv' else [str(MEUSE_FILE)] if kind == 'meuse' else []
    slowest = max([config.budget_s / FACTORS[group] for group in groups if group in FACTORS], default=0.0)
    counts = {group: scaled_seeds if group in FACTORS else seeds for group in groups}
    most = max(counts.values())
    fewer = {group: count for group, count in counts.items() if count < most}
    factors: Dict[str, Any] = {'engine': list(groups)}
    for place, name in enumerate(('allocation', 'sampling')):
        factors[name] = list(dict.fromkeys(each[place] for each in PUBLISHED_CONFIGURATIONS))
    return {
        'experiment': 'soil compaction mapping', 'function': 'soil_mapping.study.trials:run',
        'prepare': 'soil_mapping.study.trials:prepare', 'inputs': files,
        'args': {**{name: value for name, value in values.items() if name not in CHOSEN}, 'pictures': pictures},
        'factors': factors, 'replications': {'all': most, **({'engine': fewer} if fewer else {})},
        'record': {'files': ['*']}, 'metrics': {'columns': COLUMNS},
        'report': 'soil_mapping.study.sections:sections', 'verify': verify, 'time_limit': GUARD_S + 2.0 * slowest}  # type: ignore[dict-item]
