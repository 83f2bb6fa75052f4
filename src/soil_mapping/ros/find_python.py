"""A Python that has what the study needs.

catkin installs scripts with the Python that ROS was built for, and what is not Debian's lies in a virtual environment:
that of SOIL_MAPPING_PYTHON (the path of its python), .ws/venv in the source tree, which `make study` makes, or the one
that `study setup` makes for a user. A program whose Python lacks an import starts itself again with the first of these
that is there. Imports nothing but the standard library.
"""

import importlib.util
import os
import sys
from pathlib import Path

from soil_mapping import environment

# modules and the packages that have them
NEEDED = {'scipy': 'scipy', 'gstools': 'gstools', 'jinja2': 'Jinja2'}
VARIABLE = 'SOIL_MAPPING_PYTHON'
STARTED_AGAIN = 'SOIL_MAPPING_STARTED_AGAIN'
# One thread per trial: trials run side by side, and sums come out the same on every number of cores.
ONE_THREAD = ('OPENBLAS_NUM_THREADS', 'OMP_NUM_THREADS', 'MKL_NUM_THREADS')


def find_python(words):
    """Start the program of these words again with another Python, unless this one has what is needed.

    Exits with an error where there is none. To be called before numpy is imported: it sets numpy's number of threads.
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
        sys.exit(f'{Path(words[0]).name}: {", ".join(missing)} not installed for {sys.executable}'
                 f"{'' if started_again else ', and there is no ' + ' and no '.join(candidates)}; run `rosrun "
                 f'move_base_abstract study setup`, or have {VARIABLE} name a Python that has all of '
                 f'{environment.STUDY_LISTS[0]}')
    os.environ[STARTED_AGAIN] = '1'
    os.execv(python, [python, *words])


def _candidates():
    """Return the paths where a Python may be that has what is needed, the first to be taken first."""
    if os.environ.get(VARIABLE):
        return [os.environ[VARIABLE]]
    source_tree = Path(__file__).resolve().parents[3]
    folders = [source_tree / '.ws' / 'venv'] if (source_tree / 'package.xml').is_file() else []
    return [str(environment.python_in(folder)) for folder in (*folders, environment.of_the_user())]
