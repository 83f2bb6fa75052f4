"""Write the report of an experiment's folder: report.html, tables/*.csv, and replays of the trials worth a look.

Exit codes: 0 the report is written; 1 it cannot be written; 2 wrong arguments, or the folder is not of an experiment.
"""
from __future__ import annotations

import argparse
import importlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.own_files import PART, FolderKind, check_file, whole_file

from . import extension, frames, notable_trials, outcome, page

if TYPE_CHECKING:
    import pandas as pd

    from .outcome import Experiment
    from .page import Analysis

REPLAY = 'move_base_abstract_replay.page'
NAMES = ('trials', 'means', 'main_effects', 'differences', 'interactions', 'robots', 'endings')
WAITS = 'waits'  # written only if robots waited for room
KIND = FolderKind("folder of an experiment's tables", tuple(f'{name}.csv' for name in (*NAMES, WAITS)))


def write(out: Union[str, Path], with_own: bool = True) -> Tuple[Path, List[str]]:
    """Write the report, tables and replays of an experiment into its folder.

    Return the path of report.html, and lines about parts that could not be made.

    :param with_own: whether to add the sections that the plan names under 'report'.
    :raises ConfigurationError: if the folder holds no plan, or a file or folder by one of these names that a report
        has not made.
    :raises OutputError: if something cannot be written.
    """
    out = Path(out)
    experiment = outcome.read(out)
    target = out / 'report.html'
    for path in (target, out / ('report.html' + PART)):
        check_file(path, lambda line: page.MARK.encode() in line)
    names = extension.names_of(experiment.plan) if with_own else []
    analysis = page.analyse(experiment)
    tables = _tables(analysis)
    _write_tables(out / 'tables', tables)
    problems = _replays(experiment)
    given = extension.Tables(experiment, **{name: tables[name] for name in NAMES if name not in ('robots', 'endings')})
    added = [section for name in names for section in extension.sections(name, given)]
    text = page.render(analysis, added, problems)
    with whole_file(target, encoding='utf-8') as stream:
        stream.write(text)
    return target, problems


def _tables(analysis: Analysis) -> Dict[str, pd.DataFrame]:
    experiment = analysis.experiment
    return {'trials': frames.trials(experiment), 'means': frames.means(experiment),
            **{name: frames.differences(experiment, found) for name, found in (
                ('main_effects', analysis.mains), ('differences', analysis.singles),
                ('interactions', analysis.changes),
                ('endings', [*analysis.endings[0], *analysis.endings[1]]))}, 'robots': frames.robots(experiment),
            WAITS: frames.waits(experiment)}


def _write_tables(folder: Path, tables: Mapping[str, pd.DataFrame]) -> None:
    marker = KIND.make(folder)
    try:
        for name in (*NAMES, WAITS):
            if name != 'trials' and not (name == WAITS and tables[name].empty):  # trials.csv of the runner has it
                with whole_file(folder / f'{name}.csv', encoding='utf-8', newline='') as stream:
                    stream.write(frames.csv_text(tables[name]))
    finally:
        os.close(marker)


def _replays(experiment: Experiment) -> List[str]:
    """Write the replays of the trials worth a look, if the replay package is installed; return what went wrong."""
    metric = notable_trials.primary_metric(experiment)
    if metric is None:
        return []
    try:
        write_page = importlib.import_module(REPLAY).write_page
    except ImportError:
        return []
    return notable_trials.write_replays(experiment, notable_trials.picks(experiment, metric), write_page)


def main(words: Optional[Sequence[str]] = None) -> int:
    """Run the command with these arguments (default: those of the shell); return the exit code."""
    parser = argparse.ArgumentParser(prog='experiment report', description='Write report.html and tables/*.csv of an '
                                     'experiment into its folder. The experiment may still be running.')
    parser.add_argument('out', type=Path, metavar='OUT', help='the folder of the experiment')
    parser.add_argument('--without-own-sections', action='store_true', help="do not run the functions that the "
                        "experiment names under 'report'; for folders that somebody else made")
    arguments = parser.parse_args(words)
    try:
        path, problems = write(arguments.out, not arguments.without_own_sections)
    except ConfigurationError as error:
        print(f'experiment report: {error}', file=sys.stderr)
        return 2
    except (SimulatorError, OSError) as error:
        print(f'experiment report: {error}', file=sys.stderr)
        return 1
    for problem in problems:
        print(f'experiment report: {problem}', file=sys.stderr)
    print(path)
    return 0
