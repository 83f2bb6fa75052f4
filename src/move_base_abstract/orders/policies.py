"""Which robot gets which order: the policies of this package, and the interface of a user's own policy.

A policy is an object with ``choose(question)``, which returns the pairs (robot's name, order's id) that begin now. All
ties are broken by higher priority, then by earlier arrival, then by the name of the robot.

A class below ``@_policy`` is one of this package: settings, texts and pages have its name from :data:`POLICIES`.
"""
from __future__ import annotations

import importlib
import os
import sys
from bisect import bisect_left, bisect_right
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Protocol, Sequence, Tuple, Type

from ..common.errors import ConfigurationError
from .order import Order

Point = Tuple[float, float]
Pair = Tuple[str, str]
#: (robot's name, point, point) -> the robot's distance between the points [mm], None: there is no way
Distance = Callable[[str, Point, Point], Optional[int]]


class OpenOrder(NamedTuple):
    """An order that no robot does.

    ``deadline_ns``: an instant [ns], None: there is none. ``tried``: the number of failed attempts; those that ended
    because the robot failed, ran out of charge or got another goal do not count.
    """

    order: Order
    arrived_ns: int
    deadline_ns: Optional[int]
    tried: int
    next_stop: int  # index of the first stop that is still to be done

    @property
    def points(self) -> List[Point]:
        """The positions of the stops that are still to be done [m]."""
        return [(stop.pose.x, stop.pose.y) for stop in self.order.stops[self.next_stop:]]


class FreeRobot(NamedTuple):
    """A robot that could begin with an order now, and where it is [m].

    In ``Question.busy`` it is a robot that could begin later, and where it will be then. ``begun``, ``done``: the
    numbers of orders that it has begun and done so far; ``busy_ns``: for how long it has had orders [ns].
    """

    name: str
    x: float
    y: float
    begun: int = 0
    done: int = 0
    busy_ns: int = 0


def _never(_robot: str, _one: OpenOrder) -> bool:
    return False


class Question(NamedTuple):
    """The question to a policy.

    ``orders``: the open orders by priority, then by arrival. ``robots``: the free robots; ``busy``: robots that have an
    order, with their position after it; both by index. ``distance(robot, begin, end)`` returns mm, None: there is no
    way. ``now_ns``: the present instant [ns]. ``is_short(robot's name, order)``: whether a free robot lacks the charge
    for an order, which it then refuses; of a robot that has an order it is False.
    """

    orders: Sequence[OpenOrder]
    robots: Sequence[FreeRobot]
    busy: Sequence[FreeRobot]
    now_ns: int
    distance: Distance
    is_short: Callable[[str, OpenOrder], bool] = _never

    def away(self, robot: FreeRobot, one: OpenOrder) -> Optional[int]:
        """Return the distance of a free robot from an order's next stop [mm].

        None: there is no way, or the robot lacks the charge for the order.
        """
        return None if self.is_short(robot.name, one) else self.distance(robot.name, (robot.x, robot.y), one.points[0])


class Policy(Protocol):
    """Decides which robot gets which order."""

    def choose(self, question: Question) -> Iterable[Pair]:
        """Return all pairs (robot's name, order's id) that begin now; each robot and each order at most once."""
        ...


class Known(NamedTuple):
    """A policy of this package: what makes it, and its rule in words, for the page."""

    make: Callable[[], Policy]
    rule: str


#: {name: Known}
POLICIES: Dict[str, Known] = {}


def _policy(name: str, rule: str) -> Callable[[Type[Any]], Type[Any]]:
    """Return what adds a class to :data:`POLICIES`."""
    def add(cls: Type[Any]) -> Type[Any]:
        POLICIES[name] = Known(cls, rule)
        return cls
    return add


@_policy('nearest', 'each order in turn goes to the free robot that is nearest to its first stop')
class Nearest:
    """Each order goes to the free robot that is nearest to its next stop; orders by priority, then by arrival."""

    def choose(self, question: Question) -> List[Pair]:
        """Return the pairs (robot's name, order's id) that begin now."""
        return nearest_for(question, question.orders)


@_policy('earliest_deadline', 'the same, but of one priority the order with the earliest deadline comes first, and '
         'orders without a deadline come last')
