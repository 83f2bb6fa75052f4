"""Tell what the nodes of launch files are for, by their package and type, and what the rules do with them."""
import re
from typing import NamedTuple

ROBOT, MAP, LEFT_OUT, FRAME, STATE, ELSE = 'robot', 'map', 'left out', 'frame', 'state', 'else'


class Kind(NamedTuple):
    """The kind of a node. ``word``: ROBOT, MAP, LEFT_OUT, FRAME, STATE or ELSE. ``why``: the reason for LEFT_OUT.

    ``is_guess``: whether only a part of the name says so. What is there takes precedence over a guess.
    """

    word: str
    why: str = ''
    is_guess: bool = False


_BY_NAME = {
    ('move_base', 'move_base'): Kind(ROBOT),
    ('mbf_costmap_nav', 'mbf_costmap_nav'): Kind(ROBOT),
    ('mbf_simple_nav', 'mbf_simple_nav'): Kind(ROBOT),
    ('mbf_costmap_nav', 'move_base_legacy_relay.py'): Kind(LEFT_OUT, 'our robot has the action move_base itself'),
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
PLACE = 'it says where the robot is, and so does ours'
SENSES = 'it processes data of sensors or wheels, and there are none'
#: what is left out beside robots with goals, and stays beside those that are driven by velocities: they need it
CHOOSES = 'it chooses among velocities, and our robot needs none'
PERSON = 'it waits for a person or a joystick'
_TOOLS = 'it drives a device, and there is none'
_TO_DRIVE = 'it drives the robot, and so does ours'
#: public packages by full name, whose nodes are left out even if they are installed
_KNOWN = {name: Kind(LEFT_OUT, why) for names, why in (
    ('gazebo_ros gazebo gazebo_plugins ros_gz_sim ros_gz_bridge ros_gz_image ros_ign_gazebo ros_ign_bridge stage_ros '
     'stage stdr_server stdr_robot stdr_gui flatland_server mvsim morse_ros webots_ros pedsim_simulator', _SIMULATOR),
    ('controller_manager', _TO_DRIVE), ('twist_mux cmd_vel_mux yocs_cmd_vel_mux yocs_velocity_smoother', CHOOSES),
    ('amcl fake_localization mcl_3dl als_ros robot_pose_ekf robot_localization', PLACE),
    ('gmapping slam_gmapping slam_toolbox slam_karto hector_mapping cartographer_ros rtabmap_ros rtabmap_slam '
     'octomap_server laser_filters laser_scan_matcher laser_assembler pointcloud_to_laserscan depthimage_to_laserscan '
     'ira_laser_tools imu_filter_madgwick imu_complementary_filter', SENSES),
    ('joy teleop_twist_keyboard teleop_twist_joy key_teleop turtlebot_teleop turtlebot3_teleop kobuki_keyop', PERSON),
    ('rosserial_python rosserial_server kobuki_node rplidar_ros urg_node hokuyo_node sick_scan sick_tim lms1xx '
     'realsense2_camera usb_cam velodyne_driver velodyne_pointcloud ydlidar_ros hls_lfcd_lds_driver rosaria',
     _TOOLS)) for name in names.split()}
#: {(package, type): {our topic: the driver's}} of nodes that drive one robot by velocities and tell its odometry
DRIVERS = {
    ('turtlebot3_fake', 'turtlebot3_fake_node'): {},
    ('rosaria', 'RosAria'): {'cmd_vel': '~cmd_vel', 'odom': '~pose'},
    ('p2os_driver', 'p2os_driver'): {'odom': 'pose'},
    ('create_driver', 'create_driver'): {}, ('ca_driver', 'ca_driver'): {},
    ('kobuki_node', 'kobuki_node'): {'cmd_vel': 'mobile_base/commands/velocity'}}
_SPAWNER = re.compile(r'(?:spawn_?(?:model|urdf|sdf|robot|.*_model)|urdf_spawner|delete_model)(?:\.py)?')
#: (expression for 'package/type', why such a node is left out if its package is not here); the first match counts
_GUESSED = [(re.compile('(?:{})/(?:{})'.format(package, kind)), why) for package, kind, why in (
    ('ros_gz.*|ros_ign.*|stdr_.*|morse.*|coppeliasim.*|vrep.*', '.*', _SIMULATOR),
    ('mcl.*', '.*', PLACE),
    ('slam_.*|karto.*|rtabmap.*|.*_slam|laser_.*|pointcloud_.*|depthimage_.*|imu_.*|scan_tools', '.*', SENSES),
    ('teleop.*|.*_teleop', '.*teleop.*|.*key.*|joy.*', PERSON),
    ('rosserial.*|kobuki_.*|sick_.*|velodyne_.*|ydlidar.*|.*_driver|.*_drivers|.*_hardware', '.*', _TOOLS),
)]
#: modules of programs that read a keyboard: without a terminal they crash
KEYBOARD = ('termios', 'tty', 'curses', 'pynput')
#: modules of programs that read a keyboard, a joystick or a device; they confirm a guess
HANDS = (*KEYBOARD, 'pygame', 'serial', 'smbus', 'RPi', 'usb')
_THING = re.compile(r'(?:^|.*[_/-])(?:target|obstacle|box|cube|ball|wall|door|cylinder|sphere|table|shelf|marker|aruco|'
                    r'goal|landmark|person|human|pedestrian|actor|pallet|cone|house|tree)s?(?:[_-]?\d+)?(?:[_/-].*|$)')
_CLOCK = re.compile(r'(?:.*_)?(?:sim_?time|clock)(?:_.*)?(?:\.py)?')
CLOCK = 'it is a clock, and in lockstep only the time master is one'
NO_PROGRAM = 'this program is not installed here'


def kind_of(package, name):
    """Return the Kind of a node's package and type, as far as their names show."""
    known = _BY_NAME.get((package, name)) or _KNOWN.get(package)
    if (package, name) in DRIVERS:
        return Kind(LEFT_OUT, _TO_DRIVE)
    if _SPAWNER.fullmatch(name) and (known is None or known.why == _SIMULATOR):
        return Kind(LEFT_OUT, _SPAWNS, is_guess=known is None)
    if known is not None:
        return known
    for expression, why in _GUESSED:
        if expression.fullmatch('{}/{}'.format(package, name)):
            return Kind(LEFT_OUT, why, is_guess=True)
    return Kind(ELSE)


def is_thing(name):
    """Return whether the name of a model says that it is a thing, and no robot: a target, an obstacle, a box."""
    return _THING.fullmatch(name.lower()) is not None


def is_localizer(package):
    """Return whether a package's nodes say where the robot is, as far as its name shows."""
    return kind_of(package, '').why == PLACE


def looks_like_a_clock(name):
    """Return whether a program is only a clock, as far as its name shows."""
    return _CLOCK.fullmatch(name) is not None


_INCLUDES_A_ROBOT = re.compile(r'.*(?:move_?base|navigation|(?:^|_)nav(?=[_.])|amcl_demo).*\.(?:launch|xml)')
_NO_ROBOT = re.compile(r'.*(?:gmapping|slam|rviz|world|spawn|teleop|gazebo).*')


def stands_for_a_robot(path):
    """Return whether a launch file that is not here starts a move_base, as far as its name shows."""
    name = path.rpartition('/')[2].lower()
    return _INCLUDES_A_ROBOT.fullmatch(name) is not None and _NO_ROBOT.fullmatch(name) is None
