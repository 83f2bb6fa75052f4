"""Scenarios: names and settings of all robots of a fleet, from a YAML file or a dictionary.

    seed: 7
    defaults: {max_speed: 2.0}                     # settings of every robot
    robots:
      - {name: robot_0, start_x: 1.0, start_y: 2.0}
      - {name: tractor, max_speed: 4.0, acceleration: 0.5}
      - {name: drone, count: 10, start_y: 5.0, step_x: 2.0}    # drone_0 .. drone_9, 2 m apart
    encounters: none                               # or calibrated, see encounters
    zones: []                                      # see zones; the keys lanes and travel_matrix are paths of files
    places: [{name: dock, x: 12.0, y: 3.0}]        # see places
    arrivals: [{place: dock, rate_per_hour: 20.0, duration: 30.0}]    # tasks that arrive, see arrivals
    orders: [{name: picks, rate_per_hour: 20.0, stops: [{place: dock}]}]    # work with several stops, see orders
    dispatcher: {policy: nearest}                  # how orders are given to robots, see orders

The settings are the private parameters of the ``move_base`` node. A robot's own settings override the defaults.
"""
from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Set, Tuple

from .common.arguments import check_kind
from .common.bounded_yaml import load_yaml_file
from .common.errors import ConfigurationError
from .common.kinds import check_keys, error, integer, number, one_of
from .common.parameter_table import Parameter, checked, place_of
from .common.ros_names import ROBOT_NAME_RULE, is_robot_name
from .common.shown import shown_text
from .config.node_tables import MAX_ROBOTS
from .config.robot_table import OWN_NAMES
from .config.settings import RobotSettings, read_settings
from .driving.settings import GOALS, VELOCITIES
from .energy.battery import TABLE as BATTERY_TABLE
from .motion.encounter_law import EncounterLaw
from .orders import order_arrivals
from .orders.settings import DispatchSettings, read_dispatcher, with_levels
from .tasks.arrivals import merged, read_arrivals
from .tasks.places import read_places
from .traffic.rules import KEYS as RULES, TrafficRules, read_rules
from .traffic.zones import Zone, read_zones

if TYPE_CHECKING:
    from .common.type_names import StrPath
    from .orders.order import Order
    from .tasks.arrivals import Task

_NETWORKS = ('lanes', 'travel_matrix')  # settings that describe the world, so they are keys of the scenario itself
_TOP_KEYS = ('seed', 'defaults', 'robots', 'zones', *RULES, 'encounters', *_NETWORKS, 'places', 'arrivals', 'orders',
             'dispatcher')
#: settings that are paths of files; a calibration may also be named, without .yaml, if it ships with the package
_FILES = ('duration_quantiles', 'calibration', *_NETWORKS)
_GROUP_KEYS = ('name', 'count', 'step_x', 'step_y')
_COUNT = Parameter('count', None, integer(1, MAX_ROBOTS))
_SEED = Parameter('seed', 0, integer(0))
_ENCOUNTERS = Parameter('encounters', 'none', one_of('calibrated', 'none'))
_THRESHOLDS = next(one.default for one in BATTERY_TABLE if one.name == 'battery_thresholds')
_STEP = Parameter('step', 0.0, number(unit='m'))


@dataclass(frozen=True)
class RobotSpec:
    """One robot: its name, its parameters as they were given, and the settings that follow from them."""

    name: str
    parameters: Dict[str, Any]
    settings: RobotSettings


