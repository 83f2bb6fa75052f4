#!/usr/bin/python3
"""Take the picture of the README: RViz with five robots on the map that ships with the package.

usage: python3 tools/take_picture.py [OUTPUT.png]     (default: docs/images/rviz.png)

Everything runs on a ROS master of its own on 127.0.0.1 and on a screen without a monitor (Xvfb) with OpenGL in
software. Simulated time stands still while the picture is taken. No wait is longer than WAIT [s, wall].
"""
import io
import math
import os
import subprocess
import time

import rosgraph
import rospkg
import rospy
from actionlib import SimpleActionClient
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from output_file import output_file
from PIL import Image

from move_base_abstract.msg import PlaceTaskAction, PlaceTaskGoal, Task
from move_base_abstract_ros.loopback import PACKAGE, Loopback
from move_base_abstract_ros.time_master_client import TimeMasterClient

WAIT = 60.0
SCREEN = (1400, 860)  # as large as the window in rviz/simulator.rviz
COLOURED_PIXELS = 2000  # fewest pixels of the robots, when RViz has drawn them
COLOURS = 256  # of the picture's palette, which keeps the file small
ARRIVAL, UNTIL = 11.0, 6.0  # s, simulated: from the goals to the first task, and from there to the picture
SETTINGS = {'max_speed': 2.0, 'marker_size': 2.0, 'use_map': True, 'routes': 'grid', 'robot_radius': 0.6,
            'battery_capacity': 1.0, 'battery_start': 0.9}
# name: start, then goal; x, y [m] and heading [deg] in the map
ROBOTS = {
    'robot_0': ((4.0, 4.0, 0.0), (14.0, 20.0, 0.0)),
    'robot_1': ((30.0, 4.0, 90.0), (18.0, 34.5, 180.0)),
    'robot_2': ((4.0, 36.0, -90.0), (24.0, 20.0, 0.0)),
    'robot_3': ((56.0, 36.0, 180.0), (46.0, 11.5, 0.0)),
    'robot_4': ((56.0, 4.0, 90.0), (40.0, 11.5, 180.0)),
}
ZONES = [{'name': 'pen', 'rectangle': [34.2, 8.2, 51.8, 18.0], 'capacity': 1}]
PLACES = [{'name': 'dock', 'x': 14.0, 'y': 20.0, 'reach': 1.5, 'capacity': 1, 'duration': 60.0, 'power': 500.0}]
WORKER = 'robot_0'  # goes to the dock


def take(output, start, go, topics):
    """Start a system and RViz, let it ``go`` with a client of the clock, and write the picture to its file.

    ``start`` gets the Loopback and the folder of the package, and returns the name of RViz's configuration; ``topics``:
    what RViz has to draw.
    """
    with Loopback() as ros:
        ros.adopt()
        screen = Screen()
        try:
            package = rospkg.RosPack().get_path(PACKAGE)
            config = os.path.join(package, 'rviz', start(ros, package))
            os.environ.update(HOME=ros.log_dir, XDG_RUNTIME_DIR=ros.log_dir)  # RViz's own files go to this run's logs
            rviz = os.path.join(rospkg.RosPack().get_path('rviz'), '..', '..', 'lib', 'rviz', 'rviz')
            ros.spawn('/rviz', [rviz, '-d', config, '__name:=rviz'])
            rospy.init_node('picture', disable_signals=True)
            go(TimeMasterClient())
            shoot(ros, output, topics)
        finally:
            rospy.signal_shutdown('the picture is taken')
            screen.close()
    print(f'{output}: {os.path.getsize(output) // 1024} KB')


