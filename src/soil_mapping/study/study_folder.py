"""The folder of a study: whose it is, and which of the trials in it belong to the study as it was last run."""

import contextlib
import json
import os

from move_base_abstract.own_files import FolderKind, whole_file
from soil_mapping.provenance import package_version

from .truth import digests

KIND = FolderKind('study')
FILE = 'study.json'
VARIED = ('allocation', 'sampling', 'cell_m', 'coarse_cells')  # what differs between the trials of one study


@contextlib.contextmanager
def opened(path, config):
    """Take the folder at the path (a Path) for the study of a TrialConfig, note what it is made of, and yield it.

    :raises ConfigurationError: if the folder is somebody else's, or a study is being run in it.
    """
    marker = KIND.make(path)
    try:
        with whole_file(path / FILE, encoding='utf-8') as stream:
            json.dump({'config': _fixed(config.to_dict()), 'inputs': digests(config.field),
                       'package': package_version()}, stream, indent=1)
        yield path
    finally:
        os.close(marker)


def belongs(path):
    """Return a function that tells of a trial.json's content whether that trial is of the study in this folder.

    Without a record of the study all are.
    """
    try:
        with open(path / FILE, encoding='utf-8') as stream:
            study = json.load(stream)
        own = study['config'], study['inputs'], study['package']
    except (OSError, ValueError, KeyError, TypeError):
        return lambda about: True
    return lambda about: (_fixed(about['config']), about.get('inputs'), about.get('package')) == own


def _fixed(config):
    return {name: value for name, value in config.items() if name not in VARIED}
