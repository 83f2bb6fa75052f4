"""Check charge: chargers that robots cannot reach with their first charge, and places too far from any charger."""
import os

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.energy.consumption import LegEnergy

from .findings import Finding, listed
from .ways import MOST_WAYS, leg_between

_ADVICE = 'start with more (battery_start), take a larger battery (battery_capacity), or add a charger that is nearer'


def check_charge(world):
    """Yield a :class:`.Finding` for each charger, robot and place with such a problem, by the batteries' formula."""
    chargers = [target for target in world.targets if target.what == 'charger']
    places = [target for target in world.targets if target.what == 'place']
    groups = [drivers for drivers in world.drivers if drivers.settings.battery is not None]
    starts = [(drivers, start) for drivers in groups for start in drivers.starts]
    if not chargers or not groups:
        return
    if (len(starts) + 2 * len(places) * len(groups)) * len(chargers) > MOST_WAYS:
        yield Finding('not_checked', 'charge', '{} robots, {} places and {} chargers are more than {} ways'.format(
            len(starts), len(places), len(chargers), MOST_WAYS), os.path.basename(world.path),
            'check a scenario with fewer of them')
        return
    needs = [[energy_between(drivers, start.spec.settings.start, charger.pose) for charger in chargers]
             for drivers, start in starts]
    for number, charger in enumerate(chargers):
        yield from _of_charger(charger, starts, [need[number] for need in needs])
    for (_, start), need in zip(starts, needs):
        yield from _of_robot(start, need)
    for place in places:
        yield from _of_place(place, chargers, groups)


def energy_between(drivers, begin, goal):
    """Return the energy [J] that a robot of ``drivers`` needs from ``begin`` to ``goal`` (Pose2D); None: no way."""
    leg, battery = leg_between(drivers, begin, goal), drivers.settings.battery
    if leg is None:
        return None
    return (LegEnergy(leg, battery.mechanics).until(leg.arrive_ns)
            + battery.ambient_power * (leg.arrive_ns - leg.depart_ns) / NS_PER_S)


def _charge(start):
    battery = start.spec.settings.battery
    return battery.start * battery.energy


def _of_charger(charger, starts, needs):
    known = [(need - _charge(start), need, start) for (_, start), need in zip(starts, needs) if need is not None]
    if known and all(missing > 0.0 for missing, _, _ in known):
        _, need, start = min(known, key=lambda one: one[0])
        yield Finding('out_of_charge', 'charger {}'.format(charger.name), 'no robot gets there with the charge that it '
                      'starts with; nearest to it comes {}, which takes {:.3g} kJ and has {:.3g} kJ'.format(
                          start.spec.name, need / 1e3, _charge(start) / 1e3), charger.where, _ADVICE, (charger.xy,))


def _of_robot(start, needs):
    known = [need for need in needs if need is not None]
    if not known:
        yield Finding('out_of_charge', start.spec.name, 'no way leads from its start to any charger', start.where,
                      'add the lanes that are missing, or a charger', (start.xy,))
    elif min(known) > _charge(start):
        yield Finding('out_of_charge', start.spec.name, 'reaches no charger with the charge that it starts with: the '
                      'nearest takes {:.3g} kJ, it has {:.3g} kJ'.format(min(known) / 1e3, _charge(start) / 1e3),
                      start.where, _ADVICE, (start.xy,))


def _of_place(place, chargers, groups):
    """Yield the Finding of a place if a full battery is not enough from the nearest charger to it and on to one."""
    short, worst = [], None
    for drivers in groups:
        there = [energy_between(drivers, charger.pose, place.pose) for charger in chargers]
        back = [energy_between(drivers, place.pose, charger.pose) for charger in chargers]
        trips = [min((need for need in one if need is not None), default=None) for one in (there, back)]
        if None not in trips and sum(trips) > drivers.settings.battery.energy:
            short += [start.spec.name for start in drivers.starts]
            worst = worst or sum(trips) / drivers.settings.battery.energy
    if short:
        yield Finding('out_of_charge', 'place {}'.format(place.name), 'from the nearest charger and on to one takes '
                      '{:.2f} of a full battery ({})'.format(worst, listed(short, 3)), place.where,
                      'take a larger battery (battery_capacity), or add a charger that is nearer', (place.xy,))
