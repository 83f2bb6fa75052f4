"""What a launch file says of the places of its robots and nobody reads: told, so that none is lost in silence."""
from ..adopting import poses, robots
from ..loopback import PACKAGE
from . import programs, roles

_PLACED = ('start_x', 'start_y', 'start_yaw')
_IN_STAGE = ('stage_offset_x', 'stage_offset_y', 'stage_offset_yaw', 'stage_world_frame')
_WITH_PLACE = 4  # arguments of move_base_abstract_actionserver: fewer say no place
_COMMAND = b'cmd_pose'


def said_by(config):
    """Return what is said of places, while all nodes of the launch file are still there."""
    return poses.hints(config)


def notes_of(config, said, with_hints=True):
    """Return what is to be told of the robots of a run, as texts.

    :param said: of said_by(); with_hints: whether to tell of places that nobody reads, too.
    """
    ours = [node for node in config.nodes if node.package == PACKAGE and node.type in robots.OWN]
    lost = [node for node in ours if not is_placed(config, node)]
    notes, told = [], set()
    found, _unused = robots.starts_of(robots.robots_of(config, []), *said)
    for start in found if with_hints else ():
        if start.hint is not None and any(start.pose) and start.robot.name in map(roles.name_of, lost):
            told.add(start.robot.name)
            notes.append('{0} starts at (0, 0, 0), and nobody reads {1}: --start {0}={2} has it there, --adopt all of '
                         'them'.format(start.robot.name, start.hint.shown, shown(start.pose)))
    names = [roles.name_of(node) for node in lost if roles.name_of(node) not in told]
    if len(names) > 1 and with_hints:
        notes.append('{} start at one place, (0, 0): --start NODE=X,Y,YAW says another'.format(' and '.join(names)))
    return notes + _commands(config, ours)


def shown(pose):
    """Return a pose as --start takes it, in few digits."""
    return ','.join('{:g}'.format(value) for value in pose)


def is_placed(config, node):
    """Return whether anything says where one of our robots starts."""
    name = roles.name_of(node)
    return any('{}/{}'.format(name, key) in config.params for key in _PLACED) or (
        node.type == robots.OWN[1] and len(poses.words_of(node.args)) >= _WITH_PLACE)


def _commands(config, ours):
    """Tell of programs that place robots in Stage's world, where nobody says where the map's frame lies there."""
    lost = [roles.name_of(node) for node in ours
            if not any('{}/{}'.format(roles.name_of(node), key) in config.params for key in _IN_STAGE)]
    senders = [roles.name_of(node) for node in config.nodes if node.package != PACKAGE and _names_command(node)]
    if not lost or not senders:
        return []
    return ["{} may place robots by cmd_pose, in Stage's world; for {} nothing says where the map's frame lies there, "
            "and it is taken as the map's: --param {}/stage_offset_x=X, and stage_offset_y, say it (0 if it is; the "
            'original package adds -162 and -110)'.format(' and '.join(senders), ' and '.join(lost), lost[0])]


def _names_command(node):
    path = roles.program_of(node)
    return path is not None and programs.mentions(path, _COMMAND)
