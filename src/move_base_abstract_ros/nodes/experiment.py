"""Run any system many times: rosrun move_base_abstract experiment run|status|rerun|report; see docs/experiments.md.

It is not a node; its code is in the package ``move_base_abstract_experiments``.
"""


def main():
    """Run the command line and exit with its code."""
    from move_base_abstract_experiments.__main__ import run
    run()
