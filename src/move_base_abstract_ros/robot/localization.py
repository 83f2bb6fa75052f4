"""The services of amcl, which stands beside move_base in most set-ups: the robot is where the core says, exactly."""
import rospy
from nav_msgs.srv import SetMap, SetMapResponse
from std_srvs.srv import Empty, EmptyResponse


class Localization:
    """``global_localization``, ``request_nomotion_update`` and ``set_map`` in the robot's namespace.

    ``show()`` tells once more where the robot is; ``place(header, pose)`` puts it somewhere and returns why not, or ''.
    """

    def __init__(self, names, robot_map, show, place):
        self._robot = names.robot
        self._map = robot_map
        self._show = show
        self._place = place
        self._services = [rospy.Service(names.topic('global_localization'), Empty, self._spread),
                          rospy.Service(names.topic('request_nomotion_update'), Empty, self._update),
                          rospy.Service(names.topic('set_map'), SetMap, self._set_map)]

    def close(self):
        """Leave the graph."""
        for service in self._services:
            service.shutdown('the robot is removed')

    def _spread(self, _request):
        """Do nothing: there are no particles that could be spread, and the pose stays exact."""
        rospy.loginfo('%s: global_localization changes nothing: the pose is exact', self._robot)
        return EmptyResponse()

    def _update(self, _request):
        self._show()
        return EmptyResponse()

    def _set_map(self, request):
        """Judge goals by the map, where the robot uses one, and put the robot where the request says."""
        initial = request.initial_pose
        text = self._place(initial.header, initial.pose.pose) or self._map.give(request.map)
        if text:
            rospy.logwarn('%s: set_map: %s', self._robot, text)
        return SetMapResponse(success=not text)
