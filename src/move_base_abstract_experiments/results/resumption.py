"""Decide which trials of an experiment's folder stay when the experiment goes on, and why others run again.

OUT/programs.json    {digest: {file: digest}}: the ingredients of trials; each trial names one of these by its digest
"""
from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Dict, List, Optional, TextIO, Union

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract.lockstep.run_options import ALLOW

from .. import records
from ..description import ingredients, plan
from ..description.ingredients import Made
from ..description.trial import Trial
from ..records import Plan, Result
from . import outputs

FILE = 'programs.json'
_FILE_SAYS = "what the experiment's file says of them, or the version of Python,"


def missing(chosen: List[Trial], folder: outputs.OutputFolder, planned: Plan, keep_old: bool,
            stream: TextIO) -> List[Trial]:
    """Return the Trials that must run. Print why some run again although they were complete.

    With keep_old those stay instead, and ``planned`` gets a label for each, which says that its program has changed.
    A trial that has run twice stays, whether and how it shall run twice now.
    """
    programs, wanted, once = _read(folder.path), set(), 0
    old: Dict[str, List[Trial]] = {}
    unread: List[str] = []
    for one, entry in zip(chosen, planned.trials):
        made = ingredients.of_trial(one)
        name = entry.program = ingredients.name_of(made)
        programs.setdefault(name, made)
        was = _read_trial(folder, one, unread)
        if was is None or not was.is_complete or (was.crashes and one.experiment.crashes != ALLOW):
            wanted.add(one.id)
        elif was.made_of == entry.made_of:
            continue
        elif one.verified_by and not keep_old and was.made_of == plan.made_of_each(one, made)['']:
            once += 1
            wanted.add(one.id)
        elif was.made_of in plan.made_of_each(one, made).values():  # the same, but for its second run
            entry.made_of = was.made_of
        else:
            what = _what(programs, was.program, name)
            old.setdefault(what, []).append(one)
            if keep_old:
                entry.made_of, entry.program = was.made_of, was.program
                entry.kept = f'kept from before: {what} changed since'
            else:
                wanted.add(one.id)
    texts = [_once_text(once)] if once else []
    texts += [f'{unread[0]}: {_again(len(unread))}'] if unread else []
    for text in (*texts, *(_old_text(what, len(those), keep_old) for what, those in old.items())):
        print(f'experiment: {text}', file=stream, flush=True)
    folder.write(FILE, json.dumps(programs, sort_keys=True).encode())
    return [one for one in chosen if one.id in wanted]


def _read_trial(folder: outputs.OutputFolder, trial: Trial, unread: List[str]) -> Optional[Result]:
    try:
        was = records.read_trial(str(folder.path), trial.id)
        return was.judged_by(trial.experiment.primary) if was else None
    except ConfigurationError as problem:
        unread.append(str(problem))
        return None


def _once_text(count: int) -> str:
    if count == 1:
        return '1 trial that has run once shall run twice (verify): it runs again (--keep-old keeps it as it is)'
    return f'{count} trials that have run once shall run twice (verify): they run again (--keep-old keeps them as ' \
           'they are)'


def _old_text(what: str, count: int, keep_old: bool) -> str:
    if keep_old:
        kept = '1 trial is kept' if count == 1 else f'{count} trials are kept'
        return f'{what} changed: {kept}, labelled'
    return f'{what} changed: {_again(count)} (--keep-old keeps {"it" if count == 1 else "them"}, labelled)'


def _again(count: int) -> str:
    return '1 trial runs again' if count == 1 else f'{count} trials run again'


def changed_since(output: str, trial: Trial, was: Result) -> str:
    """Return in words which ingredients of a Trial have changed since ``was``, its trial.json; '' if none has.

    The text ends with 'has' or 'have'.
    """
    made = ingredients.of_trial(trial)
    if was.made_of in plan.made_of_each(trial, made).values():
        return ''
    name = ingredients.name_of(made)
    return _what({**_read(output), name: made}, was.program, name)


def _what(programs: Dict[str, Made], before: Optional[str], now: str) -> str:
    """Return in words what differs between two of the programs, followed by 'has' or 'have'."""
    if before is None or before not in programs:
        return 'what they are made of, as it was not recorded, may have'
    what = ingredients.changed(programs[before], programs[now]) or _FILE_SAYS
    return what + (' have' if ', ' in what or ' and ' in what else ' has')


def _read(folder: Union[str, Path]) -> Dict[str, Made]:
    try:
        found = load_json_mapping(os.path.join(folder, FILE))
    except (FileNotFoundError, ConfigurationError):
        return {}
    return {name: made for name, made in found.items() if isinstance(made, dict)}
