"""What the nodes of a trial on ROS need: imported before they are forked, it is there for all of them."""

from move_base_abstract_ros.nodes import fleet_node, task_server_node  # noqa: F401 - for the forks
from move_base_abstract_ros.replacing import replaced

replaced.look_up()
