"""The battery of a robot: its parameters, and its state of charge at any instant, by a formula.

The instants at which the charge crosses a threshold follow from the formula, to the nanosecond; nothing is polled.
"""
from __future__ import annotations

import functools
import math
import operator
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, List, Mapping, Optional, Tuple, Union

from ..common.kinds import number
from ..common.parameter_table import Parameter
from ..common.units import LAST_NS, NS_PER_S
from ..engine.alarm import Alarm
from ..engine.instants import first_ns
from ..engine.series import PARTICIPANTS
from ..goals.events import ABOVE, BELOW, CHARGED, EMPTY, FULL, SET, USED, ChargePassed, ChargeRead, Charging
from ..goals.outcome import BATTERY_EMPTY
from ..goals.task_events import LoadChanged
from .consumption import LegEnergy, Mechanics

if TYPE_CHECKING:
    from ..engine.simulation import Simulation
    from ..engine.stream import Stream
    from ..goals.navigator import Navigator

_positive = functools.partial(number, above=0.0, high=1e9)
_not_negative = functools.partial(number, 0.0, 1e9)
_SHARE = number(0.0, 1.0)
STATE_OF_CHARGE = Parameter('state_of_charge', None, _SHARE)


def _thresholds(value: Any) -> Any:
    if not isinstance(value, (list, tuple)):
        raise ValueError
    shares = tuple(sorted((number(above=0.0, high=1.0)(share) for share in value), reverse=True))
    if len(set(shares)) != len(shares) or 1.0 in shares:
        raise ValueError
    return shares


#: the defaults are those of a small robot in the demos of rmf
TABLE = (
    Parameter('battery_capacity', 0.0, _not_negative(unit='Ah', note='0 = no battery'), 'Charge of the full battery.'),
    Parameter('nominal_voltage', 12.0, _positive(unit='V'),
              'Voltage; capacity times voltage is the energy of the full battery.'),
    Parameter('charging_current', 5.0, _positive(unit='A'), 'Charging current at a charger that has none of its own.'),
    Parameter('mass', 70.0, _positive(unit='kg'), 'Mass of the robot.'),
    Parameter('moment_of_inertia', 40.0, _positive(unit='kg m^2'), 'Moment of inertia about the vertical axis.'),
    Parameter('friction_coefficient', 0.22, _not_negative(), 'Rolling resistance divided by weight.'),
    Parameter('ambient_power', 20.0, _not_negative(unit='W'), 'Power of computers and sensors, always on.'),
    Parameter('tool_power', 0.0, _not_negative(unit='W'), 'Power of the tool while it works.'),
    Parameter('battery_start', 1.0, _SHARE, 'State of charge at the start and after a reset.'),
    Parameter('battery_thresholds', (0.2,), _thresholds,
              'States of charge whose crossing is reported.', 'a list of different numbers > 0, < 1'),
    Parameter('battery_state_freq', 0.0, number(0.0, 1000.0, unit='Hz, simulated', note='0 = at changes only'),
              'Rate at which the state of the battery is repeated.'),
)


@dataclass(frozen=True)
class BatterySettings:
    """A battery and what it feeds; units as in TABLE. ``levels``: the thresholds, highest first, the last one 0."""

    capacity: float
    nominal_voltage: float
    charging_current: float
    mechanics: Mechanics
    ambient_power: float
    tool_power: float
    start: float
    levels: Tuple[float, ...]

    @property
    def energy(self) -> float:
        """The energy of the full battery [J]."""
        return self.capacity * self.nominal_voltage * 3600.0 or sys.float_info.min


def read_battery(values: Mapping[str, Any]) -> Optional[BatterySettings]:
    """Return the :class:`BatterySettings` in ``values`` (of :data:`TABLE`), None for a robot without a battery."""
    if not values['battery_capacity']:
        return None
    return BatterySettings(
        values['battery_capacity'], values['nominal_voltage'], values['charging_current'],
        Mechanics(values['mass'], values['moment_of_inertia'], values['friction_coefficient']),
        values['ambient_power'], values['tool_power'], values['battery_start'], (*values['battery_thresholds'], 0.0))


