"""Finds the limits of a robot in the parameter group of its local planner."""
from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple

from ..common.parameter_table import checked
from . import upstream

if TYPE_CHECKING:
    from ..common.parameter_table import Parameter

SPEED, ACCELERATION, XY_TOLERANCE, YAW_TOLERANCE = 'speed', 'acceleration', 'xy_tolerance', 'yaw_tolerance'

#: patterns of names that may mean a limit, in the group of an unknown planner
_LOOKS_LIKE = {
    SPEED: re.compile('vel|speed'),
    ACCELERATION: re.compile('acc(?!ura)'),
    XY_TOLERANCE: re.compile('^(?!.*(yaw|ang|rot|heading)).*(toler|accura)'),
    YAW_TOLERANCE: re.compile('^(?=.*(yaw|ang|rot|heading)).*(toler|accura)'),
}
#: patterns of names that mean something else: turning, sideways and backward motion, lower bounds, weights
_OTHERWISE = {kind: re.compile(r'(^|_)({})(_|$)'.format('|'.join(words))) for kind, words in (
    (SPEED, upstream.NOT_FORWARD + upstream.NOT_LIMITS), (ACCELERATION, upstream.NOT_FORWARD + upstream.NOT_LIMITS),
    (XY_TOLERANCE, upstream.NOT_LIMITS), (YAW_TOLERANCE, upstream.NOT_LIMITS))}
_NAMED_AT_MOST = 8


@dataclass(frozen=True)
class Found:
    """A limit: its value, its source, and the parameters (below the node's name) from which it was found."""

    value: float
    source: str
    paths: Tuple[str, ...] = ()


class PlannerGroup:
    """The parameters of the local planner in ``raw``, which has all parameters in the namespace ``where``.

    ``speeds``: {present name: m/s} of the speeds that :meth:`speed` has found. ``warnings``: texts about old names, and
    about names that may mean a limit but are not understood.
    """

    def __init__(self, raw: Mapping[str, Any], where: str) -> None:
        self._where = where.rstrip('/')
        self._is_named = isinstance(raw.get('base_local_planner'), str)
        self.name = upstream.plugin_namespace(raw['base_local_planner']) if self._is_named else _unnamed(raw)
        self._group = raw[self.name] if isinstance(raw.get(self.name), dict) else {}
        self._planner = upstream.LOCAL_PLANNERS.get(self.name, upstream.OTHER_PLANNER)
        self.speeds: Dict[str, float] = {}
        self.warnings: List[str] = []
        self._tell_old_names()

    def speed(self, parameter: Parameter) -> Found:
        """Return the :class:`Found` speed [m/s]: the smallest of the planner's speeds, possibly its own default."""
        planner = self._planner
        given = self._values(planner.speed, parameter, planner.zero_is_unset)
        found: List[Tuple[Optional[str], float]] = [*given]
        paths = tuple(self._path(name) for name, _ in given)
        self.speeds = {planner.renamed.get(name, name): value for name, value in given}
        if self._is_named and planner.default_speed is not None and (
                not found or planner.leading not in (None, *self.speeds)):
            found.append((None, planner.default_speed))
        if not found:
            return self._default(SPEED, parameter, parameter.default)
        name, value = min(found, key=lambda one: one[1])
        if name is None:
            return self._default(SPEED, parameter, value, ' of ' + self.name, paths)
        return Found(value, '~' + self._path(name), paths)

    def limit(self, kind: str, parameter: Parameter) -> Found:
        """Return the :class:`Found` limit of ``kind``: ACCELERATION [m/s^2], XY_TOLERANCE [m], YAW_TOLERANCE [rad]."""
        found = self._values(getattr(self._planner, kind), parameter)
        if not found:
            return self._default(kind, parameter, parameter.default)
        path = self._path(found[0][0])
        return Found(found[0][1], '~' + path, (path,))

    def _values(self, names: Tuple[str, ...], parameter: Parameter,
                zero_is_unset: Tuple[str, ...] = ()) -> List[Tuple[str, float]]:
        """Return [(name, value)] of those ``names`` that the group has; an old name is left out beside its new one."""
        found = {}
        for name in names:
            raw = self._get(name)
            if raw is None or (raw == 0 and name in zero_is_unset):
                continue
            if self._planner.renamed.get(name) not in found:
                found[name] = checked(raw, self._path(name), parameter, self._where)
        return list(found.items())

    def _get(self, name: str) -> Any:
        value: Any = self._group
        for part in self._full(name).split('/'):
            value = value.get(part) if isinstance(value, dict) else None
        return value

    def _full(self, name: str) -> str:
        """Return ``name`` with ``{robot}`` replaced by the group's kind of robot."""
        if '{robot}' not in name:
            return name
        robot = self._group.get('robot')
        kind = robot.get('type') if isinstance(robot, dict) else None
        return name.format(robot='robot/{}'.format(kind or upstream.MPC_DEFAULT_ROBOT))

    def _path(self, name: str) -> str:
        return '{}/{}'.format(self.name, self._full(name))

    def _default(self, kind: str, parameter: Parameter, value: Any, whose: str = '',
                 paths: Tuple[str, ...] = ()) -> Found:
        """Return ``value`` as a default, and warn of names that may mean the limit but are not understood."""
        known = {self._full(name) for names in self._planner.names() for name in names}
        strange = [path for path in leaves(self._group) if path not in known
                   and _LOOKS_LIKE[kind].search(path.rsplit('/', 1)[-1])
                   and not _OTHERWISE[kind].search(path.rsplit('/', 1)[-1])]
        if strange:
            more = ' ...' if len(strange) > _NAMED_AT_MOST else ''
            self.warnings.append(
                'parameter {}/{}: no {} is found (known here: {}), the default{} is used: {:g}; found and not '
                'understood: {}{}'.format(
                    self._where, self.name, kind.replace('_', ' '),
                    ', '.join(self._full(name) for name in getattr(self._planner, kind)) or 'none', whose, value,
                    ', '.join(strange[:_NAMED_AT_MOST]), more))
        return Found(value, 'default' + whose, paths)

    def _tell_old_names(self) -> None:
        old = ['{} (now {}{})'.format(name, new, '' if name in self._planner.speed else ', not used here')
               for name, new in self._planner.renamed.items() if name in self._group]
        if old:
            self.warnings.append(
                "parameter {}/{}: old names, which upstream's {} of ROS Noetic does not read: {}".format(
                    self._where, self.name, self.name, ', '.join(old)))


