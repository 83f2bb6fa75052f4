"""Finds a Python that has all that the study needs.

catkin installs scripts with the Python for which ROS was built. Packages that Debian lacks are in a virtual
environment: the one of SOIL_MAPPING_PYTHON (the path of its python), .ws/venv in the source tree, which `make study`
makes, or the one that `study.py setup` makes for a user. If the Python of a program lacks an import, the program starts
itself again with the first of these that exists. This module imports only the standard library.
"""
from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from typing import List, Sequence

from soil_mapping import environment

# {module: the package that contains it}
NEEDED = {'scipy': 'scipy', 'gstools': 'gstools', 'jinja2': 'Jinja2'}
VARIABLE = 'SOIL_MAPPING_PYTHON'
STARTED_AGAIN = 'SOIL_MAPPING_STARTED_AGAIN'
# One thread for each trial: trials run in parallel, and sums are the same for every number of cores.
ONE_THREAD = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


def find_python(words: Sequence[str], program: str) -> None:
    """Start ``program``, by this command line, again with another Python, unless this one has all that is needed.

    If there is no such Python, the program exits with an error. Call this before numpy is imported, because it sets
    numpy's number of threads.
    """
    for name in ONE_THREAD:
        os.environ.setdefault(name, '1')
    missing = [package for module, package in NEEDED.items() if importlib.util.find_spec(module) is None]
    started_again = os.environ.pop(STARTED_AGAIN, None)
    if not missing:
        return
    candidates = _candidates()
    python = next((path for path in candidates if os.access(path, os.X_OK)), None)
    if started_again or python is None:
        sys.exit(f'{program}: {", ".join(missing)} not installed for {sys.executable}'
                 f"{'' if started_again else ', and there is no ' + ' and no '.join(candidates)}; run "
                 f'`python3 $(rospack find move_base_abstract)/examples/study.py setup`, or set {VARIABLE} to a Python '
                 f'that has all packages of {environment.STUDY_LISTS[0]}')
    os.environ[STARTED_AGAIN] = '1'
    os.execv(python, [python, *words])


def _candidates() -> List[str]:
    """Return the paths at which a suitable Python may be, in the order of preference."""
    if os.environ.get(VARIABLE):
        return [os.environ[VARIABLE]]
    source_tree = Path(__file__).resolve().parents[3]
    folders = [source_tree / '.ws' / 'venv'] if (source_tree / 'package.xml').is_file() else []
    return [str(environment.python_in(folder)) for folder in (*folders, environment.of_the_user())]
