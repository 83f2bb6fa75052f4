"""The charge of robots over time: computed from their legs by the battery's own formulas, set right by the log's rows.

What a tool or work takes beside is not in the legs: it shows at the next row ``battery``.
"""
import json

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.energy.consumption import GRAVITY, LegEnergy

from .recording import is_number

_TOLD = ('battery', 'charge')  # rows that say the charge
_KINDS = (*_TOLD, 'departed', 'stands', 'charging_began', 'charging_ended')


class Charges:
    """The batteries of a World's robots: ``knots`` {robot: [(time [ns], share)]}, straight in between."""

    def __init__(self, world, begin_ns):
        self._currents = world.currents
        self._meters = {name: _Meter(start.battery, begin_ns) for name, start in world.starts.items()
                        if start.battery is not None}

    @property
    def knots(self):
        """{robot: [(time [ns], share 0..1)]} of those that have a battery."""
        return {name: meter.knots for name, meter in self._meters.items()}

    def drive(self, name, leg, end_ns):
        """A robot has driven a leg (Leg or Route) up to ``end_ns`` [ns]."""
        meter = self._meters.get(name)
        if meter is not None:
            meter.drive(leg, end_ns)

    def drive_evenly(self, name, end_ns, length):
        """A robot has driven ``length`` [m] up to ``end_ns`` [ns], by which law nobody knows."""
        meter = self._meters.get(name)
        if meter is not None:
            meter.drive_evenly(length, end_ns)

    def take(self, time_ns, name, kind, text):
        """Take a row of the log, after what :meth:`drive` was told of the time before it."""
        meter = self._meters.get(name)
        if meter is None or kind not in _KINDS:
            return
        values = json.loads(text)
        if kind in _TOLD:
            if values and is_number(values[0]) and 0.0 <= values[0] <= 1.0:
                meter.set(time_ns, float(values[0]))
            return
        meter.settle(time_ns)
        meter.drives = kind == 'departed' or (meter.drives and kind != 'stands')
        if kind == 'charging_began':
            current = self._currents.get(values[0]) if values and isinstance(values[0], str) else None
            meter.charge(current)
        elif kind == 'charging_ended':
            meter.charge(None)

    def close(self, end_ns):
        """The log ends."""
        for meter in self._meters.values():
            meter.settle(end_ns)


class _Meter:
    """One battery (BatterySettings) from ``since_ns`` on: the charge as of then, and what is taken while it stands."""

    def __init__(self, settings, since_ns):
        self._settings = settings
        self._soc = settings.start
        self._power = settings.ambient_power
        self.since_ns = since_ns
        self.drives = False
        self.knots = [(since_ns, self._soc)]

    def note(self):
        """Note the charge as of now."""
        self.knots.append((self.since_ns, self._soc))

    def set(self, time_ns, soc):
        """The log says the charge."""
        self.settle(time_ns)
        self.since_ns, self._soc = time_ns, soc
        self.note()

    def charge(self, current):
        """A charger gives this current [A] from now on; True: the robot's own; None: there is none."""
        settings = self._settings
        self._power = settings.ambient_power if current is None else -settings.nominal_voltage * (
            settings.charging_current if current is True else current)

    def settle(self, time_ns):
        """Take what a robot that stands has taken up to here."""
        if not self.drives and time_ns > self.since_ns:
            self._take(self._power * ((time_ns - self.since_ns) / NS_PER_S), time_ns)

    def drive(self, leg, end_ns):
        """Take what a leg has taken up to here, if the charge was not told on the way; at its departure nothing yet."""
        if end_ns <= leg.depart_ns:
            return
        energy = LegEnergy(leg, self._settings.mechanics)
        taken = energy.until(end_ns) - (energy.until(self.since_ns) if self.since_ns > leg.depart_ns else 0.0)
        if end_ns < leg.arrive_ns:
            taken += energy.stopping(end_ns)
        self._take(taken + self._settings.ambient_power * ((end_ns - self.since_ns) / NS_PER_S), end_ns)

    def drive_evenly(self, length, end_ns):
        """Take what a leg of so many metres has taken about: once up to its even speed, and down."""
        seconds = (end_ns - self.since_ns) / NS_PER_S
        if seconds > 0.0:
            mass, _, friction = self._settings.mechanics
            self._take(mass * (friction * GRAVITY * length + (length / seconds) ** 2)
                       + self._settings.ambient_power * seconds, end_ns)

    def _take(self, joules, time_ns):
        self._soc = min(1.0, max(0.0, self._soc - joules / self._settings.energy))
        self.since_ns = time_ns
        self.note()