@dataclass(frozen=True)
class Scenario:
    """A fleet: the robots in the order of their indices, the settings of all robots, the seed of all draws, the zones.

    ``places``: {name: Place}, or None if the scenario says nothing of places. ``arrivals``: the sources of tasks.
    ``traffic``: the rules of traffic (TrafficRules). ``encounters``: what happens when two robots come near each other
    (EncounterLaw); None: nothing. ``order_sources``: the sources of orders. ``dispatcher``: how orders are given to
    robots (DispatchSettings), or None if the scenario does not say it.
    """

    robots: Tuple[RobotSpec, ...]
    defaults: Dict[str, Any] = field(default_factory=dict)
    seed: int = 0
    zones: Tuple[Zone, ...] = ()
    traffic: TrafficRules = TrafficRules()
    places: Any = None
    arrivals: Tuple[Any, ...] = ()
    encounters: Optional[EncounterLaw] = None
    order_sources: Tuple[Any, ...] = ()
    dispatcher: Optional[DispatchSettings] = None

    def tasks(self, seed: Optional[int] = None) -> Iterable[Task]:
        """Yield the tasks (Task) that arrive, in order, by ``seed`` or the scenario's seed; they may be endless."""
        return merged(self.arrivals, self._seed(seed))

    def orders(self, seed: Optional[int] = None) -> Iterator[Order]:
        """Yield the orders (Order) that arrive, in the same way."""
        return iter(order_arrivals.merged(self.order_sources, self._seed(seed)))

    def _seed(self, seed: Optional[int]) -> int:
        return self.seed if seed is None else checked(seed, 'seed', _SEED, 'scenario')


def read_scenario(path: StrPath, overrides: Optional[Mapping[str, Any]] = None,
                  base: Optional[Mapping[str, Any]] = None) -> Scenario:
    """Return the :class:`Scenario` in the YAML file ``path``; ``overrides``, ``base``: see :func:`make_scenario`.

    :raises ConfigurationError: if the file cannot be read, a key is unknown, or a value is not allowed.
    """
    raw = _with_files(load_yaml_file(path), os.path.dirname(os.path.abspath(path)))
    return make_scenario(raw, str(path), overrides, base)


def _with_files(raw: Any, folder: str) -> Any:
    """Return a scenario with the relative paths in it as paths from ``folder``; '': the working folder."""
    found = _with_paths(raw, _FILES, folder)
    if isinstance(found, dict):
        found['defaults'] = _with_paths(found.get('defaults'), _FILES, folder)
        for key, names in (('robots', _FILES), ('arrivals', ('file',)), ('orders', ('file',))):
            if isinstance(found.get(key), list):
                found[key] = [_with_paths(entry, names, folder) for entry in found[key]]
    return found


def _with_paths(settings: Any, names: Sequence[str], folder: str) -> Any:
    """Return settings with the relative paths among the values of ``names`` as paths from ``folder``."""
    if not isinstance(settings, dict):
        return settings
    return {key: os.path.join(folder or os.getcwd(), value)
            if key in names and isinstance(value, str) and (key != 'calibration' or value.endswith('.yaml')) else value
            for key, value in settings.items()}