class Battery:
    """The battery of one robot.

    ``zones`` (Zone, ...): those with a charger charge the robots that stand in them; ``stream``: the robot's stream of
    events, for telling and hearing. ``charger``: the Zone that charges the robot, or None.
    """

    #: the reason for which the navigator refuses goals
    REASON = 'battery'

    def __init__(self, settings: BatterySettings, robot: Any, navigator: Navigator, simulation: Simulation,
                 zones: Tuple[Any, ...], stream: Stream) -> None:
        self.settings = settings
        self.charger: Any = None
        self._robot = robot
        self._navigator = navigator
        self._simulation = simulation
        self._chargers = [zone for zone in zones if zone.charger is not None]
        self._stream = stream
        self._hears: Optional[Callable[[], int]] = None
        self._tool_works = False
        self._load = 0.0
        self._soc = settings.start
        self._energy = settings.energy
        self._course: Union[_Even, _Driving] = _Even(0.0, simulation.now_ns)
        self.since_ns = simulation.now_ns  # the instant from which on the formula holds
        self._levels = _Levels(settings.levels, self._soc)
        self._alarm = Alarm(simulation.queue, robot.index, self._is_heard)
        robot.follow(self._motion_changed)
        stream.subscribe('battery', {LoadChanged: self._load_changed})

    def soc_at(self, now_ns: int) -> float:
        """Return the state of charge in 0..1 at ``now_ns`` [ns], not before the present leg or stand."""
        return min(1.0, max(0.0, self._soc - self._course.until(now_ns) / self._energy))

    @property
    def soc(self) -> float:
        """The state of charge in 0..1, now."""
        return self.soc_at(self._simulation.now_ns)

    @property
    def is_empty(self) -> bool:
        """Whether the battery is empty, so that the robot stands."""
        return self._levels.passed == len(self.settings.levels)

    @property
    def is_low(self) -> bool:
        """Whether the charge is at or below a threshold."""
        return self._levels.passed > 0

    @property
    def current(self) -> Any:
        """The current [A] while the robot stands, > 0 while it is charged; None while it drives."""
        if isinstance(self._course, _Even):
            return 0.0 if self.is_empty else -self._course.power / self.settings.nominal_voltage
        return None

    def set(self, soc: float, now_ns: int) -> None:
        """Set the state of charge to ``soc``, 0..1, from ``now_ns`` [ns] on."""
        self._motion_changed(now_ns)
        self._soc = soc
        self._stream.tell(ChargePassed(now_ns, self._robot.name, soc, SET))
        self._stream.tell(ChargeRead(now_ns, self._robot.name, self._soc, self._energy, SET))
        self._pass_levels(now_ns)
        self._schedule(now_ns)

    def set_tool(self, works: Any, now_ns: int) -> None:
        """Note that the tool works from ``now_ns`` [ns] on, or no longer works."""
        self._tool_works = works
        self._motion_changed(now_ns)

    def _load_changed(self, event: LoadChanged) -> None:
        self._load = event.watts
        self._motion_changed(event.time_ns)

    def reset(self, now_ns: int) -> None:
        """Go back to the charge at the start. The navigator is reset already; the robot is placed at its start next."""
        self._soc, self._course = self.settings.start, _Even(0.0, now_ns)
        self._tool_works, self._load = False, 0.0
        self._levels.passed = 0
        self._pass_levels(now_ns, is_told=False)

    def restart(self, by_ns: int) -> None:
        """Note that the clock has restarted and events have been shifted by ``by_ns`` [ns]; the robot stands next."""
        now_ns = self._simulation.now_ns
        self._settle(now_ns - by_ns)
        self._course = _Even(0.0, now_ns)

    def close(self) -> None:
        """Note that the robot is removed."""
        self._alarm.cancel()

    def tell_those(self, hears: Callable[[], int]) -> None:
        """Ask ``hears()``, from now on, who listens to the battery: NOBODY to PARTICIPANTS. Until then nobody does."""
        self._hears = hears

    def _is_heard(self) -> bool:
        return self._hears is not None and self._hears() == PARTICIPANTS

    def begin(self, now_ns: int) -> None:
        """Begin at ``now_ns`` [ns], when all parts of the robot exist: report the charge and go by the formula."""
        self._levels.passed = 0
        self._pass_levels(now_ns, is_told=False)
        self._stream.tell(ChargeRead(now_ns, self._robot.name, self._soc, self._energy, SET))
        self._motion_changed(now_ns)

    def _settle(self, now_ns: int) -> None:
        self._soc, self._course = self.soc_at(now_ns), _Even(0.0, now_ns)
        self.since_ns = now_ns

    def _motion_changed(self, now_ns: int) -> None:
        """Find the formula that holds from ``now_ns`` [ns] on."""
        driven: Any = self._course
        leg, settings = self._robot.leg, self.settings
        is_same_leg = isinstance(driven, _Driving) and driven.leg is leg
        goes_on = isinstance(driven, _Driving) and not is_same_leg and leg is not None and not leg.is_from_rest
        undone = driven.undone(now_ns) if goes_on else 0.0
        self._settle(now_ns)
        if undone:
            self._soc += undone / self._energy
        if isinstance(driven, _Driving) and not is_same_leg and not goes_on and now_ns > driven.leg.depart_ns:
            self._soc = max(0.0, self._soc - driven.energy.stopping(now_ns) / self._energy)
        charger = None
        if leg is None:
            pose = self._robot.pose_at(now_ns)
            charger = next((zone for zone in self._chargers if zone.contains(pose.x, pose.y)), None)
        if charger is not self.charger:
            before, self.charger = self.charger, charger
            self._stream.tell(Charging(now_ns, self._robot.name, (charger or before).name, charger is not None))
            self._stream.tell(ChargeRead(now_ns, self._robot.name, self._soc, self._energy,
                                         USED if before is None else CHARGED))
        power = settings.ambient_power + self._load + (settings.tool_power if self._tool_works else 0.0)
        if leg is not None:
            energy = driven.energy if is_same_leg else LegEnergy(
                leg, settings.mechanics, driven.energy.kinetic(now_ns) if goes_on else (0.0, 0.0))
            self._course = _Driving(leg, energy, energy.until(now_ns) if is_same_leg else 0.0, power, now_ns)
        elif charger is None:
            self._course = _Even(power, now_ns)
        else:
            current = settings.charging_current if charger.charger is True else charger.charger
            self._course = _Even(-current * settings.nominal_voltage, now_ns)
        self._schedule(now_ns)

    def _schedule(self, now_ns: int) -> None:
        """Schedule the instant at which the charge crosses the next level."""
        due_ns, found = None, self._levels.next(self._course.is_charging, self._soc)
        if found is not None:
            level, is_beyond = found

            def is_passed(at_ns: int) -> bool:
                return is_beyond(self.soc_at(at_ns), level)
            due_ns = now_ns if is_passed(now_ns) else self._course.first_ns(
                self._soc - level, self._energy, is_passed)
        if due_ns is None:
            self._alarm.cancel()
        else:
            self._alarm.set(due_ns, self._notice)

    def _notice(self, now_ns: int) -> None:
        if self._course.is_charging and not self._levels.passed:
            self._settle(now_ns)  # the battery is full, so the charger only feeds the robot
            self._soc = 1.0
            self._stream.tell(ChargePassed(now_ns, self._robot.name, 1.0, FULL))
        else:
            self._pass_levels(now_ns)
            self._schedule(now_ns)

    def _pass_levels(self, now_ns: int, is_told: bool = True) -> None:
        """Note which levels the charge has crossed, and report them if ``is_told``."""
        was_empty = self.is_empty
        passed = self._levels.take(self.soc_at(now_ns))
        with ExitStack() as rest:  # these callbacks run even if telling fails
            if self.is_empty and not was_empty:
                rest.callback(self._navigator.disable, self.REASON, BATTERY_EMPTY, now_ns)
            elif was_empty and not self.is_empty:
                rest.callback(self._navigator.enable, self.REASON)
            for level, what in passed if is_told else ():
                self._stream.tell(ChargePassed(now_ns, self._robot.name, level, what))