class EarliestDeadline:
    """As :class:`Nearest`, but among orders of one priority the order with the earliest deadline comes first."""

    def choose(self, question: Question) -> List[Pair]:
        """Return the pairs (robot's name, order's id) that begin now."""
        return nearest_for(question, sorted(question.orders, key=lambda one: (
            -one.order.priority, one.deadline_ns is None, one.deadline_ns or 0)))


def nearest_for(question: Question, orders: Iterable[OpenOrder]) -> List[Pair]:
    """Return (robot's name, order's id) for each of ``orders`` in turn, with the nearest robot that is left."""
    left, pairs = list(question.robots), []
    for one in orders:
        if not left:
            break
        bids = [(away, index) for index, away in enumerate(question.away(robot, one) for robot in left)
                if away is not None]
        if bids:
            pairs.append((left.pop(min(bids)[1]).name, one.order.order_id))
    return pairs


@_policy('auction', 'each order is sold as it comes, to the robot whose whole tour is the shortest with it. Busy '
         'robots bid, too, from the point where their order ends')
class Auction:
    """Each order is sold, as it arrives, to the robot whose whole tour with it is the shortest; busy robots bid, too.

    A tour is in the order of priorities; among orders of one priority, a new one goes where it adds the least length.
    Orders that were sold to a robot that has gone to charge or has failed are sold again.
    """

    def __init__(self) -> None:
        self._tours: Dict[str, List[str]] = {}

    def choose(self, question: Question) -> List[Pair]:
        """Return the pairs (robot's name, order's id) that begin now."""
        bidders = {robot.name: robot for robot in (*question.robots, *question.busy)}
        orders = {one.order.order_id: one for one in question.orders}
        self._tours = {name: [key for key in self._tours.get(name, ()) if key in orders
                              and not question.is_short(name, orders[key])] for name in bidders}
        sold = {key for tour in self._tours.values() for key in tour}
        unsold = [one for key, one in orders.items() if key not in sold]
        tours = [_Tour(robot, self._tours[name], orders, question.distance)
                 for name, robot in bidders.items()] if unsold else []
        for one in unsold:
            _sell(one, [tour for tour in tours if not question.is_short(tour.name, one)])
        return [(robot.name, self._tours[robot.name].pop(0)) for robot in question.robots if self._tours[robot.name]]


class _Tour:
    """A robot's tour with the lengths of its parts, so that a bid looks up only the ways to and from the new order."""

    def __init__(self, robot: FreeRobot, keys: List[str], orders: Dict[str, OpenOrder], distance: Distance) -> None:
        self._robot = robot
        self.name = robot.name
        self._keys = keys  # the orders' ids, in the order of the tour
        self._distance = distance
        self._turns = [-orders[key].order.priority for key in keys]
        self._points = [orders[key].points for key in keys]
        self._measure()

    def _away(self, begin: Point, end: Point) -> Optional[int]:
        return self._distance(self._robot.name, begin, end)

    def _measure(self) -> None:
        self._ends = [(self._robot.x, self._robot.y), *(points[-1] for points in self._points)]
        self._ways = [self._away(end, points[0]) for end, points in zip(self._ends, self._points)]
        self._whole = _sum([*self._ways, *(self._inside(points) for points in self._points)])

    def _inside(self, points: Sequence[Point]) -> Optional[int]:
        return _sum([self._away(*pair) for pair in zip(points, points[1:])])

    def insert(self, place: int, one: OpenOrder) -> None:
        """Put an order at ``place``."""
        self._keys.insert(place, one.order.order_id)
        self._turns.insert(place, -one.order.priority)
        self._points.insert(place, one.points)
        self._measure()

    def bid(self, one: OpenOrder) -> Optional[Tuple[int, int]]:
        """Return (length of the tour with ``one`` [mm], its best index in the tour), or None if there is no way."""
        points, turn, bids = one.points, -one.order.priority, []
        inside = self._inside(points)
        if self._whole is None or inside is None:
            return None
        for place in range(bisect_left(self._turns, turn), bisect_right(self._turns, turn) + 1):
            there = self._away(self._ends[place], points[0])
            on, without = (self._away(points[-1], self._points[place][0]), self._ways[place] or 0) if place < len(
                self._points) else (0, 0)
            if there is not None and on is not None:
                bids.append((self._whole + inside + there + on - without, place))
        return min(bids) if bids else None


