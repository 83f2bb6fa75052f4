"""The charge of robots over time: computed from their legs by the battery's formulas, and corrected by the log's rows.

The energy of a tool or of work is not in the legs. It becomes visible at the next row ``battery``.
"""
from __future__ import annotations

import json
from typing import TYPE_CHECKING, Dict, List, Optional, Tuple

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.energy.consumption import LegEnergy

from .recording import is_number

if TYPE_CHECKING:
    from move_base_abstract.energy.battery import BatterySettings
    from move_base_abstract.motion.pieces import Motion

    from .world import World

_TOLD = ('battery', 'charge')  # the kinds of rows that contain the charge
_KINDS = (*_TOLD, 'departed', 'driven', 'stands', 'charging_began', 'charging_ended')


class Charges:
    """The batteries of a World's robots. Between the ``knots`` the charge changes linearly."""

    def __init__(self, world: World, begin_ns: int) -> None:
        self._currents = world.currents
        self._meters = {name: _Meter(start.battery, begin_ns) for name, start in world.starts.items()
                        if start.battery is not None}

    @property
    def knots(self) -> Dict[str, List[Tuple[int, float]]]:
        """The charge: {robot: [(time [ns], share 0..1)]} for the robots that have a battery."""
        return {name: meter.knots for name, meter in self._meters.items()}

    def drive(self, name: str, leg: Motion, end_ns: int) -> None:
        """Take the leg that a robot has driven up to ``end_ns`` [ns]."""
        meter = self._meters.get(name)
        if meter is not None:
            meter.drive(leg, end_ns)

    def take(self, time_ns: int, name: str, kind: str, text: str) -> None:
        """Take a row of the log. :meth:`drive` must have taken the legs before it."""
        meter = self._meters.get(name)
        if meter is None or kind not in _KINDS:
            return
        values = json.loads(text)
        if kind in _TOLD:
            if values and is_number(values[0]) and 0.0 <= values[0] <= 1.0:
                meter.set(time_ns, float(values[0]))
            return
        meter.settle(time_ns)
        meter.drives = kind in ('departed', 'driven') or (meter.drives and kind != 'stands')
        if kind == 'charging_began':
            current = self._currents.get(values[0]) if values and isinstance(values[0], str) else None
            meter.charge(current)
        elif kind == 'charging_ended':
            meter.charge(None)

    def close(self, end_ns: int) -> None:
        """Bring all robots that stand up to the end of the log."""
        for meter in self._meters.values():
            meter.settle(end_ns)


class _Meter:
    """One battery (BatterySettings): its charge at ``since_ns``, and the power that it gives while the robot stands."""

    def __init__(self, settings: BatterySettings, since_ns: int) -> None:
        self._settings = settings
        self._soc = settings.start
        self._power = settings.ambient_power
        self.since_ns = since_ns
        self.drives = False
        self.knots = [(since_ns, self._soc)]

    def note(self) -> None:
        """Add the present charge to the knots."""
        self.knots.append((self.since_ns, self._soc))

    def set(self, time_ns: int, soc: float) -> None:
        """Set the charge to the value in the log (0 to 1)."""
        self.settle(time_ns)
        self.since_ns, self._soc = time_ns, soc
        self.note()

    def charge(self, current: Optional[bool]) -> None:
        """Set the charger's current [A] from now on; True: the robot's own one; None: no charger."""
        settings = self._settings
        self._power = settings.ambient_power if current is None else -settings.nominal_voltage * (
            settings.charging_current if current is True else current)

    def settle(self, time_ns: int) -> None:
        """Subtract the energy that a standing robot has used up to ``time_ns``."""
        if not self.drives and time_ns > self.since_ns:
            self._take(self._power * ((time_ns - self.since_ns) / NS_PER_S), time_ns)

    def drive(self, leg: Motion, end_ns: int) -> None:
        """Subtract the energy of a leg up to ``end_ns``, from its departure, or from a later row with the charge."""
        if end_ns <= leg.depart_ns:
            return
        energy = LegEnergy(leg, self._settings.mechanics)
        taken = energy.until(end_ns) - (energy.until(self.since_ns) if self.since_ns > leg.depart_ns else 0.0)
        if end_ns < leg.arrive_ns:
            taken += energy.stopping(end_ns)
        self._take(taken + self._settings.ambient_power * ((end_ns - self.since_ns) / NS_PER_S), end_ns)

    def _take(self, joules: float, time_ns: int) -> None:
        self._soc = min(1.0, max(0.0, self._soc - joules / self._settings.energy))
        self.since_ns = time_ns
        self.note()
