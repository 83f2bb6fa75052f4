"""Make a Python environment with all that the study needs: Debian's packages, and packages that only PyPI has.

usage: environment.py FOLDER [REQUIREMENTS CONSTRAINTS]    (default: the lists of the study, beside this file)

Compiled libraries that Debian has are kept, because a newer numpy in the environment would break Debian's scipy. The
program never changes a folder that it did not make. It imports only the standard library, so any Python can run it.
"""
from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, List, Optional, Sequence, Tuple, Union

HERE = Path(__file__).resolve().parent
STUDY_LISTS = (HERE / 'requirements.txt', HERE / 'constraints.txt')
KEPT = ('numpy', 'scipy', 'matplotlib', 'pandas', 'pillow')  # compiled against one another
MARKER = 'made-from'  # the file in the folder with the lists from which it was made
UNFINISHED = 'unfinished\n'


class EnvironmentFailure(Exception):
    """The environment cannot be made. The text says why, and what to do."""


def of_the_user() -> Path:
    """Return the folder of the environment that ``study.py setup`` makes, in the user's data folder."""
    data = os.environ.get('XDG_DATA_HOME', '')
    base = Path(data) if os.path.isabs(data) else Path('~/.local/share').expanduser()
    return base / 'move_base_abstract' / 'study_python'


def python_in(folder: Union[str, Path]) -> Path:
    """Return the path of an environment's Python."""
    return Path(folder) / 'bin' / 'python'


def make(folder: Path, lists: Any = STUDY_LISTS) -> Path:
    """Make the environment of two lists, unless it exists already, and return the path of its Python.

    lists: the paths of a file of requirements and a file of constraints, as pip takes them.

    :raises EnvironmentFailure: if the folder holds something else, or a step fails.
    """
    folder = Path(folder)
    pins = _pins_of_the_system()
    wanted = '\n'.join([f'Python {sys.version_info[0]}.{sys.version_info[1]}', *pins, *map(Path.read_text, lists)])
    found = _made_from(folder)
    if found == wanted and os.access(python_in(folder), os.X_OK):
        return python_in(folder)
    if folder.is_symlink():
        print(f'{folder}: is a link to an environment made from other lists; it is used as it is', file=sys.stderr)
        return python_in(folder)
    try:
        _empty(folder, found)
        _fill(folder, lists, pins)
        _write(folder / MARKER, wanted)
    except OSError as error:
        raise EnvironmentFailure(f'{error.filename or folder}: {error.strerror or error}') from None
    return python_in(folder)


def _pins_of_the_system() -> List[str]:
    """Return a line NAME==VERSION for each library of KEPT that this Python has."""
    import importlib.metadata  # takes half as long as Python's start, and other functions do not need it
    pins = []
    for name in KEPT:
        try:
            pins.append(f'{name}=={importlib.metadata.version(name)}')
        except importlib.metadata.PackageNotFoundError:
            continue
    return pins


def _made_from(folder: Path) -> Optional[str]:
    try:
        return (folder / MARKER).read_text()
    except OSError:
        return None


def _empty(folder: Path, found: Optional[str]) -> None:
    """Remove an environment, if this program made it, and leave an empty folder with the marker."""
    if found is not None:
        shutil.rmtree(folder)
    elif folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise EnvironmentFailure(f'{folder}: exists, and was not made by this program (it has no file {MARKER}), so it '
                                 'is not replaced; move it away')
    folder.mkdir(parents=True, exist_ok=True)
    _write(folder / MARKER, UNFINISHED)


def _write(path: Path, text: str) -> None:
    part = path.with_name(path.name + '.part')
    part.write_text(text)
    part.replace(path)


def _fill(folder: Path, lists: Tuple[Path, Path], pins: Sequence[str]) -> None:
    _run([sys.executable, '-m', 'venv', '--system-site-packages', folder],
         'the Python environment could not be made; it needs the Debian package python3-venv')
    requirements, constraints = lists
    with tempfile.TemporaryDirectory() as scratch:
        kept = Path(scratch) / 'kept.txt'
        kept.write_text('\n'.join(pins) + '\n')
        _run([python_in(folder), '-m', 'pip', 'install', '-q', '--disable-pip-version-check', '-r', requirements,
              '-c', constraints, '-c', kept], f'pip could not install {requirements}')


def _run(words: Any, failure: Any) -> None:
    done = subprocess.run([str(word) for word in words], stdin=subprocess.DEVNULL, check=False)
    if done.returncode != 0:
        raise EnvironmentFailure(f'{failure} (exit code {done.returncode}); its message is above')


def main(words: Any) -> int:
    """Make the environment that the words of the command line describe; return the exit code."""
    if len(words) not in (1, 3):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        print(make(Path(words[0]), tuple(Path(word).resolve() for word in words[1:]) or STUDY_LISTS))
    except EnvironmentFailure as error:
        print(f'{Path(sys.argv[0]).name}: {error}', file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
