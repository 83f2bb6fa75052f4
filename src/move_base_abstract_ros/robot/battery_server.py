"""The battery of one robot in ROS: ``battery_state``, and the services ``~set_battery`` and ``~set_tool``."""
from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import rospy
from sensor_msgs.msg import BatteryState
from std_srvs.srv import SetBool, SetBoolResponse

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.parameter_table import checked
from move_base_abstract.energy.battery import STATE_OF_CHARGE
from move_base_abstract.srv import SetCharge, SetChargeResponse

from .. import lockstep
from ..messages import conversions, packing
from ..messages.outlets import LatchedOutlet

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.energy.battery import Battery

    from ..messages.packing import Pack
    from .host import Host
    from .names import RobotNames


class BatteryServer:
    """Shows a robot's Battery in ROS, and lets services change it. The caller of the constructor holds the lock."""

    def __init__(self, names: RobotNames, settings: RobotSettings, host: Host, robot_index: int,
                 battery: Battery) -> None:
        self._names = names
        self._clock = host.clock
        self._battery = battery
        self._robot_index = robot_index
        self._host = host
        self._services: Any = ()
        frequency = settings.values['battery_state_freq']
        self._outlet = LatchedOutlet(names.topic('battery_state'), BatteryState, self._pack)
        battery.tell_those(self._outlet.is_heard)
        self._throttle = host.throttle(settings.values['max_pose_rate'])
        self._series = host.clock.simulation.series(robot_index, frequency, self._repeat, is_output=True,
                                                    is_heard=host.timing.when_heard(self._outlet.is_heard))
        self._told = host.rates.add('battery', lambda: frequency, self._outlet.hearers)
        now_ns = host.clock.simulation.now_ns
        self._outlet.show(now_ns)
        if self._series is not None:
            self._series.start(now_ns)

    def serve(self) -> None:
        """Offer the services from now on. The caller holds no lock."""
        self._services = (rospy.Service(self._names.own('set_battery'), SetCharge, self._set),
                          rospy.Service(self._names.own('set_tool'), SetBool, self._set_tool))

    def changed(self, now_ns: int) -> None:
        """Publish the state at ``now_ns`` [ns]."""
        with lockstep.sender(self._robot_index):
            self._outlet.show(now_ns)

    def close(self) -> None:
        """Unregister the services and the topic. The caller holds no lock."""
        for service in self._services:
            service.shutdown('the robot is removed')
        with self._clock.lock:
            if self._series is not None:
                self._series.stop()
            self._host.rates.remove(self._told)
            self._outlet.unregister()

    def _repeat(self, due_ns: int, _now_ns: int) -> Any:
        if self._throttle.ready():
            self.changed(due_ns)
        return self._clock.wall_to_ns(self._throttle.remaining())

    def _pack(self, now_ns: int) -> Pack:
        with self._clock.lock:
            return packing.of_message(self._message(now_ns))

    def _message(self, now_ns: int) -> Any:
        battery, settings = self._battery, self._battery.settings
        soc, current = battery.soc_at(max(now_ns, battery.since_ns)), battery.current
        status = BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
        if battery.charger is not None:
            status = (BatteryState.POWER_SUPPLY_STATUS_FULL if soc == 1.0
                      else BatteryState.POWER_SUPPLY_STATUS_CHARGING)
        message = BatteryState(
            voltage=settings.nominal_voltage, current=math.nan if current is None else current, temperature=math.nan,
            charge=soc * settings.capacity, capacity=settings.capacity, design_capacity=settings.capacity,
            percentage=soc, power_supply_status=status, present=True,
            power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_GOOD,
            power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_UNKNOWN,
            location=battery.charger.name if battery.charger is not None else '', serial_number=self._names.robot)
        message.header.stamp = conversions.to_time(now_ns)
        return message

    def _set(self, request: Any) -> Any:
        try:
            soc = checked(request.state_of_charge, 'state_of_charge', STATE_OF_CHARGE, self._names.own('set_battery'))
        except ConfigurationError as error:
            return SetChargeResponse(False, str(error))
        with self._clock.lock:
            self._battery.set(soc, self._clock.now_ns())
        return SetChargeResponse(True, '')

    def _set_tool(self, request: Any) -> Any:
        with self._clock.lock:
            self._battery.set_tool(bool(request.data), self._clock.now_ns())
        return SetBoolResponse(True, 'The tool works.' if request.data else 'The tool rests.')
