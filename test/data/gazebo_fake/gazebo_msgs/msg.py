"""gazebo_msgs/ModelState."""
from .definitions import TYPES

ModelState = TYPES['gazebo_msgs/ModelState']
