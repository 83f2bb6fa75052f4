"""The node ``radio_markers``: shows the state of a radio's links in RViz. It is an onlooker.

It hears /time_master/links and publishes /radio_markers, in the frame that its private parameter ``frame_id`` names
(default: 'map').
"""
import rospy
from visualization_msgs.msg import MarkerArray

from move_base_abstract.msg import RadioLinks

from ..markers.radio_markers import RadioMarkers
from ..process.node_process import parse_no_arguments


def main():
    """Show links until ROS shuts down."""
    parse_no_arguments('radio_markers', __doc__)
    rospy.init_node('radio_markers', disable_rosout=True)
    markers = RadioMarkers(rospy.get_param('~frame_id', 'map'))
    publisher = rospy.Publisher('/radio_markers', MarkerArray, queue_size=1, latch=True)
    rospy.Subscriber('/time_master/links', RadioLinks, lambda message: publisher.publish(markers.of(message)))
    rospy.spin()
