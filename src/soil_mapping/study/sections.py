"""The study's sections in the report on its experiment: comparisons with published figures, legs, speed, maps."""
from __future__ import annotations

import base64
import html
from pathlib import Path
from typing import Any, Iterator

from move_base_abstract.common import temporary
from move_base_abstract_experiments.report.parts import Html, Section, figure_of
from soil_mapping.results.pictures import write_pictures
from soil_mapping.results.trial_folder import read_trial

from . import tables
from .charts import error_against_speed
from .groups import LOCKSTEP
from .outcomes import CONFIGURATION_NAMES, FILES, collect_trials
from .provenance_tables import provenance

MAPS = ('truth', 'prediction', 'variance', 'trajectories')


def sections(given: Any) -> Any:
    """Return the Sections of the study; given: the report's extension.Tables. Without complete trials: none."""
    groups = collect_trials(given.experiment)
    if not groups:
        return []
    shown = (groups.get(LOCKSTEP) or next(iter(groups.values())))[0]
    return [
        Section('Is it the same?', (tables.identities(groups), tables.cosines(groups),
                                    tables.cosines_per_metric(groups))),
        Section('How much does it differ?', tuple(tables.scale_errors(groups)) or ('One group has run.',)),
        Section('Error against speed-up', (tables.legs(groups), figure_of(
            error_against_speed(groups), 'Left: error of the legs. Right: dissimilarity of the study. Grey: '
            'published.'), tables.overview(groups))),
        Section('Fields, parameters and programs', tuple(provenance(groups))),
        Section(f'Maps of one trial: {tables.group_title(shown.group)}, '
                f'{CONFIGURATION_NAMES.get(shown.configuration, shown.configuration)}, seed {shown.seed}',
                tuple(_maps(shown)))]


def _maps(trial: Any) -> Iterator[Any]:
    """Yield the pictures of a trial, as parts of the page that need no other file."""
    with temporary.folder('study_maps_') as folder:
        write_pictures(Path(folder), read_trial(trial.path, FILES))
        for name in MAPS:
            data = base64.b64encode((Path(folder) / f'{name}.png').read_bytes()).decode('ascii')
            yield Html(f'<figure><img alt="{html.escape(name)}" style="max-width: 100%" '
                       f'src="data:image/png;base64,{data}"><figcaption>{html.escape(name)}</figcaption></figure>')
