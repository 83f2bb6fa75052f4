"""The zones of a fleet in ROS: the topic ``~zones``, and the services ``~close_zone`` and ``~set_zone_limit``."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

import rospy

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.msg import ZoneState, ZoneStates
from move_base_abstract.srv import CloseZone, CloseZoneResponse, SetZoneLimit, SetZoneLimitResponse

from ..messages import conversions
from ..messages.outlets import LatchedOutlet
from ..messages.packing import of_message

if TYPE_CHECKING:
    from move_base_abstract.traffic.area import AreaState
    from move_base_abstract.traffic.control import Traffic

    from ..clocks.timing import Clock
    from ..messages.packing import Pack

_MOST_PLACES = 2 ** 32 - 1  # the largest capacity that a message can hold


class TrafficInterface:
    """Publishes the zones and lanes of ``traffic`` (Traffic), and closes zones. Make it when all robots are there."""

    def __init__(self, traffic: Traffic, clock: Clock) -> None:
        self._traffic = traffic
        self._clock = clock
        self._outlet = LatchedOutlet('~zones', ZoneStates, self._pack, queue_size=1)
        with clock.lock:
            traffic.follow(self._show)
            self._show()
        self._services = [rospy.Service('~close_zone', CloseZone, self._on_close),
                          rospy.Service('~set_zone_limit', SetZoneLimit, self._on_limit)]

    def _show(self) -> None:
        self._outlet.show(self._traffic.states(), self._traffic.simulation.now_ns)

    def _pack(self, states: Sequence[AreaState], now_ns: int) -> Pack:
        zones = [ZoneState(state.kind, state.name, min(state.capacity or 0, _MOST_PLACES), state.closed,
                           list(state.robots), list(state.waiting)) for state in states]
        return of_message(ZoneStates(conversions.to_time(now_ns), zones))

    def _on_close(self, request: Any) -> Any:
        with self._clock.lock:
            self._clock.now_ns()
            try:
                self._traffic.close_zone(request.zone, request.closed)
            except ConfigurationError as error:
                return CloseZoneResponse(False, str(error))
        rospy.loginfo('%s: the zone %s is %s', rospy.get_name(), request.zone, 'closed' if request.closed else 'open')
        return CloseZoneResponse(True, '')

    def _on_limit(self, request: Any) -> Any:
        with self._clock.lock:
            self._clock.now_ns()
            try:
                self._traffic.set_zone_limit(request.zone, request.max_speed or None)
            except ConfigurationError as error:
                return SetZoneLimitResponse(False, str(error))
        rospy.loginfo('%s: robots in the zone %s drive at most at %s', rospy.get_name(), request.zone,
                      '{:g} m/s'.format(request.max_speed) if request.max_speed else 'their own speed')
        return SetZoneLimitResponse(True, '')
