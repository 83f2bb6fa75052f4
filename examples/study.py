#!/usr/bin/env python3
"""Run the soil compaction mapping study: python3 examples/study.py trial|run|report|status|rerun|setup."""
import sys

from soil_mapping import environment
from soil_mapping.ros.find_python import find_python


def main():
    """Run the command line and exit with its exit code."""
    if sys.argv[1:] == ['setup']:  # before imports that need what it installs
        sys.exit(environment.main([str(environment.of_the_user())]))
    if not {'-h', '--help'} & set(sys.argv[1:]):
        find_python(sys.argv, 'study')
    from move_base_abstract.common import processes
    with processes.importing():
        from soil_mapping.study import command
    processes.finish(command.main())


if __name__ == '__main__':  # Dask's workers import this file
    main()
