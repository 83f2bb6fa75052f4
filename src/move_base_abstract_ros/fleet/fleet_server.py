"""Many robots in one process. Each is a :class:`RobotServer`; services add, remove and reset robots."""
from __future__ import annotations

import threading
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Sequence, Tuple

import rospy
from std_srvs.srv import Empty, EmptyResponse, Trigger, TriggerResponse

from move_base_abstract.common.bounded_yaml import REQUEST, load_yaml_text
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown, shown_text
from move_base_abstract.scenario import check_frame, counted_places, make_robot
from move_base_abstract.srv import AddRobot, AddRobotResponse, RemoveRobot, RemoveRobotResponse
from move_base_abstract.tasks.room import Rooms
from move_base_abstract.traffic.control import Traffic

from ..markers import world_markers
from ..replacing.bulk_registration import bulk_registration
from ..robot.names import RobotNames
from ..robot.robot_node import server_class
from ..robot.velocity_server import NODE
from .traffic_interface import TrafficInterface

if TYPE_CHECKING:
    from move_base_abstract.scenario import RobotSpec, Scenario

    from ..robot.host import Host
    from ..robot.robot_server import RobotServer


def robot_names(namespace: str, spec: RobotSpec) -> RobotNames:
    """Return the RobotNames of the robot of ``spec`` (RobotSpec) in a fleet in ``namespace``."""
    return RobotNames('{}/{}'.format(namespace.rstrip('/'), spec.name),
                      'move_base' if spec.settings.drive is None else NODE)


#: {parameter: field of a request to add a robot that takes its place}
_OF_REQUEST = {'start_x': 'x', 'start_y': 'y', 'start_yaw': 'yaw'}


class FleetServer:
    """The robots of one process below ``namespace``, in the order of their indices."""

    def __init__(self, namespace: str, host: Host, specs: Sequence[Tuple[int, RobotSpec]], scenario: Scenario,
                 indices: Iterator[int]) -> None:
        """``specs``: (index, RobotSpec) pairs of ``scenario`` (Scenario).

        ``host``: the Host of the process; ``indices``: an iterator of the indices of robots that are added later.
        """
        self._namespace = namespace
        self._host = host
        self._defaults = scenario.defaults
        self._traffic = Traffic(host.clock.simulation, scenario.zones, scenario.traffic)
        self._rooms = None if scenario.places is None else Rooms(host.clock.simulation, scenario.places)
        self._robots: Dict[str, RobotServer] = {}
        self._frames: Dict[str, str] = {}  # {tf frame: name of its robot}
        self._indices = indices
        self._changes = threading.Lock()  # rospy has a thread for each call of a service
        if counted_places(scenario):
            host.clock.keep_causal_rows()
        with bulk_registration():
            for index, spec in specs:
                self._add(spec, index)
        if self._traffic.states():
            self._traffic_interface = TrafficInterface(self._traffic, host.clock)
        world_markers.add(host.clock, scenario, self._traffic, self._rooms)
        # Services come last, so that a node that finds them finds the robots, too.
        self._services = [rospy.Service('~add_robot', AddRobot, self._on_add),
                          rospy.Service('~remove_robot', RemoveRobot, self._on_remove),
                          rospy.Service('~reset', Trigger, self._on_reset)]
        self._resets_as_stage = False
        for _, spec in specs:
            self._serve_as_stage(spec)

    @property
    def names(self) -> List[str]:
        """The robots' names, in the order of their indices."""
        return list(self._robots)

    def shut_down(self) -> None:
        """End all active goals as a killed move_base does."""
        for robot in list(self._robots.values()):
            robot.shut_down()

    def _add(self, spec: RobotSpec, index: int) -> None:
        settings = spec.settings
        check_frame(spec, self._frames, 'robots')
        if settings.tf_prefix is None:
            settings = replace(settings, tf_prefix=spec.name)
        try:
            self._robots[spec.name] = server_class(settings)(
                robot_names(self._namespace, spec), settings, self._host, index, self._traffic, self._rooms)
        except BaseException:
            self._forget_frame(spec.name)
            raise

    def _forget_frame(self, name: str) -> None:
        self._frames = {frame: robot for frame, robot in self._frames.items() if robot != name}

    def _serve_as_stage(self, spec: RobotSpec) -> None:
        """Offer the service of stage_ros from the first robot on that is driven by velocities."""
        if spec.settings.drive is not None and not self._resets_as_stage:
            self._resets_as_stage = True
            name = self._namespace.rstrip('/') + '/reset_positions'
            self._services.append(rospy.Service(name, Empty, self._on_reset_as_stage))

    def _on_add(self, request: Any) -> Any:
        with self._changes:
            return self._add_requested(request)

    def _add_requested(self, request: Any) -> Any:
        try:
            if request.name in self._robots:
                raise ConfigurationError("robot '{}' is there already".format(request.name))
            spec = make_robot(request.name, self._parameters(request), 'robot ' + shown_text(request.name))
            with bulk_registration():
                self._add(spec, next(self._indices))
            self._serve_as_stage(spec)
        except ConfigurationError as error:
            rospy.logwarn('%s: add_robot is refused: %s', rospy.get_name(), error)
            return AddRobotResponse(False, str(error))
        rospy.loginfo('%s: robot %s is added', rospy.get_name(), request.name)
        return AddRobotResponse(True, '')

    def _parameters(self, request: Any) -> Dict[str, Any]:
        own = load_yaml_text(request.parameters, 'parameters', REQUEST) or {}
        if not isinstance(own, dict):
            raise ConfigurationError('parameters: got {}; allowed: a YAML mapping of settings'.format(shown(own)))
        for key, field in _OF_REQUEST.items():
            if key in own:
                raise ConfigurationError("parameters: {}: unknown here; the request's own field {} sets it".format(
                    key, field))
        return {**self._defaults, 'start_x': request.x, 'start_y': request.y, 'start_yaw': request.yaw, **own}

    def _on_remove(self, request: Any) -> Any:
        with self._changes:
            return self._remove_requested(request)

    def _remove_requested(self, request: Any) -> Any:
        robot = self._robots.pop(request.name, None)
        if robot is None:
            return RemoveRobotResponse(False, "robot '{}' is unknown; there are: {}".format(
                shown_text(request.name), ', '.join(self.names[:10]) or 'none'))
        robot.close()
        self._forget_frame(request.name)
        rospy.loginfo('%s: robot %s is removed', rospy.get_name(), request.name)
        return RemoveRobotResponse(True, '')

    def _on_reset_as_stage(self, request: Any) -> Any:
        self._on_reset(request)
        return EmptyResponse()

    def _on_reset(self, _request: Any) -> Any:
        with self._changes:
            robots = list(self._robots.values())
            with self._host.clock.lock:
                for robot in robots:
                    robot.reset()
        rospy.loginfo('%s: %d robots are reset', rospy.get_name(), len(robots))
        return TriggerResponse(True, '{} robots are at their start'.format(len(robots)))
