"""The report of a study: report.html, which holds all that it shows, and report.md beside it."""

import tempfile
from pathlib import Path

from move_base_abstract.own_files import PART, check_file, whole_file
from soil_mapping.pictures import write_pictures
from soil_mapping.trial_folder import read_trial

from . import tables
from .charts import box_plots, error_against_speed
from .collection import LOCKSTEP, collect_trials
from .pages import Picture, Section, render
from .provenance_tables import provenance

TITLE = 'The soil compaction mapping study'
MAPS = ('truth', 'prediction', 'variance', 'trajectories')


def write(folder):
    """Write the report on a study's folder (a Path); return the paths of report.html and report.md.

    :raises ConfigurationError: if there is a file by one of the names that is no such report.
    """
    groups = collect_trials(folder)
    sections = _sections(groups)
    pages = {name: render(name, TITLE, sections) for name in ('report.html', 'report.md')}
    for name, text in pages.items():
        for path in (folder / name, folder / (name + PART)):
            check_file(path, lambda line: TITLE.encode() in line)
        with whole_file(folder / name, encoding='utf-8') as stream:
            stream.write(text)
    return [folder / name for name in pages]


def _sections(groups):
    """Return the Sections of the report on these groups of trials."""
    shown = groups.get(LOCKSTEP) or next(iter(groups.values()))
    return [
        Section('Overview', (tables.overview(groups),)),
        Section('Is it the same?', (tables.identities(groups), tables.cosines(groups),
                                    tables.cosines_per_metric(groups))),
        Section('How much does it differ?', tuple(tables.scale_errors(groups))),
        Section('Error against speed-up', (tables.legs(groups), Picture(
            'Left: error of the legs. Right: dissimilarity of the study. Grey: published.',
            error_against_speed(groups)))),
        Section('Metrics', (Picture('All metrics, by configuration.', box_plots(groups)),
                            *tables.metric_tables(groups))),
        Section('Provenance and parameters', tuple(provenance(groups))),
        Section(f'Maps of one trial: {shown[0].group}, {shown[0].configuration}, seed {shown[0].seed}',
                _maps(shown[0]), is_gallery=True),
    ]


def _maps(trial):
    """Return the Pictures of a trial."""
    with tempfile.TemporaryDirectory() as folder:
        write_pictures(Path(folder), read_trial(trial.path))
        return tuple(Picture(name, (Path(folder) / f'{name}.png').read_bytes()) for name in MAPS)
