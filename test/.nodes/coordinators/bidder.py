#!/usr/bin/env python3
"""Makes a bid in each auction, after the ~time [s] that it needs to compute its price."""
import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Int32


def main():
    """Run until the node is shut down."""
    rospy.init_node('bidder')
    number, time = rospy.get_param('~number'), rospy.get_param('~time')
    bids = rospy.Publisher('bids', Point, queue_size=10)

    def on_auction(auction):
        rospy.sleep(time)
        bids.publish(auction.data, number, 10.0 + (auction.data * number) % 3)
    rospy.Subscriber('auctions', Int32, on_auction, queue_size=10)
    rospy.spin()


if __name__ == '__main__':
    main()
