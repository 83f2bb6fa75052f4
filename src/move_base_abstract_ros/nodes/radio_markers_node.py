"""The node ``radio_markers``: shows the state of a radio's links in RViz. It is an onlooker.

It hears /time_master/links and publishes /radio_markers, in the frame that its private parameter ``frame_id`` names
(default: 'map').
"""
import rospy
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from move_base_abstract.msg import RadioLinks

from ..process.node_process import parse_no_arguments
from ..replacing import rospy_start

_WIDTH, _HEIGHT = 0.06, 0.03  # m
_DOWN, _QUIET = ColorRGBA(0.85, 0.15, 0.15, 0.35), ColorRGBA(0.5, 0.5, 0.5, 0.6)
_USED, _LOSING = ColorRGBA(0.1, 0.65, 0.25, 0.9), ColorRGBA(0.95, 0.55, 0.1, 0.9)


class RadioMarkers:
    """Makes markers of successive RadioLinks messages; colours show changes since the message before."""

    def __init__(self, frame_id):
        self._frame_id = frame_id
        self._counts = {}

    def of(self, message):
        """Return the MarkerArray of a RadioLinks message: a line for each link whose two positions are known."""
        placed = [link for link in message.links if link.placed]
        markers = MarkerArray([self._line(number, link, message.stamp) for number, link in enumerate(placed)])
        self._counts = {(link.one, link.other): (link.arrived, link.lost) for link in message.links}
        return markers

    def _line(self, number, link, stamp):
        marker = Marker(ns='radio', id=number, type=Marker.LINE_STRIP, action=Marker.ADD, color=self._colour(link))
        marker.header.frame_id, marker.header.stamp = self._frame_id, stamp
        marker.pose.orientation.w = 1.0
        marker.scale.x = _WIDTH
        for place in (link.one_at, link.other_at):
            place.z = _HEIGHT
            marker.points.append(place)
        return marker

    def _colour(self, link):
        arrived, lost = self._counts.get((link.one, link.other), (0, 0))
        if not link.up:
            return _DOWN
        return _LOSING if link.lost > lost else _USED if link.arrived > arrived else _QUIET


def main():
    """Show links until ROS shuts down."""
    parse_no_arguments('radio_markers', __doc__)
    rospy_start.prepare()
    rospy.init_node('radio_markers', disable_rosout=True)
    markers = RadioMarkers(rospy.get_param('~frame_id', 'map'))
    publisher = rospy.Publisher('/radio_markers', MarkerArray, queue_size=1, latch=True)
    rospy.Subscriber('/time_master/links', RadioLinks, lambda message: publisher.publish(markers.of(message)))
    rospy.spin()
