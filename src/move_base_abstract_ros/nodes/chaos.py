"""Find faults that other orders, late messages or late starts cause: rosrun move_base_abstract chaos; docs/chaos.md."""
import sys


def main():
    """Run the command line and exit with its code."""
    from move_base_abstract.common import guard, lasting_output, processes
    lasting_output.outlive_readers()
    guard.stand('chaos')
    from move_base_abstract_experiments.chaos.command import main as run
    processes.finish(run(sys.argv[1:]))
