"""The condition of one robot in ROS: the services ``~fail`` and ``~repair``, and its status on ``/diagnostics``."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

import rospy
from std_srvs.srv import Trigger, TriggerResponse

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.faults.failures import REQUEST, check_request
from move_base_abstract.goals.events import ChargePassed, Charging, Failed, Held, Repaired
from move_base_abstract.srv import Fail, FailResponse

from .battery_server import BatteryServer
from .diagnostics import RobotDiagnostics, of_condition

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.faults.condition import Condition

    from .host import Host
    from .names import RobotNames


class ConditionServer:
    """Shows a robot's ``condition`` (Condition) in ROS. If the robot cannot fail and has no battery, it does nothing.

    The caller of the constructor holds the clock's lock.
    """

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot_index: int, condition: Condition,
                 stream: Stream) -> None:
        self._names = names
        self._clock = host.clock
        self._failing: Any = condition.failing  # None: it cannot fail, and there are no services
        self._services: Any = ()
        self._diagnostics: Optional[RobotDiagnostics] = None
        self._battery: Optional[BatteryServer] = None
        if not condition.is_ordinary:
            self._diagnostics = RobotDiagnostics(host, robot_index, names.robot, lambda: of_condition(condition))
        if condition.battery is not None:
            self._battery = BatteryServer(names, settings, host, robot_index, condition.battery)
        stream.subscribe('condition', {
            Held: self._changed, Failed: self._changed, Repaired: self._changed, ChargePassed: self._battery_changed,
            Charging: self._battery_changed})

    def serve(self) -> None:
        """Offer the services from now on. The caller holds no lock."""
        names = self._names
        if self._battery is not None:
            self._battery.serve()
        if self._failing is not None:
            self._services += (rospy.Service(names.own('fail'), Fail, self._fail),
                               rospy.Service(names.own('repair'), Trigger, self._repair))

    def _changed(self, event: Any) -> None:
        if self._diagnostics is not None:
            self._diagnostics.changed(event.time_ns)

    def _battery_changed(self, event: Union[ChargePassed, Charging]) -> None:
        if self._battery is not None:
            self._battery.changed(event.time_ns)
        self._changed(event)

    def close(self) -> None:
        """Unregister the services and topics. The caller holds no lock."""
        for service in self._services:
            service.shutdown('the robot is removed')
        if self._battery is not None:
            self._battery.close()
        if self._diagnostics is not None:
            self._diagnostics.close()

    def _fail(self, request: Any) -> Any:
        repair = request.repair.to_nsec() / 1e9
        try:
            check_request(request.kind or None, repair or None, self._names.own('fail'))
        except ConfigurationError as error:
            return FailResponse(False, str(error))
        with self._clock.lock:
            has_failed = self._failing.fail(REQUEST, self._clock.now_ns(), request.kind or None, repair or None)
        return FailResponse(has_failed, 'The robot has failed.' if has_failed else 'The robot had failed before.')

    def _repair(self, _request: Any) -> Any:
        with self._clock.lock:
            is_repaired = self._failing.repair(self._clock.now_ns())
        return TriggerResponse(is_repaired, 'The robot is repaired.' if is_repaired else 'The robot had not failed.')