def make_scenario(raw: Mapping[str, Any], where: str = 'scenario', overrides: Optional[Mapping[str, Any]] = None,
                  base: Optional[Mapping[str, Any]] = None) -> Scenario:
    """Return the :class:`Scenario` that the dictionary ``raw`` describes; error texts begin with ``where``.

    ``overrides`` are settings that replace the defaults of the same name, but not a robot's own settings. ``base`` are
    settings that the defaults replace.

    Relative paths are paths from the working folder.

    :raises ConfigurationError: if a key is unknown, a value is not allowed, or two robots have the same name.
    """
    check_kind(where, str, 'where')
    base, overrides = _given(base, 'base'), _given(overrides, 'overrides')
    raw = _with_files(raw, '')
    check_kind(raw, dict, where, 'a mapping with {}'.format(', '.join(_TOP_KEYS)))
    check_keys(raw, _TOP_KEYS, where, '')
    defaults = {} if raw.get('defaults') is None else raw['defaults']  # 0 and false are not allowed
    check_kind(defaults, dict, where + ': defaults', 'a mapping of settings')
    check_keys(defaults, OWN_NAMES, where, 'defaults.')
    seed = checked(raw.get('seed', 0), 'seed', _SEED, where)
    of_all = {**({'seed': seed} if seed else {}), **{key: raw[key] for key in _NETWORKS if key in raw}}
    defaults = {**of_all, **base, **defaults, **overrides}
    groups = [] if raw.get('robots') is None else raw['robots']
    check_kind(groups, list, where + ': robots', 'a list of robots')
    if sum(_size(group) for group in groups) > MAX_ROBOTS:
        raise ConfigurationError('{0}: robots: got more than {1} robots; allowed: at most {1}'.format(
            where, MAX_ROBOTS))
    dispatcher = None if raw.get('dispatcher') is None else read_dispatcher(raw['dispatcher'], where)
    levels = () if dispatcher is None else dispatcher.levels
    specs = [spec for index, group in enumerate(groups) for spec in _expand(group, index, defaults, levels, where)]
    settings: List[Any] = [spec.settings for spec in specs] or [read_settings(defaults, where + ': defaults')]
    _check_robots(specs, raw, where)
    places = None if raw.get('places') is None else read_places(raw['places'], where)
    if places is None and raw.get('orders') is not None:
        places = {}  # robots that do orders work
    arrivals = () if raw.get('arrivals') is None else read_arrivals(raw['arrivals'], places or {}, where)
    orders = () if raw.get('orders') is None else order_arrivals.read_orders(raw['orders'], places or {}, where)
    return Scenario(tuple(specs), defaults, overrides.get('seed', seed), read_zones(raw.get('zones'), where),
                    read_rules(raw, where), places, arrivals, _read_encounters(raw, settings, where), orders,
                    dispatcher)


def _given(settings: Optional[Mapping[str, Any]], name: str) -> Mapping[str, Any]:
    if settings is None:
        return {}
    check_kind(settings, dict, name, 'None, or a mapping of settings')
    return settings


def _read_encounters(raw: Mapping[str, Any], settings: Sequence[Any], where: str) -> Optional[EncounterLaw]:
    """Return the EncounterLaw of the robots' calibrations, which must agree; None if there are no encounters.

    ``settings``: the RobotSettings of all robots.
    """
    if checked(raw.get('encounters', 'none'), 'encounters', _ENCOUNTERS, where) == 'none':
        return None
    laws = [one.encounters for one in settings]
    if None in laws or any(law != laws[0] for law in laws):
        raise error(place_of(where, 'encounters'), 'calibrated',
                    'if all robots have a calibration with the same section encounters',
                    ' with robots whose calibration' + (
                        ' has no section encounters' if None in laws else 's have different laws'))
    law: EncounterLaw = laws[0]
    return law


def check_one_process(scenario: Scenario, parts: int, where: str) -> None:
    """Check that a scenario in which robots are counted in zones, lanes or places is not split into several processes.

    :raises ConfigurationError: if ``parts`` > 1 and the scenario has zones, encounters, or lanes or places that have a
        capacity.
    """
    what = counted_places(scenario)
    if parts > 1 and meets(scenario):
        raise error(place_of(where, 'parts'), parts, '1, because robots that are driven by velocities stop one another')
    if parts > 1 and what:
        raise error(place_of(where, 'parts'), parts, '1, because one process must count the robots in them',
                    f' with {what}' + (' that have a capacity' if what in ('lanes', 'places') else ''))


def meets(scenario: Scenario) -> bool:
    """Return whether several robots of a scenario are driven by velocities: they touch one another in one process."""
    return sum(spec.settings.drive is not None for spec in scenario.robots) > 1


def counted_places(scenario: Scenario) -> Optional[str]:
    """Return why the robots of a scenario depend on each other's positions, so that one process must know them all.

    One of 'encounters', 'zones', 'lanes' and 'places' (the last two: with a capacity), or None.
    """
    if scenario.encounters is not None:
        return 'encounters'
    if scenario.zones:
        return 'zones'
    if any(getattr(spec.settings.network, 'has_capacities', False) for spec in scenario.robots):
        return 'lanes'
    return 'places' if any(place.capacity is not None for place in (scenario.places or {}).values()) else None


