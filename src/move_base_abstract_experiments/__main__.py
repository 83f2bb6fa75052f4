"""Run any system many times: python3 -m move_base_abstract_experiments run|status|rerun|report.

See docs/experiments.md. Without ROS the trials of an experiment are functions.
"""
from __future__ import annotations

import sys

from move_base_abstract.common import guard, lasting_output, processes

from . import command


def main() -> None:
    """Run the command line and exit with its code."""
    lasting_output.outlive_readers()
    guard.stand('experiment')
    processes.finish(command.main(sys.argv[1:]))


if __name__ == '__main__':
    main()
