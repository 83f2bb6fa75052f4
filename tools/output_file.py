"""The output file of a tool: its file in this repository, or a new one that the command line names."""
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def output_file(own, usage):
    """Return the path on the command line, or by default that of the repository's ``own`` file.

    An existing file, other than ``own``, is never replaced. Wrong arguments end the program with ``usage``.
    """
    if len(sys.argv) > 2:
        sys.exit(usage)
    if len(sys.argv) == 1:
        return ROOT / own
    path = Path(sys.argv[1])
    if os.path.lexists(path) and not (path.resolve() == ROOT / own and not path.is_symlink()):
        sys.exit(f'{path}: exists already and is not replaced; name a new file')
    return path
