"""Check charge: chargers out of reach of the first charge, places and orders for which no full battery is enough."""
from __future__ import annotations

import os
from itertools import islice
from typing import TYPE_CHECKING, Any, Iterator, List, Optional, Sequence, Tuple

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.energy.consumption import LegEnergy
from move_base_abstract.fleet.dispatch_world import Distances, starts_of
from move_base_abstract.orders.fleet_state import make_states
from move_base_abstract.orders.look_ahead import LookAhead
from move_base_abstract.orders.settings import DispatchSettings

from .findings import Finding, listed
from .ways import MOST_WAYS, leg_between, too_many

if TYPE_CHECKING:
    from move_base_abstract.common.geometry import Pose2D

    from .world import Drivers, Start, Target, World

_MOST_ORDERS = 200  # of each source
_ADVICE = 'start with more (battery_start), take a larger battery (battery_capacity), or add a charger that is nearer'


def check_charge(world: World) -> Iterator[Finding]:
    """Yield a :class:`.Finding` for each charger, robot and place with such a problem, by the batteries' formula."""
    chargers = [target for target in world.targets if target.what == 'charger']
    places = [target for target in world.targets if target.what == 'place']
    groups = [drivers for drivers in world.drivers if drivers.settings.battery is not None]
    starts = [(drivers, start) for drivers in groups for start in drivers.starts]
    if not chargers or not groups:
        return
    if (len(starts) + 2 * len(places) * len(groups)) * len(chargers) > MOST_WAYS:
        yield too_many(world, 'charge', '{} robots, {} places and {} chargers are'.format(
            len(starts), len(places), len(chargers)))
        return
    needs = [[energy_between(drivers, start.spec.settings.start, charger.pose) for charger in chargers]
             for drivers, start in starts]
    for number, charger in enumerate(chargers):
        yield from _of_charger(charger, starts, [need[number] for need in needs])
    for (_, start), need in zip(starts, needs):
        yield from _of_robot(start, need)
    for place in places:
        yield from _of_place(place, chargers, groups)
    if len(groups) == len(world.drivers):  # otherwise a robot without a battery does the order
        yield from _of_orders(world, chargers)


def energy_between(drivers: Drivers, begin: Pose2D, goal: Pose2D) -> Optional[float]:
    """Return the energy [J] that a robot of ``drivers`` needs from ``begin`` to ``goal`` (Pose2D); None: no way."""
    battery: Any = drivers.settings.battery  # these robots have one
    leg = leg_between(drivers, begin, goal)
    if leg is None:
        return None
    return (LegEnergy(leg, battery.mechanics).until(leg.arrive_ns)
            + battery.ambient_power * (leg.arrive_ns - leg.depart_ns) / NS_PER_S)


def _charge(start: Start) -> float:
    battery: Any = start.spec.settings.battery
    return float(battery.start * battery.energy)


def _of_charger(charger: Target, starts: Sequence[Tuple[Drivers, Start]],
                needs: Sequence[Optional[float]]) -> Iterator[Finding]:
    known = [(need - _charge(start), need, start) for (_, start), need in zip(starts, needs) if need is not None]
    if known and all(missing > 0.0 for missing, _, _ in known):
        _, need, start = min(known, key=lambda one: one[0])
        yield Finding('out_of_charge', 'charger {}'.format(charger.name), 'no robot gets there with the charge that it '
                      'starts with; nearest to it comes {}, which takes {:.3g} kJ and has {:.3g} kJ'.format(
                          start.spec.name, need / 1e3, _charge(start) / 1e3), charger.where, _ADVICE, (charger.xy,))


def _of_robot(start: Start, needs: Any) -> Iterator[Finding]:
    known = [need for need in needs if need is not None]
    if not known:
        yield Finding('out_of_charge', start.spec.name, 'no way leads from its start to any charger', start.where,
                      'add the lanes that are missing, or a charger', (start.xy,))
    elif min(known) > _charge(start):
        yield Finding('out_of_charge', start.spec.name, 'reaches no charger with the charge that it starts with: the '
                      'nearest takes {:.3g} kJ, it has {:.3g} kJ'.format(min(known) / 1e3, _charge(start) / 1e3),
                      start.where, _ADVICE, (start.xy,))


def _of_place(place: Target, chargers: Sequence[Target], groups: Sequence[Drivers]) -> Iterator[Finding]:
    """Yield the Finding of a place if a full battery is not enough from the nearest charger to it and on to one."""
    short: List[str] = []
    worst = 0.0
    for drivers in groups:
        battery: Any = drivers.settings.battery
        there = [energy_between(drivers, charger.pose, place.pose) for charger in chargers]
        back = [energy_between(drivers, place.pose, charger.pose) for charger in chargers]
        trips: Any = [min((need for need in one if need is not None), default=None) for one in (there, back)]
        if None not in trips and sum(trips) > battery.energy:
            short += [start.spec.name for start in drivers.starts]
            worst = worst or sum(trips) / battery.energy
    if short:
        yield Finding('out_of_charge', 'place {}'.format(place.name), 'from the nearest charger and on to one takes '
                      '{:.2f} of a full battery ({})'.format(worst, listed(short, 3)), place.where,
                      'take a larger battery (battery_capacity), or add a charger that is nearer', (place.xy,))


def _of_orders(world: World, chargers: Sequence[Target]) -> Iterator[Finding]:
    """Yield a Finding for each source of orders with some, of its first, for which no full battery is enough."""
    scenario = world.scenario
    settings = scenario.dispatcher or DispatchSettings()
    names = [drivers.starts[0].spec.name for drivers in world.drivers]  # robots that drive alike need the same
    starts = [start for start in starts_of(scenario) if start.name in names]
    ahead = LookAhead(settings.charge_reserve or 0.0, [charger.xy for charger in chargers],
                      Distances(scenario, settings.distances == 'ways'),
                      {one.name: one.takes for one in starts if one.takes is not None})
    robots = list(make_states(starts, ()).values())
    for index, source in enumerate(scenario.order_sources):
        orders = list(islice(source.orders(scenario.seed), _MOST_ORDERS))
        faults = [(order, fault) for order in orders for fault in [ahead.fault_of(order, robots)] if fault is not None]
        for order, fault in faults[:1]:
            yield Finding('out_of_charge', 'orders {}'.format(source.name), 'no robot can do {} of the first {} even '
                          'with a full battery; the first is {}: {}'.format(
                              len(faults), len(orders), order.order_id, fault.partition(': ')[2]),
                          '{}: orders[{}]'.format(os.path.basename(world.path), index),
                          'take a larger battery (battery_capacity), fewer or nearer stops, or add a charger that is '
                          'nearer', tuple((stop.pose.x, stop.pose.y) for stop in order.stops))
