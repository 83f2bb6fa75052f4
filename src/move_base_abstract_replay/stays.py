"""The stays of robots in zones, on lanes and at places, and the phases of orders, as the page shows them."""
from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from move_base_abstract.runs.orders_of_run import FAILED, LATE
from move_base_abstract.runs.story import CHARGES, WAITS, WORKS

from .recording import is_number

if TYPE_CHECKING:
    from move_base_abstract.runs.orders_of_run import Order, Orders, Phase
    from move_base_abstract.runs.story import Stay, Story

    from .recording import Recording
    from .world import World

#: kinds of Stays on the page, and of Phases
IS_THERE, IS_WAITING = 0, 1
OPEN, ASSIGNED = 0, 1


class ThingStay(NamedTuple):
    """``robot`` (its name) is at the thing with this number, or waits for it, from ``begin_ns`` to ``end_ns``."""

    begin_ns: int
    end_ns: int
    robot: str
    thing: int
    kind: int


def find_stays(story: Story, world: World) -> List[ThingStay]:
    """Return the ThingStays of a Story in a World, in the order in which they began.

    Any program may write rows; those that name nothing of the world are ignored.
    """
    numbers = world.numbers
    found = []
    for stay in story.stays:
        thing = _thing_of(stay, world.things, numbers)
        if thing is not None:
            kind = IS_WAITING if stay.what == WAITS else IS_THERE
            found.append(ThingStay(stay.begin_ns, _shown_until(stay), stay.robot, thing, kind))
    return found


class LimitChange(NamedTuple):
    """From ``time_ns`` on the speed limit of the thing with this number is ``speed`` [m/s], 0: none."""

    time_ns: int
    thing: int
    speed: float


def find_limits(recording: Recording, world: World) -> List[LimitChange]:
    """Return the changes of the zones' speed limits in a Recording, in their order."""
    numbers, found = world.numbers, []
    for time_ns, _, kind, text in recording:
        values: Sequence[Any] = json.loads(text) if kind == 'zone_limit' else ()
        if len(values) == 2 and 'zone {}'.format(values[0]) in numbers and is_number(values[1]):
            found.append(LimitChange(time_ns, numbers['zone {}'.format(values[0])], float(values[1])))
    return found


def _thing_of(stay: Stay, things: Sequence[Dict[str, Any]], numbers: Mapping[str, int]) -> Optional[int]:
    """Return the number of the thing at which a Stay is, or None."""
    if stay.what == CHARGES:  # in a zone with a capacity, `entered` has said so already
        number = numbers.get('zone ' + stay.where)
        return None if number is None or things[number]['capacity'] is not None else number
    if stay.what == WORKS and not stay.where:  # the rows about work at a place without a capacity do not name it
        return next((number for number, thing in enumerate(things) if thing['kind'] == 'place'
                     and math.dist(stay.at or (math.inf, math.inf), thing['points'][0]) <= thing['reach']), None)
    return numbers.get(stay.where)


def _shown_until(span: Union[Phase, Stay]) -> int:
    """Return when a Stay or Phase ends; one that is open at the end of the run lasts through the last instant, too."""
    return span.end_ns + span.is_open


class OrderPhase(NamedTuple):
    """A time in which ``order`` (its name) is OPEN (``robot`` is ''), or ASSIGNED to ``robot``.

    Its next stop is at (x, y) [m].
    """

    begin_ns: int
    end_ns: int
    order: str
    kind: int
    robot: str
    x: float
    y: float
    stop: int  # the number of the next stop, from 1 on
    stops: int  # the number of all stops


def find_phases(orders: Orders) -> List[OrderPhase]:
    """Return the OrderPhases of the Orders of a Story in the order of their begins."""
    found = [OrderPhase(phase.begin_ns, _shown_until(phase), order.name, ASSIGNED if phase.robot else OPEN, phase.robot,
                        *order.stops[phase.stop - 1], phase.stop, len(order.stops))
             for order in _drawn(orders) for phase in order.phases]
    return sorted(found, key=lambda phase: phase.begin_ns)


def count_orders(orders: Orders) -> List[Tuple[int, ...]]:
    """Return [(time [ns], open, assigned, done, late, failed, refused)] whenever a number of orders changes."""
    changes: Dict[Any, Any] = {}

    def change(time_ns: int, column: int, by: int) -> None:
        changes.setdefault(time_ns, [0] * 6)[column] += by
    for order in _drawn(orders):
        for phase in order.phases:
            change(phase.begin_ns, ASSIGNED if phase.robot else OPEN, 1)
            if not phase.is_open:
                change(phase.end_ns, ASSIGNED if phase.robot else OPEN, -1)
        if order.ended_ns is not None:
            change(order.ended_ns, {LATE: 3, FAILED: 4}.get(order.code, 2), 1)
    for time_ns in orders.refused:
        change(time_ns, 5, 1)
    counts, now = [], [0] * 6
    for time_ns, by in sorted(changes.items()):
        now = [count + more for count, more in zip(now, by)]
        counts.append((time_ns, *now))
    return counts


def _drawn(orders: Orders) -> List[Order]:
    """Return the orders whose stops have places. Any program may write rows."""
    return [order for order in orders.all.values()
            if order.stops and all(is_number(one) for stop in order.stops for one in stop)]
