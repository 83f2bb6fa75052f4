"""Who of a launch file's nodes takes part in lockstep, and who is left to look on, and why."""
import os
import shlex
from typing import NamedTuple

from rosgraph.names import ns_join
from roslib import packages

from ..lockstep.programs import command_line, recorders
from ..lockstep.programs.shell_scripts import is_shell_word
from ..loopback import PACKAGE
from . import programs

#: the program whose node takes part for a script that starts runs
DEPUTY = 'lockstep_series'
_BY_ITSELF = ('move_base', 'fleet', 'task_server', 'task_source', 'dispatcher', 'mapf_drive',
              'move_base_abstract_actionserver', 'soil_coordinator', 'end_at_message', 'message_recorder',
              'property_monitor', DEPUTY)
#: own nodes that are done when the run is over: what they know is in the event log, or written already
_WITHOUT_LAST_WORDS = ('move_base', 'fleet', 'task_server', 'task_source', 'dispatcher', 'mapf_drive',
                       'move_base_abstract_actionserver', 'end_at_message', 'message_recorder', 'property_monitor',
                       DEPUTY)
_LOOK_ON = {
    'rviz': 'it only displays',
    'rqt_gui': 'it only displays', 'image_view': 'it only displays', 'plotjuggler': 'it only displays'}
_CLOCKS = (('stage_ros', 'stageros'), ('gazebo_ros', 'gazebo'), ('gazebo_ros', 'gzserver'), ('gazebo_ros', 'debug'),
           ('flatland_server', 'flatland_server'), ('mvsim', 'mvsim_node'), ('mvsim', 'mvsim'))
_STAND_INS = {('move_base', 'move_base'): 'move_base', ('map_server', 'map_server'): 'map_server'}
_DEBUGGERS = ('gdb', 'valgrind', 'strace', 'ltrace', 'perf', 'rr', 'lldb', 'ddd')
_OWN_PREFIX = 'move_base_abstract lockstep'


#: the original package's time master: whatever its node is to be called, it is ours, and so /time_master
ORIGINAL_TIME_MASTER = 'sim_time_controller'


class Role(NamedTuple):
    """What a node does in the run. ``kind``: 'rospy', 'roscpp' or 'itself' takes part; None looks on, and why."""

    name: str
    kind: str
    why: str
    records: bool = False  # whether it writes bags, as far as its program shows it

    @property
    def takes_part(self):
        """Whether simulated time waits for it."""
        return self.kind is not None


def name_of(node):
    """Return the full name of a roslaunch Node."""
    return ns_join(node.namespace, node.name or node.type)


def is_time_master(node):
    """Whether a roslaunch Node is our time master."""
    return node.package == PACKAGE and node.type in ('time_master', ORIGINAL_TIME_MASTER)


def has_clock(node, kept=()):
    """Whether a node publishes /clock, as far as is known by its kind, or by the text of a Python program.

    :param kept: full names of nodes whose text is not asked.
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

    :param forced, kept_out: full names of nodes that shall take part, or look on, whatever they are.
    """
    kind, why = _kind(node, name_of(node), forced, kept_out, with_respawned)
    return Role(name_of(node), kind, why, recorders.is_recorder(node) or _starts_recorder(node))


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
        return None, 'there is no program {}'.format(_without(node))
    kind, why = programs.kind_of(path)
    return ('rospy' if kind is None and name in forced else kind), why


def _starts_recorder(node):
    path = None if node.package == PACKAGE else program_of(node)
    return path is not None and recorders.starts_recorder(path)


def _is_by_itself(node):
    return node.package == PACKAGE and node.type in _BY_ITSELF or _OWN_PREFIX in (node.launch_prefix or '')


def _outside(node, with_respawned):
    """Return why a node cannot take part whatever its program is, or None."""
    if node.package in _LOOK_ON:
        return _LOOK_ON[node.package]
    if (node.package, node.type) == ('rosbag', 'play'):
        return 'it only plays'
    if node.machine_name and node.machine_name not in ('localhost', 'local'):
        return "it belongs on the machine '{}'".format(node.machine_name)
    if node.respawn and not with_respawned and not _is_by_itself(node):
        return 'it is respawned (--no-respawn lets it take part, and be started once)'
    words = shlex.split(node.launch_prefix or '')
    if words and os.path.basename(words[0]) in _DEBUGGERS:
        return "it runs under '{}'".format(words[0])
    return None


def has_last_words(node):
    """Return whether a roslaunch Node may have something to do once the run is over, and is not to be killed then."""
    return not (node.package == PACKAGE and node.type in _WITHOUT_LAST_WORDS)


def is_shell(node):
    """Return whether a roslaunch Node's process is a shell that starts the program."""
    prefix = shlex.split(node.launch_prefix or '')
    path = None if node.package == PACKAGE else program_of(node)
    return bool(prefix) and is_shell_word(prefix[0]) or (
        path is not None and command_line.kind_of(path) == 'shell')


def _without(node):
    """Return the kind of a node whose program is not there, and how ours is started in its place, if there is one."""
    kind, own = '{}/{}'.format(node.package, node.type), _STAND_INS.get((node.package, node.type))
    return '{}; ours: --replace {}={}/{}'.format(kind, kind, PACKAGE, own) if own else kind


def is_nodelet_loader(node):
    """Return whether a roslaunch Node loads a nodelet into a manager: it sleeps by the wall, and runs nobody's code."""
    return (node.package, node.type) == ('nodelet', 'nodelet') and (node.args or '').split()[:1] == ['load']


def program_of(node):
    """Return the path of a roslaunch Node's program, or None."""
    try:
        found = packages.find_node(node.package, node.type)
    except Exception:  # roslaunch says it in its own words when it starts the node
        return None
    return found[0] if found else None


def prefix_of(node, launcher):
    """Return the launch prefix with the words of our launcher in it: before a Python, behind anything else."""
    words = shlex.split(node.launch_prefix or '')
    if is_nodelet_loader(node):
        launcher = [*launcher, '--sleep', 'simulated']
    at = next((k for k, word in enumerate(words) if os.path.basename(word).startswith('python')), len(words))
    return ' '.join(shlex.quote(word) for word in [*words[:at], *launcher, *words[at:]])
