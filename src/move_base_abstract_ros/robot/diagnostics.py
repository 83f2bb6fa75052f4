"""Publish the condition of the robots of a process on ``/diagnostics``: at changes, and once a simulated second."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Tuple

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from move_base_abstract.common.units import NS_PER_S

from .. import lockstep
from ..lockstep.exchange import playing
from ..messages import conversions, packing
from ..messages.outlets import Outlet
from .heartbeat import Heartbeat

if TYPE_CHECKING:
    from move_base_abstract.faults.condition import Condition

    from .host import Host

    Told = Tuple[int, str, Dict[str, str]]  # level, text, values

_FREQUENCY = 1.0  # Hz, simulated; as upstream's updaters have it
_RATE_CAP = 5.0  # Hz, wall


class Diagnostics:
    """The topic and the heartbeat of a process. It is made for the first robot that needs it."""

    def __init__(self, host: Host) -> None:
        self.outlet = Outlet('/diagnostics', DiagnosticArray, queue_size=100)
        self.heartbeat = Heartbeat(host, _FREQUENCY, _RATE_CAP)


class RobotDiagnostics:
    """The status of one robot, in messages of its own, so that they keep their place in the order of all messages.

    ``tell()`` returns (level, text, {key: value}), as for a DiagnosticStatus.
    """

    def __init__(self, host: Host, robot_index: int, name: str, tell: Callable[[], Told]) -> None:
        self._shared = shared = host.diagnostics()
        self._rates = host.rates
        self._robot_index = robot_index
        self._name = name
        self._tell = tell
        self._latest: Optional[Told] = None
        shared.heartbeat.add(self.send, shared.outlet.is_heard)
        self._told = host.rates.add('diagnostics', lambda: _FREQUENCY, shared.outlet.hearers)

    def changed(self, now_ns: int) -> None:
        """Publish the condition at ``now_ns`` [ns] if it differs from the last one that was published."""
        told = self._tell()
        if self._latest is None or told[:2] != self._latest[:2] or told[2].keys() != self._latest[2].keys():
            self.send(now_ns)

    def send(self, now_ns: int) -> None:
        """Publish the condition at ``now_ns`` [ns], if any node hears it."""
        told = level, text, values = self._tell()
        if not playing.is_recording():
            self._latest = told
        if self._shared.outlet.is_heard():
            status = DiagnosticStatus(level=level, name=self._name + ': condition', message=text,
                                      hardware_id=self._name,
                                      values=[KeyValue(key, str(value)) for key, value in values.items()])
            message = DiagnosticArray(status=[status])
            message.header.stamp = conversions.to_time(now_ns)
            with lockstep.sender(self._robot_index):
                self._shared.outlet.send(packing.of_message(message))

    def close(self) -> None:
        """Publish nothing any more."""
        self._shared.heartbeat.remove(self.send)
        self._rates.remove(self._told)


def of_condition(condition: Condition) -> Told:
    """Return (level, text, values) of a Condition, as for a DiagnosticStatus.

    The level is ERROR if the robot has failed or its battery is empty, WARN if it is held or its battery is low.
    """
    failing, battery = condition.failing, condition.battery
    values: Dict[str, Any] = {}
    text = condition.state_text or ('battery low' if battery is not None and battery.is_low else '')
    level = DiagnosticStatus.WARN if text else DiagnosticStatus.OK
    if failing is not None:
        values['failures'] = failing.count
        if failing.failure is not None:
            level = DiagnosticStatus.ERROR
            values.update(kind=failing.failure.kind, cause=failing.failure.cause,
                          since='{:.9f} s'.format(failing.failure.since_ns / NS_PER_S))
    if battery is not None:
        values['state of charge'] = '{:.3f}'.format(battery.soc)
        if battery.is_empty:
            level = DiagnosticStatus.ERROR
    return level, text or 'OK', values
