"""Which trials of an experiment's folder stay when it goes on, and why others run again.

OUT/programs.json    {digest: {file: digest}}: what the trials, each of which names one of these, were made of
"""
import json
import os

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract_ros.launching import ends

from ..description import ingredients, plan
from ..trials import trial
from . import outputs

FILE = 'programs.json'
_FILE_SAYS = "what the experiment's file says of them, or the version of Python,"


def missing(experiment, chosen, folder, about, keep_old, stream):
    """Return the plan's Trials that are to run, and say why those run that were complete.

    With keep_old these stay instead: in ``about``, plan.json's content, is said that they are of another program.
    """
    programs, found, old = _read(folder.path), [], {}
    planned = {one['id']: one for one in about['trials']}
    for one in chosen:
        made = plan.ingredients_of(experiment, one)
        name = ingredients.name_of(made)
        programs.setdefault(name, made)
        planned[one.id]['program'] = name
        was = outputs.read_trial(folder.path, one.id)
        if was is None or was['status'] != trial.COMPLETE or (was.get('crashes') and experiment.crashes != ends.ALLOW):
            found.append(one)
        elif was['made_of'] != planned[one.id]['made_of']:
            what = _what(programs, was['program'], name)
            old.setdefault(what, []).append(one)
            if keep_old:
                planned[one.id].update(made_of=was['made_of'], program=was['program'],
                                       kept=f'kept from before: {what} changed since')
            else:
                found.append(one)
    for what, those in old.items():
        then = 'are kept, labelled' if keep_old else 'run again (--keep-old keeps them, labelled)'
        print(f'experiment: {what} changed: {len(those)} trials {then}', file=stream, flush=True)
    folder.write(FILE, json.dumps(programs, sort_keys=True).encode())
    wanted = {one.id for one in found}
    return [one for one in chosen if one.id in wanted]


def changed_since(output, experiment, one, was):
    """Return in words what a plan.Trial is made of that is another one than in ``was``, its trial.json; '' if nothing.

    It ends with 'has' or 'have'.
    """
    if was['made_of'] == plan.made_of(experiment, one):
        return ''
    made, programs = plan.ingredients_of(experiment, one), _read(output)
    name = ingredients.name_of(made)
    return _what({**programs, name: made}, was['program'], name)


def _what(programs, before, now):
    """Return in words what has changed from one of the programs to another, with 'has' or 'have'."""
    if before not in programs:
        return 'what they are made of, as it was not recorded, may have'
    what = ingredients.changed(programs[before], programs[now]) or _FILE_SAYS
    return what + (' have' if ', ' in what or ' and ' in what else ' has')


def _read(folder):
    try:
        found = load_json_mapping(os.path.join(folder, FILE))
    except (FileNotFoundError, ConfigurationError):
        return {}
    return {name: made for name, made in found.items() if isinstance(made, dict)}
