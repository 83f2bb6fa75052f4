"""Run any system many times: rosrun move_base_abstract experiment run|status|rerun|report; see docs/experiments.md."""


def main():
    """Run the command line and exit with its code."""
    import sys

    from move_base_abstract_experiments.command import main as command
    from move_base_abstract_experiments.trials import processes
    processes.finish(command(sys.argv[1:]))
