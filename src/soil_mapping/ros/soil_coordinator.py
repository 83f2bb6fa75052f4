"""The node ``soil_coordinator``, as a launch file starts it: ``lockstep --own soil_mapping.ros.soil_coordinator``."""
from __future__ import annotations

import sys

from .find_python import find_python


def main() -> None:
    """Run one mission and exit."""
    if not {'-h', '--help'} & set(sys.argv[1:]):
        find_python([sys.argv[0], '--own', __name__, *sys.argv[1:]], 'soil_coordinator')
    from .coordinator_node import main as node
    node()