class _Levels:
    """The thresholds of a charge, highest first, the last one 0; ``passed``: the number that ``soc`` is not above."""

    def __init__(self, levels: Tuple[float, ...], soc: float) -> None:
        self._levels = levels
        self.passed = self._count(soc)

    def _count(self, soc: float) -> int:
        return sum(soc <= level for level in self._levels)

    def next(self, is_charging: bool, soc: float) -> Optional[Tuple[float, Callable[[float, float], bool]]]:
        """Return (level, function(charge, level) that says if it is crossed) of the level that comes next, or None."""
        if not is_charging:
            return None if self.passed == len(self._levels) else (self._levels[self.passed], operator.le)
        if self.passed:
            return self._levels[self.passed - 1], operator.gt
        return (1.0, operator.ge) if soc < 1.0 else None

    def take(self, soc: float) -> List[Tuple[float, str]]:
        """Note the charge ``soc``; return (level, BELOW, EMPTY or ABOVE) of each level that it crossed, in order."""
        before, self.passed = self.passed, self._count(soc)
        return [(level, BELOW if level else EMPTY) for level in self._levels[before:self.passed]] or [
            (level, ABOVE) for level in reversed(self._levels[self.passed:before])]


class _Even:
    """A constant ``power`` [W] since ``since_ns`` [ns]; that of a charger is < 0."""

    def __init__(self, power: float, since_ns: int) -> None:
        self.power = power
        self.is_charging = power < 0.0
        self._since_ns = since_ns

    def until(self, now_ns: int) -> float:
        """Return the energy [J] that has been taken up to ``now_ns`` [ns]."""
        return self.power * ((now_ns - self._since_ns) / NS_PER_S)

    def first_ns(self, share: float, energy: float, is_passed: Callable[[int], bool]) -> Optional[int]:
        """Return the first instant [ns] at which ``is_passed``, or None if there is none.

        It is about when the ``share`` of the ``energy`` [J] has been taken.
        """
        if not self.power:
            return None
        seconds = share * energy / self.power
        if self._since_ns + (seconds + 1.0) * NS_PER_S > LAST_NS:
            return None
        near_ns, spread_ns = self._since_ns + max(0, math.ceil(seconds * NS_PER_S)), 4
        if is_passed(near_ns) and not (near_ns > self._since_ns and is_passed(near_ns - 1)):
            return near_ns
        if not is_passed(LAST_NS):
            return None  # the power is so small that rounding hides it
        while not is_passed(near_ns + spread_ns) or (near_ns - spread_ns > self._since_ns
                                                     and is_passed(near_ns - spread_ns)):
            spread_ns *= 8  # rounding has moved the instant further
        return first_ns(max(self._since_ns, near_ns - spread_ns), near_ns + spread_ns, is_passed)


