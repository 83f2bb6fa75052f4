"""The node ``velocity_robot``: one abstract robot that is driven by velocities, as one of Stage or with a driver."""
import rospy

from move_base_abstract.config.robot_table import DRIVEN

from ..process.node_process import parse_no_arguments
from ..robot.names import RobotNames
from ..robot.robot_node import run
from ..robot.velocity_server import NODE


def main():
    """Run the node until ROS shuts down; exits with 1 if a parameter cannot be used."""
    parse_no_arguments(NODE, __doc__, is_strict=False)
    run(NODE, lambda: (RobotNames(rospy.get_namespace(), rospy.get_name()), dict([DRIVEN]), None))
