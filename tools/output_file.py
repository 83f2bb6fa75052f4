"""Where a tool draws to: the file of this repository that it is for, or a new one that the command line names."""
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def output_file(own, usage):
    """Return the path that the command line names, or that of the repository's ``own`` file; exits with an error.

    What is there already by another name was not made for this, and stays.
    """
    if len(sys.argv) > 2:
        sys.exit(usage)
    if len(sys.argv) == 1:
        return ROOT / own
    path = Path(sys.argv[1])
    if os.path.lexists(path) and not (path.resolve() == ROOT / own and not path.is_symlink()):
        sys.exit(f'{path}: is there already and is not replaced; name a new file')
    return path
