"""Which nodes of a launch file are started, with which programs: not those left out, unseen, or not here."""
import os

from roslaunch.core import Node, is_machine_local
from roslaunch.node_args import NodeParamsException

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

from ..adopting import poses, worlds
from ..loopback import PACKAGE
from . import given, programs, roles

#: programs of a launch prefix that show a node's output in a window
_TERMINALS = frozenset(('xterm', 'gnome-terminal', 'konsole', 'lxterminal', 'mate-terminal', 'terminator', 'urxvt',
                        'uxterm', 'x-terminal-emulator', 'xfce4-terminal'))
_STAND_INS = {('move_base', 'move_base'): 'move_base', ('map_server', 'map_server'): 'map_server'}


def take_away(config, options):
    """Take away the nodes that are not started, and replace programs; return (names left out, lines for the user).

    Programs that are not here are taken away only if the options are tolerant; see refuse_missing().

    :raises ConfigurationError: if the options name a node, or a kind of nodes, that the launch file does not have.
    """
    _check_names(config, options)
    left_out = [roles.name_of(node) for node in config.nodes if roles.name_of(node) in options.leave_out]
    config.nodes[:] = [node for node in config.nodes if roles.name_of(node) not in left_out]
    notes = _without_displays(config, options) + _without_terminals(config, options)
    replaced = _replace(config, options.replace)
    notes += [] if options.is_told else replaced
    _take_real_map_server(config)
    return left_out, notes + (_without_missing(config, options) if options.tolerant else [])


def _check_names(config, options):
    names = [roles.name_of(node) for node in config.nodes]
    for option, asked in (('--participant', options.participant), ('--onlooker', options.onlooker),
                          ('--leave-out', options.leave_out)):
        for name in asked:
            given.check_known(option, name, names)


def _replace(config, replaced):
    notes = []
    for old, new in replaced.items():
        found = [node for node in config.nodes if roles.kind_of(node) == old]
        if not found:
            raise ConfigurationError('--replace {}: the launch file has no node of this kind; it has {}'.format(
                old, ', '.join(sorted({roles.kind_of(node) for node in config.nodes}))))
        for node in found:
            node.package, node.type = new.split('/')
        notes.append('{} {} replaces {}'.format(len(found), new, old))
    return notes


def _take_real_map_server(config):
    """Let the real map_server take part in its own way, if it is installed: ours would become it."""
    real = Node('map_server', 'map_server')
    if roles.program_of(real) is not None:
        for node in config.nodes:
            if roles.kind_of(node) == PACKAGE + '/map_server' and not any(
                    map(worlds.is_world, poses.words_of(node.args))):
                node.package = node.type = 'map_server'


def _without_displays(config, options):
    """Take away the nodes that only show what is, if they cannot be seen. Return lines about them for the user."""
    notes = []
    for node in [one for one in config.nodes if roles.is_display(one) and roles.name_of(one) not in options.kept]:
        why = 'it is not installed here' if roles.program_of(node) is None else options.no_displays and (
            '{}; --onlooker {} starts it'.format(options.no_displays, roles.name_of(node)))
        if why:
            config.nodes.remove(node)
            notes.append('{} is not started: it only displays, and {}'.format(roles.name_of(node), why))
    return notes


def _without_terminals(config, options):
    """Take away launch prefixes that only show a node's output in a window, if it cannot be seen. Return lines.

    If the options are tolerant, those whose program is not here go, too.
    """
    notes = []
    for node in config.nodes:
        why = 'it is not here' if options.tolerant and roles.missing_prefix(node) else ''
        if options.no_displays and _TERMINALS.intersection(map(os.path.basename, roles.prefix_words(node)[:1])):
            why = 'it only displays, and {}'.format(options.no_displays)
        if why:
            notes.append("{} is started without its launch-prefix '{}': {}".format(
                roles.name_of(node), node.launch_prefix.strip(), why))
            node.launch_prefix = None
    return notes


def _without_missing(config, options):
    """Take away the nodes whose programs are not here. Return lines about them for the user."""
    missing = _missing(config, options)
    config.nodes[:] = [node for node in config.nodes if node not in [one for one, _why in missing]]
    return ['{} is left out: {}{}'.format(roles.name_of(node), why, end_of(node)) for node, why in missing]


def end_of(node):
    """Return a text about the end of a run without this node, which the user did not leave out."""
    return '; it is required, so the run would have ended with it: --end-when-idle or --until S ends it' * bool(
        node.required)


def refuse_missing(config, options, left_out=()):
    """Raise ConfigurationError if programs of the configuration are not here; it names all of them.

    ``left_out``: the lines of :func:`take_away`. If no other node is left, they are the error's text.
    """
    if left_out and all(map(roles.is_time_master, config.nodes)):
        raise ConfigurationError('nothing is started, because nothing is left: {}'.format('; '.join(left_out)))
    missing = ['{}: {}'.format(roles.name_of(node), why) for node, why in _missing(config, options)]
    if missing:
        raise ConfigurationError(
            'nothing is started, because programs are not here: {}. Build their packages and source the workspace; '
            'or --leave-out NODE leaves out a node, and --tolerant all of these'.format('; '.join(missing)))


def _missing(config, options):
    """Return [(node, why)] of the nodes of this computer whose programs cannot be started here.

    A participant needs no interpreter of its own: the launcher starts it.
    """
    found = []
    for node in config.nodes:
        if is_machine_local(node.machine):
            try:
                roles.command_of(node)
            except (NodeParamsException, ValueError) as error:
                if not _is_for_launcher(node, options):
                    found.append((node, _in_words(node, error)))
    return found


def _is_for_launcher(node, options):
    path = roles.program_of(node)
    return path is not None and programs.missing_interpreter(path) and roles.role_of(
        node, options.participant, options.onlooker, options.no_respawn).takes_part


def _in_words(node, error):
    if isinstance(error, ValueError):
        return 'its args {} are no list of words: {}'.format(shown(node.args), error)
    if roles.program_of(node) is not None:
        return str(error)
    own = _STAND_INS.get((node.package, node.type))
    return 'there is no program {}{}'.format(roles.kind_of(node), ' (ours: --replace {}={}/{})'.format(
        roles.kind_of(node), PACKAGE, own) if own else '')
