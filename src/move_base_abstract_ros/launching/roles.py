"""Decide which nodes of a launch file take part in lockstep, which look on, and why."""
import os
import re
import shlex
import shutil
from typing import NamedTuple

from rosgraph.names import ns_join
from roslaunch.core import RLException, is_machine_local
from roslaunch.node_args import NodeParamsException, create_local_process_args
from roslib import packages

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

from ..adopting.poses import name_of
from ..lockstep.programs import command_line, recorders
from ..lockstep.programs.shell_scripts import is_shell_word
from ..loopback import PACKAGE
from . import programs

_LAUNCHER, _OWN_NODE = 'lockstep', '--own'
#: the deputy's module: the node that takes part for a script that starts runs
DEPUTY = 'move_base_abstract_ros.nodes.series_run.deputy'
_BY_ITSELF = ('move_base', 'fleet', 'task_server', 'task_source', 'dispatcher', 'mapf_drive',
              'move_base_abstract_actionserver', 'soil_coordinator', 'end_at_message', 'message_recorder',
              'property_monitor', 'deputy', 'map_server', 'velocity_robot')
#: the one of them with something to do when the run is over; results of the others are in the log, or written already
_WITH_LAST_WORDS = 'soil_coordinator'
#: nodes of this package that only show what is, and why its other programs do not take part
_SHOWING, _NO_NODE = ('radio_markers', 'why'), 'it is a command of this package, and no node'
#: packages whose programs, or some of whose programs, only show what is on a screen
_DISPLAYS = {'rviz': None, 'rqt_gui': None, 'plotjuggler': None,
            'image_view': ('image_view', 'disparity_view', 'stereo_view')}
_OF_RQT, _RQT = re.compile('rqt(?:_.*)?'), 'rqt_gui'
_CLOCKS = (('stage_ros', 'stageros'), ('gazebo_ros', 'gazebo'), ('gazebo_ros', 'gzserver'), ('gazebo_ros', 'debug'),
           ('flatland_server', 'flatland_server'), ('mvsim', 'mvsim_node'), ('mvsim', 'mvsim'))
_DEBUGGERS = ('gdb', 'valgrind', 'strace', 'ltrace', 'perf', 'rr', 'lldb', 'ddd')
_OWN_PREFIX = 'move_base_abstract lockstep'
#: the program in the text of a shell, if other words follow before its arguments: $0 WORD $@
_WORDS_BEFORE = re.compile(r'"?\$(?:0|\{0\})"?(?=[ \t]+(?!"?\$[@*])[^;&|\n]*\$[@*])')


#: the original package's time master. Whatever its node is called in the file, it becomes our /time_master
ORIGINAL_TIME_MASTER = 'sim_time_controller'


class Role(NamedTuple):
    """The role of a node in the run.

    ``kind``: 'rospy', 'roscpp' or 'itself' (a node of this package, or one that the file starts by our launcher) if it
    takes part; None if it looks on. ``why``: the reason why it looks on.
    """

    name: str
    kind: str
    why: str
    records: bool = False  # whether it writes bags, as far as its program shows
    may_provide: bool = False  # whether it looks on, and may have something for participants from the start on

    @property
    def takes_part(self):
        """Whether the node is a participant: simulated time waits for it."""
        return self.kind is not None


def kind_of(node):
    """Return the kind of a roslaunch Node, PACKAGE/TYPE."""
    return '{}/{}'.format(node.package, node.type)


def is_time_master(node):
    """Return whether a roslaunch Node is our time master."""
    return node.package == PACKAGE and node.type in ('time_master', ORIGINAL_TIME_MASTER)


def has_clock(node, kept=()):
    """Return whether a node publishes /clock, as far as its kind or the text of its Python program shows.

    :param kept: full names of nodes whose text is not searched.
    """
    if (node.package, node.type) in _CLOCKS or (
            (node.package, node.type) == ('rosbag', 'play') and '--clock' in (node.args or '').split()):
        return True
    if node.package == PACKAGE or name_of(node) in kept or any(
            ns_join('/', old) == '/clock' for old, _new in node.remap_args):
        return False
    path = program_of(node)
    return path is not None and programs.publishes_clock(path)


