"""The program ``study``."""

import sys

from ..find_python import find_python


def main():
    """Run the command line and exit with its code."""
    find_python(sys.argv)
    from soil_mapping.study.command import main as command
    sys.exit(command())
