"""dynamic_reconfigure of move_base and of its local planner. New limits count at once, tolerances on the next leg.

Only values that a user sets are written to the parameter server. Upstream's servers write all their fields at the
start: then the namespaces of a system would be full of values that no user gave, and the next start would find them.
"""
from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING, Any, Callable, Dict, Mapping

import rospy
from dynamic_reconfigure.encoding import extract_params
from dynamic_reconfigure.server import Server

from move_base_abstract.cfg import DWAPlannerConfig, MoveBaseConfig, TrajectoryPlannerConfig
from move_base_abstract.config.local_planner import SpeedNames
from move_base_abstract.motion.leg import MotionLimits, Tolerances

from ..replacing.bulk_registration import delete_params, get_namespace, set_params

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings

    from .move_base_server import MoveBaseServer
    from .names import RobotNames

_PLANNER_TYPES = {'TrajectoryPlannerROS': TrajectoryPlannerConfig}
_CASTS = {'double': float, 'int': int, 'bool': bool, 'str': str}


class _SafeServer(Server):
    """A Server that starts from ``known`` values and survives parameters of the wrong type."""

    def __init__(self, config_type: Any, callback: Callable[[Any, int], Any], namespace: str,
                 known: Mapping[str, Any]) -> None:
        self._known = known
        self._written: Dict[str, Any] = {}
        self._made: Dict[str, Any] = {}  # names of parameters that did not exist before
        self._lock = threading.Lock()
        super().__init__(config_type, callback, namespace)

    def _copy_from_parameter_server(self) -> None:
        raw = get_namespace(self.ns.rstrip('/'))
        for parameter in extract_params(self.type.config_description):
            name, cast = parameter['name'], _CASTS[parameter['type']]
            value = self._known.get(name, raw.get(name, self.config[name]))
            if isinstance(value, bool) != (cast is bool) or not isinstance(value, (cast, int)):
                rospy.logwarn('parameter %s%s: got %r; allowed: a %s; %r is used', self.ns, name, value,
                              parameter['type'], self.config[name])
                continue
            self.config[name] = cast(value)

    def _copy_to_parameter_server(self) -> None:
        """Write nothing: dynamic_reconfigure calls this at the start, too, and for all fields."""

    def update_configuration(self, changes: Any) -> Any:
        """Apply ``changes``, write the accepted ones to the parameter server, and return all fields."""
        namespace = self.ns.rstrip('/')
        with self._lock:
            before = dict(self.config)
            config = super().update_configuration(changes)
            self._written.update(dict.fromkeys(changes))
            # Also fields that were written before, because restore_defaults changes them back.
            values = {name: config[name] for name in self._written
                      if name in self.type.defaults and config[name] != before[name]}
            there = get_namespace(namespace)
            self._made.update((name, None) for name in values if name not in there)
            set_params(namespace, values)
        return config

    def close(self) -> None:
        """Unregister the topics and the service, and delete the parameters that did not exist before."""
        self.descr_topic.unregister()
        self.update_topic.unregister()
        self.set_service.shutdown('the robot is removed')
        delete_params(self.ns.rstrip('/'), self._made)


class Reconfigure:
    """The two servers of dynamic_reconfigure of one robot. They pass changes to its :class:`MoveBaseServer`."""

    def __init__(self, names: RobotNames, settings: RobotSettings, server: MoveBaseServer) -> None:
        self._server = server
        self._where = names.private
        self._namespace = names.namespace
        values = settings.values
        self._move_base_start = {name: values[name] for name in (
            'controller_frequency', 'planner_patience', 'max_planning_retries', 'recovery_behavior_enabled',
            'make_plan_add_unreachable_goal', 'base_global_planner', 'base_local_planner')}
        limits = settings.limits
        self._speeds_start = SpeedNames.of(limits.max_speed, settings.speeds)
        self._planner_start = {
            **self._speeds_start.shown(),
            'acc_lim_x': 0.0 if math.isinf(limits.acceleration) else limits.acceleration,
            'xy_goal_tolerance': settings.tolerances.xy, 'yaw_goal_tolerance': settings.tolerances.yaw}
        self._planner_now = dict(self._planner_start)
        self._speeds = self._speeds_start
        planner = settings.local_planner
        self._servers = [
            _SafeServer(MoveBaseConfig, self._on_move_base, names.private, self._move_base_start),
            _SafeServer(_PLANNER_TYPES.get(planner, DWAPlannerConfig), self._on_planner, names.own(planner),
                        self._planner_start)]

    def close(self) -> None:
        """Close both servers."""
        for server in reversed(self._servers):  # the planner's namespace is below that of move_base
            server.close()
        delete_params(self._namespace, ())

    def _on_move_base(self, config: Any, level: int) -> Any:
        if config['restore_defaults']:
            config.update(self._move_base_start, restore_defaults=False)
        if level != ~0:
            self._server.reconfigure_goals(config)
        return config

    def _on_planner(self, config: Any, level: int) -> Any:
        if level == ~0:
            return config
        speeds = self._speeds.changed(config)
        if config['restore_defaults']:
            speeds = self._speeds_start
            config.update(self._known_of(self._planner_start, config), restore_defaults=False)
        try:
            self._take_over(config, speeds)
        except ValueError as error:
            rospy.logwarn('%s: dynamic_reconfigure: %s; nothing is changed', self._where, error)
            config.update(self._known_of(self._planner_now, config))
        return config

    @staticmethod
    def _known_of(values: Mapping[str, float], config: Any) -> Dict[str, float]:
        return {key: value for key, value in values.items() if key in config}

    def _take_over(self, config: Any, speeds: SpeedNames) -> None:
        """Use the planner's limits. The top speed has two names: if both were set, the smaller value counts."""
        limits = self._server.navigator.robot.limits
        speed = limits.max_speed if speeds is self._speeds else speeds.speed
        limits = MotionLimits(speed, config['acc_lim_x'] or math.inf, limits.turn_rate)
        tolerances = Tolerances(config['xy_goal_tolerance'], config['yaw_goal_tolerance'])
        self._server.set_motion(limits, tolerances)
        self._speeds = speeds
        config.update(self._known_of(speeds.shown(), config))
        self._planner_now.update({key: config[key] for key in self._planner_now if key in config})
