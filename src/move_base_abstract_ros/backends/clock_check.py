"""Warn of two clocks: a simulator with a clock of its own and a time master cannot run together."""
from __future__ import annotations

import threading
from typing import List

import rosgraph
import rospy

from ..clocks.throttle import WallThrottle

_first_time = threading.Lock()
_first_machine_clock = threading.Lock()
_other_clock = WallThrottle(0.1)  # Hz; the robots of a process share their simulator


def warn_if_shared(simulator: str) -> None:
    """Warn if several nodes publish /clock. The ROS master is asked once per process. ``simulator``: its name."""
    if not _first_time.acquire(blocking=False):
        return
    names = clock_publishers()
    if len(names) > 1:
        rospy.logwarn('%s: /clock is published by %s: time jumps between them. %s has a clock of its own; start '
                      'without the time master (simulator.launch time_master:=false)',
                      rospy.get_name(), ' and '.join(names), simulator)


def warn_of_machine_clock(simulator: str) -> None:
    """Warn, once per process, if this node uses the machine's clock."""
    if rospy.rostime.is_wallclock() and _first_machine_clock.acquire(blocking=False):
        rospy.logwarn("%s: /use_sim_time was not true when this node started, so that it goes by the machine's clock. "
                      '%s publishes /clock: set /use_sim_time before the nodes start, or start %s first',
                      rospy.get_name(), simulator, simulator)


def warn_of_other_clock(simulator: str, robot: str, gap: float) -> None:
    """Warn that ``simulator`` stamps its messages about ``robot`` ``gap`` [s] before the present of this node.

    All robots of a process share the limit of one warning in 10 s of wall time.
    """
    if not _other_clock.ready():
        return
    own = "the machine's clock" if rospy.rostime.is_wallclock() else '/clock'
    rospy.logwarn('%s: %s dates its odometry %.1f s %s %s, which this node uses: look-ups in tf of the present '
                  'fail, those of the latest transform work. Use one clock for all nodes; if %s publishes it, start '
                  'without the time master (simulator.launch time_master:=false)', robot, simulator, abs(gap),
                  'before' if gap > 0.0 else 'after', own, simulator)


def clock_publishers() -> List[str]:
    """Return the names of the nodes that publish /clock, in order; none if the ROS master does not answer."""
    try:
        published = rosgraph.Master(rospy.get_name()).getSystemState()[0]
    except (OSError, rosgraph.MasterException) as error:
        rospy.logwarn('%s: the publishers of /clock are not known: %s', rospy.get_name(), error)
        return []
    return sorted(name for topic, names in published if topic == '/clock' for name in names)
