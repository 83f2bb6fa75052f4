"""Two clocks: simulators with a clock of their own and a time master do not go together."""
import threading

import rosgraph
import rospy

_first_time = threading.Lock()


def warn_if_shared(simulator):
    """Warn if several nodes publish /clock; asked of the ROS master once per process. ``simulator``: for people."""
    if not _first_time.acquire(blocking=False):
        return
    names = clock_publishers()
    if len(names) > 1:
        rospy.logwarn('%s: /clock is published by %s: time jumps between them. %s has a clock of its own; start '
                      'without the time master (simulator.launch time_master:=false)',
                      rospy.get_name(), ' and '.join(names), simulator)


def clock_publishers():
    """Return the names of the nodes that publish /clock, in order; none if the ROS master does not answer."""
    try:
        published = rosgraph.Master(rospy.get_name()).getSystemState()[0]
    except (OSError, rosgraph.MasterException) as error:
        rospy.logwarn('%s: who publishes /clock is not known: %s', rospy.get_name(), error)
        return []
    return sorted(name for topic, names in published if topic == '/clock' for name in names)
