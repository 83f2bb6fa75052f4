"""The services of amcl, which most systems run beside move_base. Here the robot knows exactly where it is."""
import rospy
from nav_msgs.srv import SetMap, SetMapResponse
from std_srvs.srv import Empty, EmptyResponse


class Localization:
    """Offers ``global_localization``, ``request_nomotion_update`` and ``set_map`` in the robot's namespace.

    ``show()`` publishes the robot's pose once more. ``place(header, pose)`` moves the robot to a pose, and returns ''
    or the reason why it cannot.
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
        """Shut the services down."""
        for service in self._services:
            service.shutdown('the robot is removed')

    def _spread(self, _request):
        """Do nothing: there are no particles to spread, and the pose stays exact."""
        rospy.loginfo('%s: global_localization changes nothing: the pose is exact', self._robot)
        return EmptyResponse()

    def _update(self, _request):
        self._show()
        return EmptyResponse()

    def _set_map(self, request):
        """Move the robot to the pose of the request, and use the map of the request, if the robot uses one."""
        initial = request.initial_pose
        text = self._place(initial.header, initial.pose.pose) or self._map.give(request.map)
        if text:
            rospy.logwarn('%s: set_map: %s', self._robot, text)
        return SetMapResponse(success=not text)
