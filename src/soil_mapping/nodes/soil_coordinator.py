"""The node ``soil_coordinator``."""

import sys

from ..ros.find_python import find_python


def main():
    """Run one mission and exit."""
    if not {'-h', '--help'} & set(sys.argv[1:]):
        find_python(sys.argv)
    from ..ros.coordinator_node import main as node
    node()
