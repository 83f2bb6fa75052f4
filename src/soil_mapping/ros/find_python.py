"""A Python that has what the study needs.

catkin installs scripts with the Python that ROS was built for, and what is not Debian's lies in a virtual environment:
that of SOIL_MAPPING_PYTHON (the path of its python), or .ws/venv in this package's folder, which `make deps` makes. A
program whose Python lacks an import starts itself again with that one. Imports nothing but the standard library.
"""

import importlib.util
import os
import sys
from pathlib import Path

NEEDED = {'scipy': 'scipy', 'pykrige': 'PyKrige', 'gstools': 'gstools'}  # modules and the packages that have them
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
    python = os.environ.get(VARIABLE) or str(Path(__file__).resolve().parents[3] / '.ws' / 'venv' / 'bin' / 'python')
    if started_again or not os.access(python, os.X_OK):
        sys.exit(f'{Path(words[0]).name}: {", ".join(missing)} not installed for {sys.executable}, and {python} '
                 f"{'is that Python' if started_again else 'is not there'}; run `make deps` in the package's folder, "
                 f'or have {VARIABLE} name a Python that has all of tools/requirements.txt')
    os.environ[STARTED_AGAIN] = '1'
    os.execv(python, [python, *words])
