"""The node ``move_base_abstract_actionserver``: one robot, configured by the original package's seven arguments."""
import sys

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.kinds import as_number
from move_base_abstract.common.ros_names import NAMESPACE_RULE, is_namespace
from move_base_abstract.common.shown import shown_text
from move_base_abstract_ros.backends import STAGE
from move_base_abstract_ros.robot.names import RobotNames
from move_base_abstract_ros.robot.robot_node import run


def _namespace(text):
    if not is_namespace(text):
        raise ValueError
    return text


_ARGUMENTS = (('robot_name', _namespace), ('backend', str), ('max_speed', as_number), ('start_x', as_number),
              ('start_y', as_number), ('pose_update_freq', as_number), ('acceleration', as_number))
#: parameters that say where the global frame lies in Stage's world; one of them is enough
STAGE_PLACE = ('stage_offset_x', 'stage_offset_y', 'stage_offset_yaw', 'stage_world_frame')
ORIGINAL_OFFSET = (-162.0, -110.0)  # m, as written in the source of the original
_USAGE = ('usage: move_base_abstract_actionserver '
          '[robot_name [simulator [max_speed [x [y [pose_update_freq [acceleration]]]]]]]')


def main():
    """Run the node until ROS shuts down; exits with 1 if an argument or a parameter cannot be used."""
    arguments = rospy.myargv(sys.argv)[1:]
    if arguments and arguments[0] in ('-h', '--help'):
        print('{}\n{}'.format(__doc__, _USAGE))
        return
    try:
        values = read_arguments(arguments)
    except ConfigurationError as error:
        sys.exit('move_base_abstract_actionserver: {}'.format(error))
    run('move_base_abstract_actionserver', lambda: _describe(values))


def _describe(values):
    """Return (names, overrides, tf prefix) of the robot. The node must have been initialised: it knows its namespace.

    As in the original, only the namespace decides the names of the robot's topics and frames.
    """
    _tell(values.pop('robot_name', ''), values.get('backend'))
    names = RobotNames(rospy.get_namespace())
    return names, values, names.namespace.strip('/') or None


def _tell(robot_name, backend):
    namespace = rospy.get_namespace().strip('/')
    if robot_name.strip('/') != namespace:
        rospy.loginfo("%s: robot_name is '%s'; topics and frames are named after the namespace, '/%s', as in the "
                      'original', rospy.get_name(), robot_name, namespace)
    if backend in STAGE and not any(rospy.has_param('~' + name) for name in STAGE_PLACE):
        rospy.logwarn('%s: the original adds %g, %g to the positions that it sends to Stage; this node adds nothing: '
                      'set ~stage_offset_x and ~stage_offset_y, to these or to 0', rospy.get_name(), *ORIGINAL_OFFSET)


def read_arguments(arguments):
    """Return {parameter: value} of the positional ``arguments``, of which there are at most seven.

    :raises ConfigurationError: if there are more, or if an argument that must be a number is none.
    """
    if len(arguments) > len(_ARGUMENTS):
        raise ConfigurationError('got {} arguments; allowed: at most {}. {}'.format(
            len(arguments), len(_ARGUMENTS), _USAGE))
    values = {}
    for (name, convert), argument in zip(_ARGUMENTS, arguments):
        try:
            values[name] = convert(argument)
        except ValueError:
            raise ConfigurationError("argument {}: got '{}'; allowed: {}. {}".format(
                name, shown_text(argument), 'a number' if convert is as_number else NAMESPACE_RULE, _USAGE)) from None
    return values
