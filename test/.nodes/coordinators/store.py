#!/usr/bin/env python3
"""Says how much it has when it is asked."""
import rospy
from std_srvs.srv import Trigger, TriggerResponse


def main():
    """Run until the node is shut down."""
    rospy.init_node('store')
    _service = rospy.Service('stock', Trigger, lambda _request: TriggerResponse(True, '20 parts'))
    rospy.spin()


if __name__ == '__main__':
    main()