def make_robot(name: Any, parameters: Mapping[str, Any], where: str = 'robot') -> RobotSpec:
    """Return the :class:`RobotSpec` of one robot.

    :raises ConfigurationError: if the name is not a ROS name, a key is unknown, or a value is not allowed.
    """
    if not is_robot_name(name):
        raise error(f'{where}: name', name, ROBOT_NAME_RULE)
    check_keys(parameters, OWN_NAMES, where, '')
    settings: Any = read_settings(parameters, where)
    return RobotSpec(name, dict(parameters), settings)


def _expand(group: Mapping[str, Any], index: int, defaults: Mapping[str, Any],
            levels: Tuple[float, ...], where: str) -> List[RobotSpec]:
    """Return the robots of one entry of the list; ``levels``: states of charge whose crossing they must report."""
    place = 'robots[{}]'.format(index)
    check_kind(group, dict, '{}: {}'.format(where, place), 'a mapping with at least a name')
    check_keys(group, _GROUP_KEYS + OWN_NAMES, where, place + '.')
    where = '{}: {}'.format(where, place)
    parameters = with_levels(dict(defaults, **{key: value for key, value in group.items() if key not in _GROUP_KEYS}),
                             levels, _THRESHOLDS)
    if 'count' not in group:
        return [make_robot(group.get('name'), parameters, where)]
    count = checked(group['count'], 'count', _COUNT, where)
    steps = [(key, checked(group.get('step_' + key[-1], 0.0), 'step_' + key[-1], _STEP, where))
             for key in ('start_x', 'start_y')]
    first = make_robot(group.get('name'), parameters, where).settings.values
    return [make_robot('{}_{}'.format(group['name'], number_),
                       dict(parameters, **{key: first[key] + number_ * step for key, step in steps}), where)
            for number_ in range(count)]


def _size(group: object) -> int:
    """Return the number of robots that an entry of the list stands for; 1 if the entry or its count is not allowed."""
    count = group.get('count', 1) if isinstance(group, dict) else 1
    return count if isinstance(count, int) and 1 <= count <= MAX_ROBOTS else 1


def frame_of(spec: RobotSpec) -> str:
    """Return the tf frame of a robot's base, with the robot's tf prefix, which is its name if none is set."""
    settings = spec.settings
    prefix = spec.name if settings.tf_prefix is None else settings.tf_prefix
    return replace(settings, tf_prefix=prefix).frame(settings.values['robot_base_frame'])


def _check_different(specs: Sequence[RobotSpec], where: str) -> None:
    """Refuse two robots with the same name or with the same tf frame."""
    names: Set[str] = set()
    frames: Dict[str, str] = {}
    for spec in specs:
        if spec.name in names:
            raise ConfigurationError("{}: robots: the name '{}' is given to more than one robot".format(
                where, spec.name))
        names.add(spec.name)
        check_frame(spec, frames, '{}: robots'.format(where))


def _check_robots(specs: Sequence[RobotSpec], raw: Mapping[str, Any], where: str) -> None:
    """Refuse robots that are alike, and robots driven by velocities where a dispatcher would send them goals."""
    _check_different(specs, where)
    driven = [spec.name for spec in specs if spec.settings.drive is not None]
    if driven and (raw.get('orders') is not None or raw.get('dispatcher') is not None):
        raise error(f"{where}: robot '{driven[0]}': driven_by", VELOCITIES, GOALS, ' with orders or a dispatcher')


def check_frame(spec: RobotSpec, frames: Dict[str, str], where: str) -> None:
    """Note the tf frame of a robot in ``frames``, {frame: name of its robot}.

    :raises ConfigurationError: if another robot has the same frame.
    """
    frame = frame_of(spec)
    other = frames.setdefault(frame, spec.name)
    if other != spec.name:
        raise ConfigurationError(
            "{}: '{}' and '{}' would both publish the tf frame '{}'; each robot needs a tf_prefix, or a "
            'robot_base_frame, of its own'.format(where, other, spec.name, shown_text(frame)))
