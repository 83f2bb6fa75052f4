"""Adapt a launch file of others by rule (`--adopt`). The result is a set of options that a user could have given."""
import os
import shlex
from dataclasses import replace
from typing import NamedTuple

from roslaunch.core import Node

from move_base_abstract.common.errors import ConfigurationError

from ..adopting import kinds, poses, reading, robots, served, unrolled
from ..lockstep.code import older
from ..loopback import PACKAGE
from ..process.own_parameters import INHERITED
from . import given, look_ups, programs, roles, start_poses, started, velocities, what_counts

_STAGE_ARGUMENT = 1  # of move_base_abstract_actionserver: the simulator
_OWN_CLOCKS = ('stage_ros', 'stage', 'gazebo')
_READ_ELSEWHERE = ('lockstep_rank', 'lockstep_charge', 'play_output', 'events_only', 'log_motion')
_SAME_PLACE = 0.01  # m


class Adopted(NamedTuple):
    """The result of :func:`adopt`.

    ``options``: the given ones, and those that the rules add. ``done``, ``remarks``, ``problems``: texts for the user.
    If there is a problem, the file cannot run. ``unread``: lines, the parameters of the file that have no effect.
    """

    options: object
    done: tuple
    remarks: tuple
    problems: tuple
    unread: tuple


def adopt(config, options, read_settings):
    """Return an Adopted for a roslaunch configuration that a tolerant loader has read.

    ``options``: what the user asks for, which takes precedence over the rules. ``read_settings``: gets the parameters
    and the name of each of our robots, and raises ConfigurationError if such a robot would end with an error.
    """
    return _Adoption(config, options, read_settings).adopted()


def adopted(config, options, read_settings):
    """Return the options with the changes that the configuration needs.

    :raises ConfigurationError: if something in the configuration cannot work.
    """
    found = adopt(config, options, read_settings)
    if found.problems:
        raise ConfigurationError('adopt: ' + '; '.join(found.problems))
    return found.options


