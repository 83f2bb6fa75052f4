#!/usr/bin/python3
"""Take the README's picture of the soil study: RViz with prediction, variance, robots, samples and tasks.

usage: python3 tools/take_soil_picture.py [OUTPUT.png]     (default: docs/images/soil_mapping.png)

Like take_picture.py it uses a ROS master and a screen of its own. The mission runs in lockstep to UNTIL, then stands
still.
"""
import os

import rospkg
import rospy
import take_picture
from nav_msgs.msg import OccupancyGrid
from output_file import output_file

from move_base_abstract_ros.loopback import PACKAGE, Loopback
from move_base_abstract_ros.time_master_client import TimeMasterClient

UNTIL = 230.0  # s, simulated: the instant of the picture


def main():
    """Take the picture and write it to its file."""
    output = output_file('docs/images/soil_mapping.png', __doc__)
    with Loopback() as ros:
        ros.adopt()
        screen = take_picture.Screen()
        try:
            start(ros)
            rospy.init_node('picture', disable_signals=True)
            TimeMasterClient().run_until(UNTIL)
            rospy.wait_for_message('/soil_coordinator/prediction', OccupancyGrid)
            take_picture.shoot(ros, output, topics=('/move_base_abstract/markers', '/soil_coordinator/prediction'))
        finally:
            rospy.signal_shutdown('the picture is taken')
            screen.close()
    print(f'{output}: {os.path.getsize(output) // 1024} KB')


def start(ros):
    """Start the study with its launch file, and RViz."""
    package = rospkg.RosPack().get_path(PACKAGE)
    launch = os.path.join(package, 'launch', 'soil_mapping.launch')
    quickly = ['--sigint-timeout', '1', '--sigterm-timeout', '1']  # so that no node outlives its roslaunch
    ros.spawn('/roslaunch', ['roslaunch', *quickly, launch, 'clock:=lockstep', 'factor:=40', 'stay:=true'])
    os.environ.update(HOME=ros.log_dir, XDG_RUNTIME_DIR=ros.log_dir)
    rviz = os.path.join(rospkg.RosPack().get_path('rviz'), '..', '..', 'lib', 'rviz', 'rviz')
    ros.spawn('/rviz', [rviz, '-d', os.path.join(package, 'rviz', 'soil_mapping.rviz'), '__name:=rviz'])


if __name__ == '__main__':
    main()