def role_of(node, forced=(), kept_out=(), with_respawned=False):
    """Return the Role of a roslaunch Node.

    :param forced, kept_out: full names of nodes that take part, or look on, because the user asks for it.
    :param with_respawned: whether nodes with respawn take part.
    """
    kind, why = _kind(node, name_of(node), forced, kept_out, with_respawned)
    return Role(name_of(node), kind, why, recorders.is_recorder(node) or _starts_recorder(node),
                kind is None and _may_provide(node))


def _kind(node, name, forced, kept_out, with_respawned):
    if name in kept_out:
        return None, 'as it was asked for'
    reason = None if name in forced else _outside(node, with_respawned)
    if reason:
        return None, reason
    if _is_by_itself(node):
        return 'itself', ''
    path = program_of(node)
    if path is None:
        return None, 'there is no program {}'.format(kind_of(node))
    kind, why = programs.kind_of(path)
    if kind is None and node.package == PACKAGE:
        why = _NO_NODE
    return ('rospy' if kind is None and name in forced else kind), why


def _is_own_display(node):
    return node.package == PACKAGE and _own_type(node) in _SHOWING


def is_display(node):
    """Return whether a roslaunch Node only shows what is on a screen: RViz, rqt, a viewer of images."""
    if node.package in _DISPLAYS:
        return node.type in (_DISPLAYS[node.package] or [node.type])
    path = program_of(node) if _OF_RQT.fullmatch(node.package) else ''
    return path is None or path != '' and programs.imports_one_of(path, (_RQT,))


def _may_provide(node):
    if _is_by_itself(node):
        return True
    path = None if is_display(node) or _is_own_display(node) else program_of(node)
    return path is not None and not recorders.is_recorder(node) and programs.kind_of(path)[0] is not None


def _starts_recorder(node):
    path = None if node.package == PACKAGE else program_of(node)
    return path is not None and recorders.starts_recorder(path)


def _is_by_itself(node):
    return node.package == PACKAGE and _own_type(node) in _BY_ITSELF or _OWN_PREFIX in (node.launch_prefix or '')


def _outside(node, with_respawned):
    """Return why a node cannot take part, whatever its program is, or None."""
    if is_display(node) or _is_own_display(node):
        return 'it only displays'
    if (node.package, node.type) == ('rosbag', 'play'):
        return 'it only plays'
    if node.machine_name and node.machine_name not in ('localhost', 'local') and not _is_here(node.machine):
        return "it belongs on the machine '{}'".format(node.machine_name)
    if node.respawn and not with_respawned and not _is_by_itself(node):
        return 'it is respawned (--no-respawn lets it take part, and be started once)'
    words = prefix_words(node)
    if words and os.path.basename(words[0]) in _DEBUGGERS:
        return "it runs under '{}'".format(words[0])
    return None


def _is_here(machine):
    """Return whether a roslaunch Machine is this computer. If its address cannot be found, that is an error later."""
    try:
        return is_machine_local(machine)
    except RLException:
        return False


def has_last_words(node):
    """Return whether a roslaunch Node may have something to do after the run, so that it must not be killed then."""
    return node.package != PACKAGE or _own_type(node) not in _BY_ITSELF or _own_type(node) == _WITH_LAST_WORDS


def is_deputy(node):
    """Return whether a roslaunch Node takes part for a script. It ends when the script leaves the run, as it should."""
    return node.package == PACKAGE and _own_type(node) == DEPUTY.rpartition('.')[2]


def _own_type(node):
    """Return the type of one of our nodes, or the last part of the module's name if it is `lockstep --own MODULE`."""
    words = (node.args or '').split()
    if node.type != _LAUNCHER or words[:1] != [_OWN_NODE] or len(words) < 2:
        return node.type
    return re.sub('_node$', '', words[1].rpartition('.')[2])


def is_shell(node):
    """Return whether a roslaunch Node's process is a shell that starts the program."""
    prefix = prefix_words(node)
    path = None if node.package == PACKAGE else program_of(node)
    return bool(prefix) and is_shell_word(prefix[0]) or (
        path is not None and command_line.kind_of(path) == 'shell')


