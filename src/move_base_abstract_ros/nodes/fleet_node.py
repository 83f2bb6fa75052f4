"""The node ``fleet``: many robots in one process. Each has the interface of move_base in a namespace of its own."""
import itertools
import resource
import time

import rospy

from move_base_abstract.config.node_tables import FLEET
from move_base_abstract.encounters.control import make_encounters
from move_base_abstract.scenario import check_one_process

from ..clocks.timing import make_timing
from ..fleet.fleet_scenario import INLINE, read_fleet_scenario
from ..fleet.fleet_server import FleetServer, robot_names
from ..process.node_process import parse_no_arguments, run_node
from ..process.own_parameters import own_values
from ..robot.host import Host
from ..robot.robot_node import start

_LAST_WORDS_SECONDS = 0.2


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter or the scenario cannot be used."""
    parse_no_arguments('fleet', __doc__)
    begin = time.monotonic()
    _allow_many_connections()

    def set_up():
        fleet = _build()
        if fleet is not None:
            rospy.loginfo('%s: %d robots are ready after %.2f s', rospy.get_name(), len(fleet.names),
                          time.monotonic() - begin)
        return fleet
    run_node('fleet', set_up, _say_goodbye)


def _build():
    where = rospy.get_name()
    raw, values = own_values(FLEET, INLINE)
    timing = make_timing()
    clock = timing.make_clock()
    scenario = read_fleet_scenario(raw, values, where, timing.base_settings)
    part, parts = values['part'], values['parts']
    check_one_process(scenario, parts, where)
    specs = _share(scenario.robots, part, parts)
    namespace = rospy.get_namespace()
    if not start(clock, timing, [(robot_names(namespace, spec), spec.settings) for _, spec in specs]):
        return None
    # Robots that are added later get indices that no other process of this fleet uses.
    host = Host(clock, timing, is_crowded=True, zones=scenario.zones,
                encounters=make_encounters(clock.simulation, scenario))
    fleet = FleetServer(namespace, host, specs, scenario, itertools.count(len(scenario.robots) + part, parts))
    clock.serve()
    return fleet


def _allow_many_connections():
    """Raise the limit of open files: each client of a robot needs some connections, and the usual limit is 1,024."""
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def _share(robots, part, parts):
    """Return the (index, robot) pairs of process number ``part`` (from 0) of ``parts``; neighbours stay together."""
    begin, end = (len(robots) * number // parts for number in (part, part + 1))
    return list(enumerate(robots))[begin:end]


def _say_goodbye(fleet):
    fleet.shut_down()
    time.sleep(_LAST_WORDS_SECONDS)  # rospy closes connections at once, even if messages are still queued on them