class Screen:
    """An Xvfb on a display number that it chooses itself; this process and its children use it."""

    def __init__(self):
        command = ['Xvfb', '-displayfd', '1', '-nolisten', 'tcp', '-screen', '0', '{}x{}x24'.format(*SCREEN)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        number = self._process.stdout.readline().decode().strip()
        if not number:
            raise RuntimeError('Xvfb did not start')
        os.environ.update(DISPLAY=':' + number, LIBGL_ALWAYS_SOFTWARE='1', QT_X11_NO_MITSHM='1')

    def close(self):
        """End it."""
        self._process.terminate()
        self._process.wait()


def start(ros, package):
    """Start time master, map and robots; return the name of RViz's configuration."""
    ros.run('time_master', 'time_master', parameters={'factor': 4.0, 'start_paused': False})
    ros.run('map_server', 'map_server', arguments=[os.path.join(package, 'maps', 'farm_yard.yaml')])
    robots = [dict(name=name, start_x=x, start_y=y, start_yaw=math.radians(heading))
              for name, ((x, y, heading), _) in ROBOTS.items()]
    ros.run('fleet', 'fleet', parameters={'defaults': SETTINGS, 'robots': robots, 'zones': ZONES,
                                            'places': PLACES})
    return 'simulator.rviz'


def send_goals(clock):
    """Send every robot its goal at one instant, and one of them a task; stop time when they are on their way."""
    worker = SimpleActionClient(f'/{WORKER}/work', PlaceTaskAction)
    clients = {name: SimpleActionClient(f'/{name}/move_base', MoveBaseAction) for name in ROBOTS}
    for name, client in [*clients.items(), (WORKER, worker)]:
        if not client.wait_for_server(rospy.Duration(100.0 * WAIT)):
            raise RuntimeError(f'{name} takes no goals')
    clock.pause()
    for name, client in clients.items():
        x, y, heading = ROBOTS[name][1]
        target = PoseStamped()
        target.header.frame_id = 'map'
        target.pose.position.x, target.pose.position.y = x, y
        target.pose.orientation.z = math.sin(math.radians(heading) / 2.0)
        target.pose.orientation.w = math.cos(math.radians(heading) / 2.0)
        client.send_goal(MoveBaseGoal(target))
    time.sleep(0.5)
    clock.step(ARRIVAL)
    clients[WORKER].wait_for_result(rospy.Duration(100.0 * WAIT))
    time.sleep(0.5)
    worker.send_goal(PlaceTaskGoal(Task(place=PLACES[0]['name'])))
    time.sleep(0.5)
    clock.step(UNTIL)


def shoot(ros, output, topics):
    """Write the screen to ``output`` when RViz has subscribed to ``topics``, has drawn them, and nothing moves."""
    for topic in topics:
        wait_for_subscriber(topic, '/rviz')
    deadline = time.monotonic() + WAIT
    before, now = 0, -1
    while before != now or now < COLOURED_PIXELS:
        ros.check()
        if time.monotonic() > deadline:
            raise RuntimeError(f'RViz has not drawn the robots: {now} coloured pixels')
        time.sleep(2.0)
        image = screenshot()
        before, now = now, coloured_pixels(image)
    image.crop(image.getbbox()).quantize(COLOURS).save(output, optimize=True)  # without the screen's black rest


def screenshot():
    """Return a picture of the screen."""
    done = subprocess.run(['import', '-window', 'root', 'png:-'], stdout=subprocess.PIPE, check=True)
    return Image.open(io.BytesIO(done.stdout)).convert('RGB')


def coloured_pixels(image):
    """Return the number of pixels that are neither grey nor pale."""
    _, saturation, _ = image.convert('HSV').split()
    return sum(saturation.histogram()[200:])


def wait_for_subscriber(topic, node):
    """Wait until the ROS master lists ``node`` as a subscriber of ``topic``."""
    deadline = time.monotonic() + WAIT
    while time.monotonic() < deadline:
        subscribed = dict(rosgraph.Master('/picture').getSystemState()[1])
        if node in subscribed.get(topic, []):
            return
        time.sleep(0.2)
    raise RuntimeError(f'{node} does not subscribe to {topic}')


if __name__ == '__main__':
    take(output_file('docs/images/rviz.png', __doc__), start, send_goals, ('/move_base_abstract/markers', '/map'))
