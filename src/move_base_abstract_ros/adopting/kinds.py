"""Tell what the nodes of launch files are for, by their package and type, and what the rules do with them."""
import re
from typing import NamedTuple

ROBOT, MAP, LEFT_OUT, FRAME, STATE, ELSE = 'robot', 'map', 'left out', 'frame', 'state', 'else'


class Kind(NamedTuple):
    """The kind of a node. ``word``: ROBOT, MAP, LEFT_OUT, FRAME, STATE or ELSE. ``why``: the reason for LEFT_OUT."""

    word: str
    why: str = ''


_BY_NAME = {
    ('move_base', 'move_base'): Kind(ROBOT),
    ('map_server', 'map_server'): Kind(MAP),
    ('tf', 'static_transform_publisher'): Kind(FRAME),
    ('tf2_ros', 'static_transform_publisher'): Kind(FRAME),
    ('robot_state_publisher', 'robot_state_publisher'): Kind(STATE),
    ('robot_state_publisher', 'state_publisher'): Kind(STATE),
    ('joint_state_publisher', 'joint_state_publisher'): Kind(STATE),
    ('joint_state_publisher_gui', 'joint_state_publisher_gui'): Kind(STATE),
}
_SIMULATOR = 'it is a simulator with a clock of its own, or a part of one'
_SPAWNS = 'it puts a model into a simulator that is not there'
_PLACE = 'it says where the robot is, and so does ours'
_SENSES = 'it processes data of sensors or wheels, and there are none'
_PERSON = 'it waits for a person or a joystick'
_TOOLS = 'it drives a device, and there is none'
_TO_DRIVE = 'it drives the robot, and so does ours'
#: (expression for 'package/type', why such a node is left out); the first that matches counts
_LEFT_OUT = [(re.compile('(?:{})/(?:{})'.format(package, kind)), why) for package, kind, why in (
    ('.*', '(?:spawn_?(?:model|urdf|sdf|robot|.*_model)|urdf_spawner|delete_model)(?:\\.py)?', _SPAWNS),
    ('gazebo_ros|gazebo|gazebo_plugins|ros_gz.*|ros_ign.*', '.*', _SIMULATOR),
    ('stage_ros|stage|stdr_.*|flatland_server|mvsim|morse.*|coppeliasim.*|vrep.*|webots_ros|pedsim_simulator',
     '.*', _SIMULATOR),
    ('controller_manager', '.*', _TO_DRIVE),
    ('amcl|fake_localization|mcl.*|als_ros|robot_pose_ekf|robot_localization', '.*', _PLACE),
    ('gmapping|slam_.*|hector_mapping|cartographer_ros|karto.*|rtabmap.*|octomap_server|.*_slam', '.*', _SENSES),
    ('laser_.*|pointcloud_.*|depthimage_.*|imu_.*|ira_laser_tools|scan_tools|laser_scan_matcher', '.*', _SENSES),
    ('teleop.*|.*_teleop|joy|turtlesim', '.*teleop.*|.*key.*|joy.*', _PERSON),
    ('twist_mux|cmd_vel_mux|yocs_cmd_vel_mux|yocs_velocity_smoother|topic_tools', 'twist_mux|cmd_vel_mux|.*smoother.*',
     _TO_DRIVE),
    ('rosserial.*|kobuki_.*|rplidar_ros|urg_node|hokuyo_node|sick_.*|lms1xx|realsense2_camera|usb_cam|velodyne_.*|'
     'ydlidar.*|hls_lfcd_lds_driver|.*_driver|.*_drivers|rosaria|.*_hardware', '.*', _TOOLS),
)]
_CLOCK = re.compile(r'(?:.*_)?(?:sim_?time|clock)(?:_.*)?(?:\.py)?')
CLOCK = 'it is a clock, and in lockstep only the time master is one'
NO_PROGRAM = 'this program is not installed here'


def kind_of(package, name):
    """Return the Kind of a node's package and type."""
    known = _BY_NAME.get((package, name))
    if known is not None:
        return known
    for expression, why in _LEFT_OUT:
        if expression.fullmatch('{}/{}'.format(package, name)):
            return Kind(LEFT_OUT, why)
    return Kind(ELSE)


def looks_like_a_clock(name):
    """Return whether a program is only a clock, as far as its name shows."""
    return _CLOCK.fullmatch(name) is not None


_INCLUDES_A_ROBOT = re.compile(r'.*(?:move_?base|navigation|(?:^|_)nav(?=[_.])|amcl_demo).*\.(?:launch|xml)')
_NO_ROBOT = re.compile(r'.*(?:gmapping|slam|rviz|world|spawn|teleop|gazebo).*')


def stands_for_a_robot(path):
    """Return whether a launch file that is not here starts a move_base, as far as its name shows."""
    name = path.rpartition('/')[2].lower()
    return _INCLUDES_A_ROBOT.fullmatch(name) is not None and _NO_ROBOT.fullmatch(name) is None
