"""gazebo_msgs/SetModelState."""
from .definitions import TYPES


class SetModelState:
    """What rospy wants to know of a service type."""

    _type = 'gazebo_msgs/SetModelState'
    _md5sum = 'test'
    _request_class = TYPES['gazebo_msgs/SetModelStateRequest']
    _response_class = TYPES['gazebo_msgs/SetModelStateResponse']
