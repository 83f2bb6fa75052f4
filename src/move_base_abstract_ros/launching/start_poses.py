"""Report the places of robots in a launch file that no node reads, so that none is lost silently."""
from ..adopting import poses, robots
from ..loopback import PACKAGE
from . import programs, roles

PLACED = ('start_x', 'start_y', 'start_yaw')
_IN_STAGE = ('stage_offset_x', 'stage_offset_y', 'stage_offset_yaw', 'stage_world_frame')
_WITH_PLACE = 4  # arguments of move_base_abstract_actionserver: with fewer, no place is given
_COMMAND = b'cmd_pose'


def said_by(config):
    """Return (Hints, Stages) of a launch file's configuration. Call it before nodes are taken away."""
    return poses.hints(config)


def notes_of(config, said, with_hints=True):
    """Return lines for the user about the places of the robots of a run.

    :param said: the result of said_by(); with_hints: whether to report places that no node reads, too.
    """
    ours = [node for node in config.nodes if node.package == PACKAGE and node.type in robots.OWN]
    lost = [node for node in ours if not is_placed(config, node)]
    notes, told = [], set()
    found, _unused = robots.starts_of(robots.robots_of(config, []), *said)
    for start in found if with_hints else ():
        if start.hint is not None and any(start.pose) and start.robot.name in map(roles.name_of, lost):
            told.add(start.robot.name)
            notes.append('{0} starts at (0, 0, 0), and no node reads {1}: --start {0}={2} starts it there, --adopt '
                         'does so for all'.format(start.robot.name, start.hint.shown, shown(start.pose)))
    names = [roles.name_of(node) for node in lost if roles.name_of(node) not in told]
    if len(names) > 1 and with_hints:
        notes.append('{} start at one place, (0, 0): --start NODE=X,Y,YAW sets another'.format(' and '.join(names)))
    return notes + _commands(config, ours)


def shown(pose):
    """Return a pose in the form that --start takes, with up to six digits."""
    return ','.join('{:g}'.format(value) for value in pose)


def is_placed(config, node):
    """Return whether a parameter or an argument gives the start of one of our robots, a roslaunch Node."""
    name = roles.name_of(node)
    return any('{}/{}'.format(name, key) in config.params for key in PLACED) or (
        node.type == robots.OWN[1] and len(poses.words_of(node.args)) >= _WITH_PLACE)


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