def is_nodelet_loader(node):
    """Return whether a roslaunch Node loads a nodelet into a manager. It only sleeps, by the wall clock."""
    return (node.package, node.type) == ('nodelet', 'nodelet') and (node.args or '').split()[:1] == ['load']


def program_of(node):
    """Return the path of a roslaunch Node's program, or None."""
    return next(iter(_programs_of(node)), None)


def _programs_of(node):
    try:
        return packages.find_node(node.package, node.type)
    except Exception:  # roslaunch reports the error when it starts the node
        return []


def prefix_words(node):
    """Return the words of a roslaunch Node's launch prefix.

    :raises ConfigurationError: if a quote in it is open.
    """
    try:
        return shlex.split(node.launch_prefix or '')
    except ValueError as fault:
        raise ConfigurationError('{}: launch-prefix: got {}, which is not a list of words: {} ({})'.format(
            name_of(node), shown(node.launch_prefix), fault, node.filename or 'added')) from None


def missing_prefix(node):
    """Return the program of a roslaunch Node's launch prefix, or '' if it is here. Python is our launcher."""
    name = next(iter(prefix_words(node)), '')
    is_here = os.path.basename(name).startswith('python') or 'PATH' in dict(node.env_args) or shutil.which(name)
    return name if name and not is_here else ''


def command_of(node):
    """Return the words of the command that starts a roslaunch Node.

    :raises NodeParamsException, ValueError: if its program is not here, or the interpreter that the program names, or
        that of its launch prefix.
    """
    words = create_local_process_args(node, node.machine)
    if missing_prefix(node):
        raise NodeParamsException("its launch-prefix starts '{}', which is not here".format(missing_prefix(node)))
    interpreter = programs.missing_interpreter(words[0])
    if interpreter and 'PATH' not in dict(node.env_args):
        raise NodeParamsException('{} is a program for {}, which is not here'.format(words[0], interpreter))
    return words


def folder_of(node, words, launcher):
    """Return the working folder of a roslaunch Node with cwd="node": that of the first of the words in its file.

    ``words``: of its command, which may begin with our launcher. A first word without a folder (`nice`), with which
    roslaunch starts no node, counts as the program.
    """
    first = words[1 + command_line.own_words(words[1:])] if words[0] == launcher else words[0]
    return os.path.dirname(first) or os.path.dirname(program_of(node))


def choice_of_program(node):
    """Return a line for the user if a package has several programs of a node's name, otherwise ''.

    roslaunch starts the first one that it finds. If none is installed in lib/PACKAGE, this depends on the order of
    folders on the disk.
    """
    found = [] if node.package == PACKAGE else programs.different(_programs_of(node))
    if len(found) < 2 or os.path.dirname(found[0]).endswith(os.path.join(os.sep, 'lib', node.package)):
        return ''
    return "the package '{}' has {} programs '{}'; {} is {}, as roslaunch would start it, and not {}. On another " \
           'disk it may be another one'.format(node.package, len(found), node.type, name_of(node), found[0],
                                               ' or '.join(found[1:]))


def prefix_of(node, launcher):
    """Return the node's launch prefix with the words of our launcher in it: before a Python, otherwise at the end.

    In a shell's text that puts words between the program and its arguments, it stands before the program.
    """
    words = prefix_words(node)
    if is_nodelet_loader(node):
        launcher = [*launcher, '--sleep', 'simulated']
    if words and is_shell_word(words[0]) and _WORDS_BEFORE.search(words[-1]):
        ours = ' '.join(map(shlex.quote, launcher))
        text = _WORDS_BEFORE.sub(lambda found: '{} {}'.format(ours, found.group()), words[-1])
        return ' '.join(map(shlex.quote, [*words[:-1], text]))
    at = next((k for k, word in enumerate(words) if os.path.basename(word).startswith('python')), len(words))
    return ' '.join(shlex.quote(word) for word in [*words[:at], *launcher, *words[at:]])
