"""The imports of the nodes of a trial on ROS: imported before the nodes are forked, they are there for all of them."""

from move_base_abstract_ros.fleet import fleet_server  # noqa: F401 - for the forks
from move_base_abstract_ros.replacing import replaced
from move_base_abstract_ros.robot import robot_node, work_server  # noqa: F401 - for the forks

replaced.look_up()