class _Driving:
    """A leg from ``since_ns`` [ns] on: a ``power`` [W] and its LegEnergy, of which ``before`` [J] was taken before."""

    is_charging = False

    def __init__(self, leg: Any, energy: LegEnergy, before: float, power: float, since_ns: int) -> None:
        self.leg = leg
        self.energy = energy
        self._before = before
        self._power = power
        self._since_ns = since_ns

    def until(self, now_ns: int) -> float:
        """Return the energy [J] that has been taken up to ``now_ns`` [ns]; it is 0 at the departure."""
        if now_ns <= self.leg.depart_ns:
            return 0.0
        return self.energy.until(now_ns) - self._before + self._power * ((now_ns - self._since_ns) / NS_PER_S)

    def undone(self, now_ns: int) -> float:
        """Return what :meth:`until` counts too much [J] if another leg goes on at ``now_ns`` [ns]."""
        return 0.0 if now_ns <= self.leg.depart_ns else self.energy.until(now_ns) - self.energy.until(now_ns, True)

    def first_ns(self, _share: float, _energy: float, is_passed: Callable[[int], bool]) -> Optional[int]:
        """Return the first instant [ns] at which ``is_passed``, or None if there is none on this leg."""
        arrive_ns = self.leg.arrive_ns
        return first_ns(self._since_ns, arrive_ns, is_passed) if is_passed(arrive_ns) else None
