"""Sections that a study adds to the report: functions that its plan names under 'report', as 'module:function'.

Such a function is called with the Tables and returns a parts.Section or a list of them. It runs as part of the report,
just as the study's metrics run as part of a trial. So make the report of a folder only if you trust the modules that
it names.
"""
from __future__ import annotations

import contextlib
import importlib
import os
import sys
from typing import TYPE_CHECKING, Any, Iterator, List, Mapping, NamedTuple

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown, shown_text

from .parts import Figure, Html, Section, Table

if TYPE_CHECKING:
    import pandas as pd

    from .outcome import Experiment


class Tables(NamedTuple):
    """The argument of such a function."""

    experiment: Experiment  # plan, factors, configurations, metrics, folder
    trials: pd.DataFrame  # a row per planned trial; columns as of trials.csv
    means: pd.DataFrame  # a row per metric and configuration (tables/means.csv)
    main_effects: pd.DataFrame  # tables/main_effects.csv
    differences: pd.DataFrame  # tables/differences.csv
    interactions: pd.DataFrame  # tables/interactions.csv


def names_of(plan: Mapping[str, Any]) -> List[str]:
    """Return the names of the functions that a plan asks for.

    :raises ConfigurationError: if they are not 'module:function', or a list of such names.
    """
    asked = plan.get('report') or []
    names = [asked] if isinstance(asked, str) else asked
    if not isinstance(names, list) or not all(isinstance(name, str) and name.count(':') == 1 for name in names):
        raise ConfigurationError("plan.json: 'report' must be 'module:function', or a list of such, got "
                                 f'{shown(asked)}')
    return names


def sections(name: str, tables: Tables) -> List[Section]:
    """Return the Sections that a function adds; a function that fails adds a Section that says so.

    :param name: of the function, 'module:function'. :param tables: its argument.
    """
    module, _, function = name.partition(':')
    try:
        with _modules_of(tables.experiment.plan):
            found = getattr(importlib.import_module(module), function)(tables)
        found = [found] if isinstance(found, Section) else list(found)
        for section in found:
            _check(section)
        return found
    except Exception as error:  # whatever the function raises, the rest of the report is made
        problem = shown_text(str(error).strip().splitlines()[0] if str(error).strip() else '')
        return [Section(f'Sections of {name}', (f'They could not be made: {type(error).__name__}: {problem}',))]


@contextlib.contextmanager
def _modules_of(plan: Mapping[str, Any]) -> Iterator[None]:
    """Let Python find modules beside the experiment's file, as it does for the experiment's metrics."""
    provenance = plan.get('provenance')
    folder = provenance.get('folder') if isinstance(provenance, dict) else None
    paths = [folder] if isinstance(folder, str) and os.path.isdir(folder) else []
    sys.path[:0] = paths
    try:
        yield
    finally:
        for path in paths:
            sys.path.remove(path)


def _check(section: Section) -> None:
    if not isinstance(section, Section):
        raise TypeError(f'must give Sections, got {shown(section)}')
    for part in section.parts:
        if not isinstance(part, (str, Table, Figure, Html)):
            raise TypeError(f'{section.heading}: a part must be a text, Table, Figure or Html, got {shown(part)}')
