"""The program ``study``."""

import sys

from soil_mapping import environment

from ..ros.find_python import find_python


def main():
    """Run the command line and exit with its exit code."""
    if sys.argv[1:] == ['setup']:  # before imports that need what it installs
        sys.exit(environment.main([str(environment.of_the_user())]))
    find_python(sys.argv)
    from move_base_abstract.common import processes
    with processes.importing():
        from soil_mapping.study.command import main as command
    processes.finish(command())
