"""The node ``move_base``: one abstract robot that stands in for move_base and has its interface."""
import rospy

from ..process.node_process import parse_no_arguments
from ..robot.names import RobotNames
from ..robot.robot_node import run


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter cannot be used."""
    parse_no_arguments('move_base', __doc__, is_strict=False)
    run('move_base_node', lambda: (_names(), {}, None))


def _names():
    """Return the robot's names. As upstream, a remap of move_base renames only the action."""
    return RobotNames(rospy.get_namespace(), rospy.get_name(), rospy.resolve_name('move_base'))
