"""The programs of one recording: a ROS master of its own on 127.0.0.1, Stage, and a move_base for each robot."""
import os
import signal
import socket
import subprocess
from pathlib import Path

import yaml

_OWN = Path(__file__).resolve().parent
_PLANNER = _OWN.parent.parent / 'config' / 'example' / 'dwa_local_planner.yaml'
_COLOURS = ('red', 'green', 'blue', 'orange')
_WORLD = """resolution 0.05
threads 1
define scan ranger
(
  sensor ( range [0.0 6.5] fov 270 samples 271 )
  size [0.05 0.05 0.05]
  pose [0 0 -0.12 0]
  ranger_return 0
  obstacle_return 0
)
define agent position
(
  size [0.36 0.36 0.22]
  origin [0 0 0 0]
  gui_nose 1
  drive "diff"
  localization "gps"
  localization_origin [0 0 0 0]
  obstacle_return 1
  ranger_return 1
  velocity_bounds [-1.2 1.2 0 0 0 0 -115 115]
  acceleration_bounds [-1 1 -1 1 -1 1 -180 180]
  scan()
)
define floorplan model
(
  color "gray30"
  boundary 0
  gui_nose 0
  gui_grid 0
  gui_move 0
  gui_outline 0
  gripper_return 0
  fiducial_return 0
  ranger_return 1
  obstacle_return 1
)
floorplan ( name "walls" size [{width:.3f} {height:.3f} 1.000] pose [{x:.3f} {y:.3f} 0 0] bitmap "{bitmap}" )
"""


def program(package, name):
    """Return the path of a program of a built or installed package.

    :raises SystemExit: if there is none in the environment's CMAKE_PREFIX_PATH.
    """
    for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(':') + ['/usr']:
        path = Path(prefix) / 'lib' / package / name
        if prefix and os.access(str(path), os.X_OK):
            return str(path)
    raise SystemExit('{}/{}: not found; source the environment in which it was built'.format(package, name))


def free_port():
    """Return a TCP port that is free on 127.0.0.1."""
    with socket.socket() as own:
        own.bind(('127.0.0.1', 0))
        return own.getsockname()[1]


def write_world(folder, place, starts):
    """Write the world of a Place with robots at ``starts``, (x, y, yaw in degrees) each; return its path."""
    text = _WORLD.format(width=place.width, height=place.height, x=place.width / 2.0, y=place.height / 2.0,
                         bitmap=place.name + '.png')
    for number, (x, y, yaw) in enumerate(starts):
        text += 'agent( name "robot_{}" color "{}" pose [ {:.2f} {:.2f} 0 {:.1f} ] )\n'.format(
            number, _COLOURS[number], x, y, yaw)
    path = folder / 'recording.world'
    path.write_text(text)
    return path


def parameters(robots):
    """Return {name of a ROS parameter: value} for the move_bases and localizations of ``robots`` robots."""
    planner = yaml.safe_load(_PLANNER.read_text())
    values = {'/use_sim_time': True, '/stageros/base_watchdog_timeout': 0.5, '/stageros/steps_from_stdin': True}
    for name in ('robot_{}'.format(number) for number in range(robots)):
        costmaps = yaml.safe_load((_OWN / 'costmaps.yaml').read_text())
        for costmap in costmaps.values():
            costmap['robot_base_frame'] = name + '/base_link'
        costmaps['local_costmap']['global_frame'] = name + '/odom'
        values['/{}/move_base'.format(name)] = dict(planner, **costmaps)
        values['/{}/fake_localization'.format(name)] = {
            'odom_frame_id': name + '/odom', 'base_frame_id': name + '/base_link', 'global_frame_id': 'map'}
    return values


class Stage:
    """Stage, one step at a time: it does a step for each byte on its input, and answers with a byte."""

    def __init__(self, start, world):
        self._steps, theirs = socket.socketpair()
        self.process = start([program('stage_ros', 'stageros'), '-g', '-u', str(world)], 'stageros', stdin=theirs)
        theirs.close()

    def step(self):
        """Let Stage do one step of 0.1 s.

        :raises RuntimeError: if it has ended, with its exit code.
        """
        try:
            self._steps.sendall(b'.')
            answer = self._steps.recv(1)
        except OSError:
            answer = b''
        if not answer:
            raise RuntimeError('Stage ended with {}'.format(self.process.wait()))


class Programs:
    """The programs that were started; stop() ends these, and no others, in the reverse order."""

    def __init__(self, folder):
        self._folder = folder
        self.processes = []
        self.port = free_port()
        self.environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:{}'.format(self.port), ROS_IP='127.0.0.1',
                                ROS_HOME=str(folder), ROS_LOG_DIR=str(folder / 'log'))
        self.environment.pop('ROS_HOSTNAME', None)

    def start(self, command, name, **options):
        """Start a program whose output goes to ``name``.out; return its Popen."""
        with open(str(self._folder / (name + '.out')), 'wb') as output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=self.environment,
                                       cwd=str(self._folder), start_new_session=True, **options)
        self.processes.append(process)
        return process

    def start_master(self):
        """Start the ROS master."""
        self.start(['rosmaster', '--core', '-p', str(self.port)], 'rosmaster')

    def start_robots(self, map_file, robots):
        """Start map_server, and localization and move_base of each robot; return their Popens."""
        started = [self.start([program('map_server', 'map_server'), str(map_file)], 'map_server')]
        for name in ('robot_{}'.format(number) for number in range(robots)):
            for package in ('fake_localization', 'move_base'):
                started.append(self.start(
                    [program(package, package), '__ns:=/' + name, '__name:=' + package], '{}_{}'.format(name, package)))
        return started

    def stop(self):
        """End all programs."""
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in reversed(self.processes):
            try:
                process.wait(5.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