@dataclass(frozen=True)
class SpeedNames:
    """A top speed [m/s] that a planner's configuration shows under two names; the smaller of those that are set counts.

    ``given``: {name: m/s} of the names that were set. The other names show the speed but limit nothing.
    """

    speed: float
    given: Dict[str, float]

    NAMES = ('max_vel_x', 'max_vel_trans')

    @classmethod
    def of(cls, speed: float, given: Dict[str, float]) -> SpeedNames:
        """Return the names at the start; speeds that are ``given`` by other names are left out."""
        return cls(speed, {name: given[name] for name in cls.NAMES if name in given})

    def shown(self) -> Dict[str, float]:
        """Return {name: m/s} of all names."""
        return {name: self.given.get(name, self.speed) for name in self.NAMES}

    def changed(self, config: Dict[str, float]) -> SpeedNames:
        """Return the names after ``config``, {name: m/s}, was set, which may have one of them or both."""
        shown = self.shown()
        news = {name: config[name] for name in self.NAMES if name in config and config[name] != shown[name]}
        if not news:
            return self
        given = {**self.given, **news}
        return SpeedNames(min(given.values()), given)


def leaves(group: Dict[str, Any], prefix: str = '') -> List[str]:
    """Return the paths of the values in the nested dictionary ``group``, in alphabetical order."""
    paths = []
    for key in sorted(group, key=str):
        path = '{}{}'.format(prefix, key)
        paths += leaves(group[key], path + '/') if isinstance(group[key], dict) else [path]
    return paths


def _unnamed(raw: Mapping[str, Any]) -> str:
    """Return the planner if none is named: the first of UNNAMED_PLANNERS that has a group, or the first of all."""
    standing = [name for name in upstream.UNNAMED_PLANNERS if isinstance(raw.get(name), dict)]
    return standing[0] if standing else upstream.UNNAMED_PLANNERS[0]
