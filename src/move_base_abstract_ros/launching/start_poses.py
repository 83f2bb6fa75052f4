"""Report the places of robots in a launch file that no node reads, so that none is lost silently."""
import re

from ..adopting import poses, robots
from ..loopback import PACKAGE
from . import programs, roles

PLACED = ('start_x', 'start_y', 'start_yaw')
_IN_STAGE = ('stage_offset_x', 'stage_offset_y', 'stage_offset_yaw', 'stage_world_frame')
_WITH_PLACE = 4  # arguments of move_base_abstract_actionserver: with fewer, no place is given
_COMMAND = b'cmd_pose'
_PLACING = (b'set_robot_pose', b'initialpose', b'set_pose', _COMMAND)  # what a robot listens to
_ARGUMENT = re.compile('_(start_x|start_y|start_yaw):=(.+)')


def said_by(config):
    """Return (Hints, Stages) of a launch file's configuration. Call it before nodes are taken away."""
    return poses.hints(config)


def notes_of(config, said, with_hints=True):
    """Return lines for the user about the places of the robots of a run.

    :param said: the result of said_by(); with_hints: whether to report places that no node reads, too.
    """
    ours = [node for node in config.nodes if node.package == PACKAGE and node.type in robots.OWN]
    values = {key: param.value for key, param in config.params.items()}
    lost = [node for node in ours if not own_place(roles.name_of(node), node, values)]
    notes, told = [], set()
    found, _unused = robots.starts_of(robots.robots_of(config, []), *said)
    for start in found if with_hints else ():
        if start.hint is not None and any(start.pose) and start.robot.name in map(roles.name_of, lost):
            told.add(start.robot.name)
            notes.append('{0} starts at (0, 0, 0), and no node reads {1}: --start {0}={2} starts it there, --adopt '
                         'does so for all'.format(start.robot.name, start.hint.shown, shown(start.pose)))
    names = [roles.name_of(node) for node in lost if roles.name_of(node) not in told]
    if len(names) > 1 and with_hints:
        notes.append('{} start at one place, (0, 0){}: --start NODE=X,Y,YAW sets another'.format(
            ' and '.join(names), unless_placed(config.nodes)))
    return notes + _commands(config, ours)


def shown(pose):
    """Return a pose in the form that --start takes, with up to six digits."""
    return ','.join('{:g}'.format(value) for value in pose)


def own_place(name, node, values, starts=None):
    """Return what the robot ``name`` is told of its start, {name in PLACED: m, m or rad}; empty: nothing.

    :param node: its roslaunch Node, or None; values: {full name: value} of all parameters; starts: {name: (x, y, yaw)}
        of the user.
    """
    found = {key: values['{}/{}'.format(name, key)] for key in PLACED if '{}/{}'.format(name, key) in values}
    words = poses.words_of(node.args) if node is not None else []
    found.update(match.groups() for match in map(_ARGUMENT.fullmatch, words) if match)
    plain = [word for word in words if ':=' not in word]
    if node is not None and node.type == robots.OWN[1] and len(plain) >= _WITH_PLACE:
        found.update(zip(PLACED, plain[_WITH_PLACE - 1:_WITH_PLACE + 1]))
    found.update(zip(PLACED, (starts or {}).get(name, ())))
    return {key: poses.number_of(value) or 0.0 for key, value in found.items()}  # the robot refuses what is no number


def unless_placed(nodes, namespace=''):
    """Return ', unless NODE sets another place ...' if a node may place robots later, otherwise ''.

    Of several nodes the first one in the robot's ``namespace`` is named.
    """
    for node in sorted(nodes, key=lambda node: node.namespace != namespace):
        path = roles.program_of(node) if node.package != PACKAGE and roles.role_of(node).takes_part else None
        word = next((word for word in _PLACING if path is not None and (
            word in (node.args or '').encode() or programs.mentions(path, word))), None)
        if word:
            return ', unless {} sets another place (it names {})'.format(roles.name_of(node), word.decode())
    return ''


def _commands(config, ours):
    """Return lines about programs that may place robots in Stage's world, if nothing says where the map is there."""
    lost = [roles.name_of(node) for node in ours
            if not any('{}/{}'.format(roles.name_of(node), key) in config.params for key in _IN_STAGE)]
    senders = [roles.name_of(node) for node in config.nodes if node.package != PACKAGE and _names_command(node)]
    if not lost or not senders:
        return []
    return ["{} may place robots by cmd_pose, in Stage's world; for {} nothing says where the map's frame lies there, "
            "so that places are taken in the map's frame: --param {}/stage_offset_x=X, and stage_offset_y, set it (0 "
            'if both frames are the same; the original package adds -162 and -110)'.format(
                ' and '.join(senders), ' and '.join(lost), lost[0])]


def _names_command(node):
    path = roles.program_of(node)
    return path is not None and programs.mentions(path, _COMMAND)
