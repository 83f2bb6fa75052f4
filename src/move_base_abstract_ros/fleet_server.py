"""Many robots in one process: each a :class:`MoveBaseServer`, added, removed and reset by services."""
import rospy
import yaml
from std_srvs.srv import Trigger, TriggerResponse

from move_base_abstract.errors import ConfigurationError
from move_base_abstract.scenario import make_robot
from move_base_abstract.srv import AddRobot, AddRobotResponse, RemoveRobot, RemoveRobotResponse

from .bulk_registration import bulk_registration
from .move_base_server import MoveBaseServer
from .names import RobotNames


def robot_names(namespace, name):
    """Return the RobotNames of the robot ``name`` of a fleet in ``namespace``."""
    return RobotNames('{}/{}'.format(namespace.rstrip('/'), name))


class FleetServer:
    """The robots of one process below ``namespace``, in the order of their indices."""

    def __init__(self, namespace, host, specs, defaults, indices):
        """``specs``: (index, RobotSpec) pairs; ``defaults``, ``indices``: settings, indices of robots added later."""
        self._namespace = namespace
        self._host = host
        self._defaults = defaults
        self._robots = {}
        self._indices = indices
        with bulk_registration():
            for index, spec in specs:
                self._add(spec, index)
        # Services come last: who finds them finds the robots.
        self._services = [rospy.Service('~add_robot', AddRobot, self._on_add),
                          rospy.Service('~remove_robot', RemoveRobot, self._on_remove),
                          rospy.Service('~reset', Trigger, self._on_reset)]

    @property
    def names(self):
        """The robots' names, in the order of their indices."""
        return list(self._robots)

    def shut_down(self):
        """End all active goals as a killed move_base does."""
        for robot in self._robots.values():
            robot.shut_down()

    def _add(self, spec, index):
        settings = spec.settings
        if settings.tf_prefix is None:
            settings.tf_prefix = spec.name
        self._robots[spec.name] = MoveBaseServer(robot_names(self._namespace, spec.name), settings, self._host, index)

    def _on_add(self, request):
        try:
            if request.name in self._robots:
                raise ConfigurationError("robot '{}' is there already".format(request.name))
            spec = make_robot(request.name, self._parameters(request), 'robot ' + request.name)
            with bulk_registration():
                self._add(spec, next(self._indices))
        except ConfigurationError as error:
            rospy.logwarn('%s: add_robot is refused: %s', rospy.get_name(), error)
            return AddRobotResponse(False, str(error))
        rospy.loginfo('%s: robot %s is added', rospy.get_name(), request.name)
        return AddRobotResponse(True, '')

    def _parameters(self, request):
        try:
            own = yaml.safe_load(request.parameters) or {}
        except yaml.YAMLError as error:
            raise ConfigurationError('parameters: {}'.format(' '.join(str(error).split()))) from None
        if not isinstance(own, dict):
            raise ConfigurationError('parameters: got {!r}; allowed: a YAML mapping of settings'.format(own))
        return dict(self._defaults, start_x=request.x, start_y=request.y, start_yaw=request.yaw, **own)

    def _on_remove(self, request):
        robot = self._robots.pop(request.name, None)
        if robot is None:
            return RemoveRobotResponse(False, "robot '{}' is unknown; there are: {}".format(
                request.name, ', '.join(self.names[:10]) or 'none'))
        robot.close()
        rospy.loginfo('%s: robot %s is removed', rospy.get_name(), request.name)
        return RemoveRobotResponse(True, '')

    def _on_reset(self, _request):
        with self._host.clock.lock:
            for robot in self._robots.values():
                robot.reset()
        rospy.loginfo('%s: %d robots are reset', rospy.get_name(), len(self._robots))
        return TriggerResponse(True, '{} robots are at their start'.format(len(self._robots)))
