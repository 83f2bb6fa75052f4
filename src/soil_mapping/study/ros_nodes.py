"""The imports of the nodes of a trial on ROS: imported before the nodes are forked, they are there for all of them."""

from move_base_abstract_ros.nodes import fleet_node, task_server_node  # noqa: F401 - for the forks
from move_base_abstract_ros.replacing import replaced

replaced.look_up()
