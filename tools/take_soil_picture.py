#!/usr/bin/python3
"""Take the README's picture of the soil study: RViz with prediction, variance, robots, samples and tasks.

usage: python3 tools/take_soil_picture.py [OUTPUT.png]     (default: docs/images/soil_mapping.png)

Like take_picture.py it uses a ROS master and a screen of its own. The mission runs in lockstep to UNTIL, then stands
still.
"""
import os

import rospy
import take_picture
from nav_msgs.msg import OccupancyGrid
from output_file import output_file

UNTIL = 230.0  # s, simulated: the instant of the picture


def start(ros, package):
    """Start the study with its launch file; return the name of RViz's configuration."""
    launch = os.path.join(package, 'launch', 'soil_mapping.launch')
    quickly = ['--sigint-timeout', '1', '--sigterm-timeout', '1']  # so that no node outlives its roslaunch
    ros.spawn('/roslaunch', ['roslaunch', *quickly, launch, 'clock:=lockstep', 'factor:=40', 'stay:=true'])
    return 'soil_mapping.rviz'


def go(clock):
    """Run until the instant of the picture."""
    clock.run_until(UNTIL)
    rospy.wait_for_message('/soil_coordinator/prediction', OccupancyGrid)


if __name__ == '__main__':
    take_picture.take(output_file('docs/images/soil_mapping.png', __doc__), start, go,
                      ('/move_base_abstract/markers', '/soil_coordinator/prediction'))