class _Adoption:
    def __init__(self, config, options, read_settings):
        self.config = config
        self.options = options
        self.read_settings = read_settings
        self.done, self.remarks, self.problems = [], [], []
        self.left_out, self.added, self.arguments, self.param = [], {}, {}, {}
        self.older = {}  # {package: the place that only Python 2 reads, or ''}
        self.floors = {}  # {path of a world of Stage: the map_server of its floor plan}
        self.settings = {}  # {name: settings} of our robots
        self.hints, self.stages = poses.hints(config)
        self.robots = robots.robots_of(config, self.hints, [
            name for name, added in options.add.items()
            if given.split(added)[0] == PACKAGE and given.split(added)[1] in (robots.OWN[0], robots.OWN[2])],
            options.real_navigation)
        self.is_driven = any(robot.is_driven for robot in self.robots)

    def adopted(self):
        """Apply the rules to the nodes, the robots and what is missing, and return an Adopted."""
        self.starts = self._starts()
        self._say_missing()
        replaced = self._nodes()
        self._robots()
        self._add_maps()
        what_counts.set_frames(self)
        kept = [node for node in self.config.nodes if not self.is_out(node)]
        velocities.prepare(self, kept)
        what_counts.add_floor(self, kept)
        what_counts.use_maps(self, kept)
        if not self.is_driven or velocities.tells_place(self):
            what_counts.set_stage_offsets(self)
        self._clocks(kept)
        self._fatal(kept)
        asked = self.options
        options = velocities.gathered(self, replace(
            asked, adopt=False, tolerant=True, leave_out=(*asked.leave_out, *self.left_out),
            replace={**asked.replace, **replaced}, add={**asked.add, **self.added},
            node_args={**asked.node_args, **self.arguments}, param={**self.param, **asked.param},
            start={**asked.start, **self.starts}, is_told=True, real_navigation=False,
            python2=(*asked.python2, *(name for name, why in self.older.items() if why and name not in asked.python2)),
            no_respawn=asked.no_respawn or any(
                node.respawn and (_kind_of(node).word == kinds.ELSE or self._stays_as_it_is(node, _kind_of(node)))
                for node in kept)))
        return Adopted(options, *map(tuple, (self.done, self.remarks, self.problems, what_counts.unread(self))))

    def is_out(self, node):
        return roles.name_of(node) in (*self.left_out, *self.options.leave_out)

    def is_kept(self, node):
        return roles.name_of(node) in self.options.kept

    def _say_missing(self):
        for name, folder in sorted(getattr(self.config, 'taken', {}).items()):
            self.done.append('the package {} is taken from {}'.format(name, folder))
        grouped = {}
        for one in getattr(self.config, 'missing', ()):
            grouped.setdefault((one.kind, one.name), []).append(one.place)
        for (kind, name), places in grouped.items():
            more = ', and {} more'.format(len(places) - 1) * (len(places) > 1)
            self.remarks.append('{} ({}{})'.format(reading.told(kind, name), places[0], more))

    def _nodes(self):
        """Decide for each node whether it stays. Return the replaced kinds, {old: new}, each PACKAGE/TYPE."""
        replaced = {}
        for node in self.config.nodes:
            if self.is_out(node) or self.is_kept(node) or node.package == PACKAGE:
                continue
            name, kind = roles.kind_of(node), _kind_of(node)
            if name in self.options.replace:
                continue
            if self._stays_as_it_is(node, kind):
                self._look_for_program(node, kinds.Kind(kinds.ELSE))
            elif kind.word == kinds.ROBOT or kind.word == kinds.MAP and self._serves_map(node):
                if kind.word == kinds.ROBOT or roles.program_of(node) is None:
                    replaced[name] = '{}/{}'.format(PACKAGE, 'map_server' if kind.word == kinds.MAP else 'move_base')
                    if node.package.startswith('mbf_'):
                        what_counts.take_planners(self, node)
            elif kind.word != kinds.MAP:
                self._keep_or_leave(node, kind)
        for old, new in replaced.items():
            self.done.append('{} replaces {}'.format(new, old))
        return replaced

    def _stays_as_it_is(self, node, kind):
        """Return whether a node that robots with goals do not need works beside those driven by velocities."""
        keeps_navigation = self.options.real_navigation and (kind.word == kinds.ROBOT or kind.why == kinds.PLACE)
        return keeps_navigation or self.is_driven and kind.why in (kinds.SENSES, kinds.CHOOSES) or (
            self.is_driven and kind.word == kinds.FRAME and not _is_of_base(node)
            and not velocities.tells_place(self))

    def _serves_map(self, node):
        from ..adopting import floors  # it needs numpy and Pillow, and few launch files need it
        words = poses.words_of(node.args)
        why = floors.why_not_served(words)
        if not why and floors.beside(words):
            why = self._take_image(node, words)
        if why:
            self._leave(node, _short(why), is_loss=True)
        return not why

    def _take_image(self, node, words):
        """Have our map_server take the image that lies beside the YAML file. Return why another one cannot, or ''."""
        from ..adopting import floors
        image, name = os.path.abspath(floors.beside(words)), roles.name_of(node)
        if roles.program_of(node) is not None:
            return 'the image that {} names is not here, but {} is: correct it there'.format(words[0], image)
        self.param[name + '/image'] = image
        self.remarks.append('{} takes {}, which lies beside {}: the image that this names is not here ({})'.format(
            name, image, os.path.basename(words[0]), _place(node)))
        return ''

    def _keep_or_leave(self, node, kind):
        word = kind.word
        if word == kinds.LEFT_OUT:
            keeps = '' if roles.program_of(node) is None else '; --participant {} keeps it'.format(roles.name_of(node))
            self._leave(node, kind.why + keeps)
        elif word == kinds.FRAME and _is_of_robots(node):
            self._leave(node, 'our robots publish this frame themselves')
        elif word == kinds.STATE and 'gui' in node.type:
            self._leave(node, 'it waits for a person')
        elif word == kinds.STATE and not served.nearest(node.namespace, 'robot_description', self.values()):
            self._leave(node, 'there is no robot_description')
        elif ((node.package, node.type) == ('rosbag', 'play') or kinds.looks_like_a_clock(node.type)) and (
                roles.has_clock(node)):
            self._leave(node, kinds.CLOCK)
        elif node.package == 'nodelet':
            self._nodelet(node)
        else:
            self._look_for_program(node, kind)

    def _look_for_program(self, node, kind):
        path = roles.program_of(node)
        if path is None:
            is_loss = kind.word in (kinds.ELSE, kinds.FRAME) and not roles.is_display(node)
            self._leave(node, kinds.NO_PROGRAM + ('; build its package, or source its workspace'
                                                  if is_loss else ''), is_loss)
            return
        if unrolled.starts_several(path):
            self._unroll(node, path)
            return
        why = programs.cannot_start(path, self._is_older(node))
        interpreter = programs.missing_interpreter(path)
        if not why and interpreter and not roles.role_of(node, with_respawned=True).takes_part:
            why = 'it is a program for {}, which is not here'.format(interpreter)
        if why:
            self._leave(node, why, is_loss=True)
        elif look_ups.is_plain_script(path):
            self.remarks.append('{} is no executable file, and is run all the same ({})'.format(path, _place(node)))
        elif kind.why:
            self.remarks.append(
                '{0} ({1}/{2}) stays, because its program is here. By its name one could think that {3}: --leave-out '
                '{0} leaves it out ({4})'.format(roles.name_of(node), node.package, node.type, kind.why, _place(node)))

    def _unroll(self, node, path):
        """Add the nodes that a shell script starts in the background, in the place of the script."""
        found, refused = unrolled.nodes_of(path, poses.words_of(node.args), self.values(),
                                           lambda package, kind: roles.program_of(Node(package, kind)))
        self._leave(node, 'it is a shell script that starts {} nodes, as a restricted run of it has shown; they are '
                    'added{}'.format(len(found), refused), is_loss=bool(refused) or not found)
        for name, added in found.items():
            self.added[name] = added
            self.done.append('{} is added: {}'.format(name, added))
            self._is_older(Node(*given.split(added)[:2]))

    def _is_older(self, node):
        """Return whether a node takes part and its package is written for Python 2: then it is translated."""
        if not roles.role_of(node, with_respawned=True).takes_part:
            return False
        if node.package not in self.older:
            folder = look_ups.packages().get_path(node.package)
            why = older.why_older(folder) if node.package not in self.options.python2 else 'as it was asked for'
            self.older[node.package] = why
            if why:
                self.done.append('{} is written for Python 2 ({}): its programs are translated'.format(
                    node.package, why))
        return bool(self.older[node.package])

    def _nodelet(self, node):
        words = poses.words_of(node.args)
        package = words[1].partition('/')[0] if words[:1] in (['load'], ['standalone']) and len(words) > 1 else ''
        if package and not reading.is_package(package):
            self._leave(node, 'the package {} is not installed here'.format(package), is_loss=True)

    def _leave(self, node, why, is_loss=False):
        name = roles.name_of(node)
        self.left_out.append(name)
        (self.remarks if is_loss else self.done).append('{} ({}/{}) is left out: {}{} ({})'.format(
            name, node.package, node.type, why, started.end_of(node) if is_loss else '', _place(node)))

    def _robots(self):
        for robot in self.robots:
            if not robot.has_name:
                self.problems.append(
                    '{!r} is not a name that ROS accepts for a robot; allowed: letters, digits and _ between '
                    'slashes ({}); '
                    'if an argument of the file sets it: NAME:=VALUE'.format(robot.name, robot.place))
            if robot.added:
                self.added[robot.name] = '{}/{}'.format(PACKAGE, robot.name.rpartition('/')[2])
                self.done.append('{} is added: {} ({})'.format(robot.name, robot.added, robot.place))
        if not self.robots:
            self.problems.append(
                'this file has no robot: no node is a move_base, and nothing places one. Another file of its '
                'package may start the navigation; --add /NAMESPACE/move_base={0}/move_base adds one, and --add '
                '/NAMESPACE/velocity_robot={0}/velocity_robot one that is driven by cmd_vel'.format(PACKAGE))

    def _add_maps(self):
        for one in getattr(self.config, 'missing', ()):
            path = next((text for name, text in one.arguments if 'map' in name and os.path.isfile(text)
                         and text.endswith(('.yaml', '.yml'))), None) if one.kind == 'include' else None
            name = (one.namespace if one.namespace.endswith('/') else one.namespace + '/') + 'map_server'
            if path and name not in self.added:
                self.added[name] = '{}/map_server {}'.format(PACKAGE, shlex.quote(path))
                self.done.append('{} is added: {} gets the map {} ({})'.format(
                    name, _short(one.name), os.path.basename(path), one.place))

    def _starts(self):
        """Return {name: pose} of the robots whose place the file gives. Note the places of all robots."""
        # a velocity robot is where its simulator had it, in the simulator's frame, unless it says its place in the map
        is_apart = self.is_driven and not velocities.tells_place(self)
        found, unused = robots.starts_of(self.robots, self.hints, () if is_apart else self.stages)
        starts = {}
        for start in found:
            name = start.robot.name
            own = self._own_place(name)
            if {'start_x', 'start_y'} & set(own):
                continue
            if start.hint is None:
                if not own:
                    self.remarks.append('{0} starts at (0, 0, 0){1}: the file gives no place; --start {0}=X,Y,YAW '
                                        'gives one'.format(name, self._unless_placed(start.robot.namespace)))
                continue
            starts[name] = tuple(map(float, start.pose))
            self.done.append('{} starts at ({:g}, {:g}, {:g}){}: {}{}'.format(
                name, *start.pose, ' in {}'.format(start.robot.frame) if start.robot.frame else '', start.hint.shown,
                ', which is its place by the order in the file' * start.by_order))
            for other, pose in start.others:
                self.remarks.append('{} could start elsewhere: {}; --start {}={} starts it there'.format(
                    name, other.shown, name, ','.join('{:g}'.format(value) for value in pose)))
        for hint in unused:
            self.remarks.append('{} is not a robot of this run: {}'.format(hint.shown, 'no move_base belongs to it'))
        self._one_place([starts.get(name) or tuple(self._own_place(name).get(key, 0.0) for key in start_poses.PLACED)
                         for name in (start.robot.name for start in found)])
        return starts

    def _own_place(self, name):
        node = next((node for node in self.config.nodes if roles.name_of(node) == name), None)
        return start_poses.own_place(name, node, self.values(), self.options.start)

    def _unless_placed(self, namespace=''):
        return start_poses.unless_placed((node for node in self.config.nodes if not self.is_out(node)), namespace)

    def _one_place(self, found):
        for number, pose in enumerate(found):
            same = [robot.name for robot, other in zip(self.robots, found)
                    if robot.frame == self.robots[number].frame
                    and max(abs(a - b) for a, b in zip(pose[:2], other[:2])) < _SAME_PLACE]
            if len(same) > 1 and self.robots[number].name == same[0]:
                self.remarks.append('{} start at one place, ({:g}, {:g}){}: --start NODE=X,Y,YAW sets another'.format(
                    ' and '.join(same), *pose[:2], self._unless_placed()))

    def _clocks(self, kept):
        for node in kept:
            name = roles.name_of(node)
            if roles.has_clock(node, self.options.kept):
                self.problems.append(
                    '{0} ({1}/{2}) publishes /clock, and in lockstep only the time master may: two would make time '
                    'jump ({3}). --leave-out {0} leaves it out; --participant {0} keeps it, if it only could publish '
                    '/clock'.format(name, node.package, node.type, _place(node)))

    def ours(self, kept):
        """Return [(Robot, its Node, or None if it is added)] of the robots that run this package's programs."""
        nodes = {roles.name_of(node): node for node in kept if node.package == PACKAGE or not self.is_kept(node)}
        added = {**self.options.add, **self.added}
        return [(robot, nodes.get(robot.name)) for robot in self.robots if robot.name in nodes or robot.name in added]

    def _fatal(self, kept):
        """Note robots that would end with an error. Robots of simulators that are not there get the backend builtin."""
        for robot, node in self.ours(kept):
            name, is_original = robot.name, node is not None and node.type == robots.OWN[1]
            words = poses.words_of(node.args) if is_original else []
            if words[_STAGE_ARGUMENT:][:1] and words[_STAGE_ARGUMENT] in _OWN_CLOCKS:
                words[_STAGE_ARGUMENT] = 'builtin'
                self.arguments[name] = ' '.join(map(shlex.quote, words))
                self.done.append('{} has no simulator in this run: its second argument is builtin'.format(name))
            if self.values().get(name + '/backend') in _OWN_CLOCKS:
                self.param[name + '/backend'] = 'builtin'
                self.done.append('{} has no simulator in this run: its backend is builtin'.format(name))
            try:
                self.settings[name] = self.read_settings(self.below(name), name)
            except ConfigurationError as error:
                self.problems.append('{} would end with an error: {}; --param NAME=VALUE sets another ({})'.format(
                    name, error, robot.place))

    def below(self, name):
        """Return the parameters below a node's name, as the parameter server nests them: {name: value or mapping}."""
        values = self.values()
        found = {key: value for key in INHERITED for value in [served.nearest(name, key, values)] if value is not None}
        found.update({'driven_by': 'velocities'} if name.endswith('/' + robots.OWN[2]) else {})
        found.update(served.below(name, values))
        found.update(zip(start_poses.PLACED, self.starts.get(name) or self.options.start.get(name) or ()))
        return {key: value for key, value in found.items() if key not in _READ_ELSEWHERE}

    def values(self):
        """Return {full name: value} of all parameters of the run."""
        there = {key: param.value for key, param in self.config.params.items()}
        return {**there, **self.param, **dict(given.single(self.options.param))}


def _kind_of(node):
    """Return the Kind of a node. What is here takes precedence over a guess by a part of its name; ``why`` stays."""
    kind, path = kinds.kind_of(node.package, node.type), roles.program_of(node)
    if path is not None and kind.word == kinds.ELSE and programs.imports_one_of(path, kinds.KEYBOARD):
        return kinds.Kind(kinds.LEFT_OUT, kinds.PERSON)
    if kind.is_guess and reading.is_package(node.package) and not (
            path is not None and programs.imports_one_of(path, kinds.HANDS)):
        return kinds.Kind(kinds.ELSE, kind.why)
    return kind


def _is_of_robots(node):
    parent, child, _pose = poses.frame_of(node) or ('', '', ())
    return 'odom' in child and ('map' in parent or 'world' in parent) or _is_of_base(node)


def _is_of_base(node):
    parent, child, _pose = poses.frame_of(node) or ('', '', ())
    return 'base' in child and 'odom' in parent


def _short(path):
    return path.replace(reading.NOT_INSTALLED, '')


def _place(node):
    return node.filename or ''
