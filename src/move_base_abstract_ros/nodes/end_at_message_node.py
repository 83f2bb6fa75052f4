"""The node ``end_at_message``: takes part in a run, and leaves it at the first message on a topic.

The private parameter ``topic`` names the topic. If the time master's parameter ``end_with`` names this node, the run
ends at that message, at the same instant each time.
"""
import sys

import rospy

from move_base_abstract.common.errors import SimulatorError

from .. import lockstep
from ..process.node_process import parse_no_arguments
from ..replacing import rospy_start


def main():
    """Wait for the message, and exit; with 1 if the parameter is missing, or if the run ends before the message."""
    parse_no_arguments('end_at_message', __doc__)
    rospy_start.prepare()
    rospy.init_node('end_at_message', disable_rosout=True)
    try:
        topic = rospy.get_param('~topic')
        lockstep.join()
        rospy.wait_for_message(topic, rospy.AnyMsg)
    except KeyError:
        sys.exit('{}: the parameter topic, the name of a topic, is missing'.format(rospy.get_name()))
    except (SimulatorError, rospy.ROSException) as error:
        sys.exit('{}: {}'.format(rospy.get_name(), error))
