"""A package of a stranger that nobody has built, for tests of what is made of its launch files."""
import os

import pytest

from move_base_abstract.config.settings import read_settings
from move_base_abstract_ros.launching import adoption, look_ups, plan

WORLD = """# a world
include "robots.inc"
floorplan ( name "walls" bitmap "../maps/walls.pgm" size [ 4.0 3.0 0.8 ] pose [ {pose} ] )
ranger_robot ( pose [ {first} ] name "alice" color "red" laser ( samples 9 ) )
ranger_robot ( pose [ -1.0 1.0 180.0 ] name "bob" )
block ( pose [ 9 9 0 0 ] )
"""
ROBOTS_INC = """define floorplan model ( boundary 1 )
define laser ranger ( sensor ( range [ 0 8 ] ) )
define ranger_robot position ( size [ 0.4 0.4 0.2 ] laser ( ) )
"""
STAGE = """<launch>
  <node pkg="map_server" type="map_server" name="map_server" args="$(dirname)/../maps/walls.yaml"/>
  <node pkg="stage_ros" type="stageros" name="stage" args="{options} $(dirname)/../worlds/two.world"/>
  <group ns="{first}"><node pkg="move_base" type="move_base" name="move_base"/></group>
  <group ns="{second}"><node pkg="move_base" type="move_base" name="move_base"/></group>
</launch>
"""


@pytest.fixture(name='package')
def package_fixture(tmp_path, monkeypatch):
    """Return write(name, text): a file of a package that nobody has built, in launch/ if its name has no folder."""
    for name in ('ROS_PACKAGE_PATH', 'PYTHONPATH'):
        monkeypatch.setenv(name, os.environ.get(name, ''))
    monkeypatch.delenv('TURTLEBOT3_MODEL', raising=False)
    for module in ('substitution_args', 'node_args'):
        monkeypatch.setattr('roslaunch.{}._rospack'.format(module), None)
    look_ups.packages.cache_clear()
    folder = tmp_path / 'src' / 'of_a_stranger'

    def write(name, text, mode=0o644):
        path = folder / name if '/' in name else folder / 'launch' / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(mode)
        return str(path)
    write('launch/../package.xml',
          '<package><name>of_a_stranger</name></package>')
    yield write
    look_ups.packages.cache_clear()


def adopt(path, *arguments, **others):
    """Return the Adopted of a launch file."""
    config = plan.read([(path, list(arguments))], True)
    return adoption.adopt(config, plan.LaunchOptions(**others), read_settings)


def write_map(package, origin='[0.0, 0.0, 0.0]', columns=40, rows=30):
    row = ['0'] + ['255'] * (columns - 2) + ['0']
    wall = ['0'] * columns
    package('maps/walls.pgm', 'P2\n{} {}\n255\n{}\n'.format(
        columns, rows, '\n'.join(' '.join(one) for one in [wall, *[row] * (rows - 2), wall])))
    package('maps/walls.yaml', 'image: walls.pgm\nresolution: 0.1\norigin: {}\nnegate: 0\noccupied_thresh: 0.65\n'
            'free_thresh: 0.196\n'.format(origin))


def write_stage(package, pose, first='1.0 2.0 0 90.0', options='', names=('robot_0', 'robot_1')):
    package('worlds/two.world', WORLD.format(pose=pose, first=first))
    package('worlds/robots.inc', ROBOTS_INC)
    return package('stage.launch', STAGE.format(options=options, first=names[0], second=names[1]))
