"""The report of a study: report.html, which holds all that it shows, and report.md beside it."""

import base64
import html
import tempfile
from pathlib import Path

from move_base_abstract.own_files import PART, check_file, whole_file
from soil_mapping.pictures import write_pictures
from soil_mapping.trial_folder import read_trial

from . import tables
from .charts import box_plots, error_against_speed
from .collection import LOCKSTEP, collect_trials
from .provenance_tables import provenance

TITLE = 'The soil compaction mapping study'
MAPS = ('truth', 'prediction', 'variance', 'trajectories')
STYLE = ('body{font:15px/1.45 sans-serif;max-width:1250px;margin:2em auto;padding:0 1em;color:#222}'
         'table{border-collapse:collapse;margin:.6em 0}td,th{border:1px solid #bbb;padding:.25em .6em;text-align:right}'
         'td:first-child,th:first-child{text-align:left}th{background:#eee}img{max-width:100%}p{max-width:60em}')


def write(folder):
    """Write the report on a study's folder (a Path); return the paths of report.html and report.md.

    :raises ConfigurationError: if there is a file by one of the names that is no such report.
    """
    groups = collect_trials(folder)
    sections = _sections(groups)
    pages = {'report.html': _to_html(sections), 'report.md': _to_markdown(sections)}
    for name, text in pages.items():
        for path in (folder / name, folder / (name + PART)):
            check_file(path, lambda line: TITLE.encode() in line)
        with whole_file(folder / name, encoding='utf-8') as stream:
            stream.write(text)
    return [folder / name for name in pages]


def _sections(groups):
    """Return (heading, parts) pairs; a part is a Table or (caption, PNG bytes)."""
    shown = groups.get(LOCKSTEP) or next(iter(groups.values()))
    return [
        ('Overview', [tables.overview(groups)]),
        ('Is it the same?', [tables.identities(groups), tables.cosines(groups), tables.cosines_per_metric(groups)]),
        ('How much does it differ?', tables.scale_errors(groups)),
        ('Error against speed-up', [tables.legs(groups), ('Left: error of the legs. Right: dissimilarity of the '
                                                          'study. Grey: published.', error_against_speed(groups))]),
        ('Metrics', [('All metrics, by configuration.', box_plots(groups)), *tables.metric_tables(groups)]),
        ('Provenance and parameters', provenance(groups)),
        (f'Maps of one trial: {shown[0].group}, {shown[0].configuration}, seed {shown[0].seed}', _maps(shown[0])),
    ]


def _maps(trial):
    """Return the pictures of a trial."""
    with tempfile.TemporaryDirectory() as folder:
        write_pictures(Path(folder), read_trial(trial.path))
        return [(name, (Path(folder) / f'{name}.png').read_bytes()) for name in MAPS]


def _to_html(sections):
    lines = [f'<!doctype html><!-- {TITLE} -->', '<html lang="en"><head><meta charset="utf-8">',
             f'<title>{TITLE}</title>', f'<style>{STYLE}</style></head><body>', f'<h1>{TITLE}</h1>']
    for heading, parts in sections:
        lines.append(f'<h2>{html.escape(heading)}</h2>')
        for part in parts:
            lines += _html_table(part) if isinstance(part, tables.Table) else _html_picture(*part)
    return '\n'.join([*lines, '</body></html>', ''])


def _html_table(table):
    def row(cells, tag):
        return '<tr>' + ''.join(f'<{tag}>{html.escape(cell)}</{tag}>' for cell in cells) + '</tr>'
    note = [f'<p>{html.escape(table.note)}</p>'] if table.note else []
    return [f'<h3>{html.escape(table.title)}</h3>', '<table>', row(table.header, 'th'),
            *(row(cells, 'td') for cells in table.rows), '</table>', *note]


def _html_picture(caption, png):
    data = base64.b64encode(png).decode('ascii')
    return [f'<figure><img alt="{html.escape(caption)}" src="data:image/png;base64,{data}">'
            f'<figcaption>{html.escape(caption)}</figcaption></figure>']


def _to_markdown(sections):
    """Return the same without its pictures."""
    lines = [f'# {TITLE}', '', 'The charts and maps are in report.html.', '']
    for heading, parts in sections:
        found = [part for part in parts if isinstance(part, tables.Table)]
        if found:
            lines += [f'## {heading}', '']
        for table in found:
            lines += [f'### {table.title}', '', _markdown_row(table.header), _markdown_row(['---'] * len(table.header))]
            lines += [*(_markdown_row(cells) for cells in table.rows), '', *([table.note, ''] if table.note else [])]
    return '\n'.join(lines)


def _markdown_row(cells):
    return '| ' + ' | '.join(cell.replace('|', r'\|') for cell in cells) + ' |'