def _sell(one: OpenOrder, tours: Sequence[_Tour]) -> None:
    bids = [(bid[0], index, bid[1]) for index, bid in enumerate(tour.bid(one) for tour in tours) if bid is not None]
    if bids:
        _, index, place = min(bids)
        tours[index].insert(place, one)


def _sum(parts: Sequence[Optional[int]]) -> Optional[int]:
    """Return the sum, None: there is no way for a part."""
    return None if None in parts else sum(part for part in parts if part is not None)


@_policy('batch', 'all open orders of one priority and all free robots are matched at once, with the least sum of '
         'ways to first stops (`scipy.optimize.linear_sum_assignment`; this needs scipy)')
class Batch:
    """Assigns all open orders of a priority to free robots at once, with the least sum of the ways to their next stops.

    It needs scipy. Of equally good assignments it takes the one that scipy.optimize.linear_sum_assignment finds.

    :raises ConfigurationError: if scipy is not installed.
    """

    _NO_WAY = 10 ** 12  # mm

    def __init__(self) -> None:
        try:
            from scipy.optimize import linear_sum_assignment
        except ImportError as error:
            raise ConfigurationError('policy: batch needs scipy, which is not installed ({}); allowed without it: '
                                     '{}'.format(error, ', '.join(name for name, one in POLICIES.items()
                                                                  if one.make is not Batch))) from error
        self._assign = linear_sum_assignment

    def choose(self, question: Question) -> List[Pair]:
        """Return the pairs (robot's name, order's id) that begin now."""
        left, pairs = list(question.robots), []
        for priority in sorted({one.order.priority for one in question.orders}, reverse=True):
            orders = [one for one in question.orders if one.order.priority == priority]
            if not left:
                break
            costs = [[self._NO_WAY if away is None else away for away in (
                question.away(robot, one) for one in orders)] for robot in left]
            found = [(int(row), int(column)) for row, column in zip(*self._assign(costs))
                     if costs[row][column] < self._NO_WAY]
            pairs += [(left[row].name, orders[column].order.order_id) for row, column in found]
            gone = {row for row, _ in found}
            left = [robot for row, robot in enumerate(left) if row not in gone]
        return pairs


_FOUND = '; modules are looked for in installed packages and PYTHONPATH'


def _module(name: str) -> Any:
    """Import a module, but not from the working folder or that of the program, unless PYTHONPATH names them."""
    asked = {os.path.realpath(one) for one in os.environ.get('PYTHONPATH', '').split(os.pathsep) if one}
    started = os.path.dirname(getattr(sys.modules.get('__main__'), '__file__', None) or sys.argv[0])
    never = {os.path.realpath(one) for one in ('.', started)} - asked
    before = sys.path[:]
    sys.path[:] = [one for one in before if os.path.realpath(one) not in never]
    try:
        return importlib.import_module(name)
    finally:
        sys.path[:] = before


def make_policy(name: str, where: str) -> Policy:
    """Return a new policy: one of :data:`POLICIES`, or an instance of a user's class 'module:Class'.

    The module is an installed one, one of PYTHONPATH, or one that the program has imported; a file that somebody else
    wrote cannot have a module beside it, or in the working folder, run.

    :raises ConfigurationError: if there is no such class, it cannot be made, or it has no ``choose``; the text of these
        begins with ``where``.
    """
    if name in POLICIES:
        return POLICIES[name].make()
    module, _, attribute = name.partition(':')
    try:
        made: Any = getattr(_module(module), attribute)()
    except Exception as error:
        raise ConfigurationError('{}: policy: {} cannot be made: {}: {}{}'.format(
            where, name, type(error).__name__, error, _FOUND if isinstance(error, ImportError) else '')) from error
    if not callable(getattr(made, 'choose', None)):
        raise ConfigurationError('{}: policy: {} has no method choose; allowed: a class with choose(question)'.format(
            where, name))
    return made  # type: ignore[no-any-return]
