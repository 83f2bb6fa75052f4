"""Find the stays of robots in zones, on lanes and at places, and their waits for these, from the rows of a log."""
import json
import math
from typing import NamedTuple

from .recording import is_number

INSIDE, WAITS = 0, 1


class Stay(NamedTuple):
    """``robot`` (its name) is INSIDE the thing with this number, or WAITS for it, from ``begin_ns`` to ``end_ns``."""

    begin_ns: int
    end_ns: int
    robot: str
    thing: int
    kind: int


def find_stays(recording, world):
    """Return the Stays of a Recording in a World, in the order in which they began.

    Any program may write rows; those that name nothing of the world are ignored. Rows about work at a place without a
    capacity do not name the place, so it is found from where the robot stands.
    """
    if not world.things:
        return []
    reader = _Reader(world)
    handlers = {'entered': reader.entered, 'left': reader.left, 'held': reader.held, 'released': reader.held,
                'works_at': reader.works_at, 'task_began': reader.task_began, 'task_ended': reader.task_ended,
                'waiting_began': reader.waits_at, 'waiting_ended': reader.waited_at, 'stands': reader.stands,
                'charging_began': reader.charging_began, 'charging_ended': reader.charging_ended}
    for time_ns, name, kind, text in recording:
        handler = handlers.get(kind)
        if handler is not None:
            reader.now_ns = time_ns
            handler(name, json.loads(text))
    reader.now_ns = recording.end_ns + 1  # a stay that has not ended lasts through the last instant, too
    for robot in list(reader.robots):
        reader.keep(robot, lambda _thing, _kind: False)
    return [stay for _, stay in sorted(reader.found)]


class _Reader:
    """Takes rows one after the other; ``found``: the stays that have ended, each with the number of its begin."""

    def __init__(self, world):
        self.now_ns = 0
        self.robots = {}  # {robot: {(thing, kind): (number, since [ns])}}
        self.found = []
        self._things = world.things
        self._numbers = world.numbers
        self._positions = {}
        self._begun = 0

    def _begin(self, robot, name, kind):
        thing = self._numbers.get(name) if isinstance(name, str) else name
        own = self.robots.setdefault(robot, {})
        if thing is not None and (thing, kind) not in own:
            own[thing, kind] = self._begun, self.now_ns
            self._begun += 1

    def keep(self, robot, is_kept):
        """End the stays of a robot, except those for which ``is_kept(thing, kind)`` is true."""
        own = self.robots.get(robot, {})
        for thing, kind in [key for key in own if not is_kept(*key)]:
            number, since_ns = own.pop((thing, kind))
            if self.now_ns > since_ns:
                self.found.append((number, Stay(since_ns, self.now_ns, robot, thing, kind)))

    def _end(self, robot, name, kind):
        wanted = self._numbers.get(name), kind
        self.keep(robot, lambda thing, kind: (thing, kind) != wanted)

    def _is_place(self, thing):
        return self._things[thing]['kind'] == 'place'

    def entered(self, robot, values):
        """Take a row: the robot got room in a zone or on a lane."""
        self._begin(robot, _text(values, 0), INSIDE)

    def left(self, robot, values):
        """Take a row: the robot left the zone or lane."""
        self._end(robot, _text(values, 0), INSIDE)

    def held(self, robot, values):
        """Take a row: the robot is held for these reasons only. A reason names zones and lanes, separated by commas."""
        wanted = {}
        for value in values:
            names = [value] if str(value) in self._numbers else str(value).split(', ')
            wanted.update((self._numbers[name], name) for name in names if name in self._numbers)
        self.keep(robot, lambda thing, kind: kind == INSIDE or self._is_place(thing) or thing in wanted)
        for name in wanted.values():
            self._begin(robot, name, WAITS)

    def works_at(self, robot, values):
        """Take a row: the robot works at a place with a capacity."""
        self._begin(robot, 'place ' + _text(values, 1), INSIDE)

    def task_began(self, robot, _values):
        """Take a row: the robot works, perhaps at a place that the log has not named."""
        x, y = self._positions.get(robot, (math.inf, math.inf))
        if any(self._is_place(thing) and kind == INSIDE for thing, kind in self.robots.get(robot, ())):
            return
        for number, thing in enumerate(self._things):
            if thing['kind'] == 'place' and math.dist((x, y), thing['points'][0]) <= thing['reach']:
                self._begin(robot, number, INSIDE)
                return

    def task_ended(self, robot, _values):
        """Take a row: the robot neither works any more nor waits for a place."""
        self.keep(robot, lambda thing, _kind: not self._is_place(thing))

    def waits_at(self, robot, values):
        """Take a row: the robot waits for a place to work at."""
        self._begin(robot, 'place ' + _text(values, 1), WAITS)

    def waited_at(self, robot, values):
        """Take a row: the robot does not wait for the place any more."""
        self._end(robot, 'place ' + _text(values, 1), WAITS)

    def charging_began(self, robot, values):
        """Take a row: the robot is charged. In a zone with a capacity, `entered` has said so already."""
        number = self._numbers.get('zone ' + _text(values, 0))
        if number is not None and self._things[number]['capacity'] is None:
            self._begin(robot, number, INSIDE)

    def charging_ended(self, robot, values):
        """Take a row: the robot is not charged any more."""
        number = self._numbers.get('zone ' + _text(values, 0))
        if number is not None and self._things[number]['capacity'] is None:
            self._end(robot, 'zone ' + _text(values, 0), INSIDE)

    def stands(self, robot, values):
        """Take a row: the robot stands at (x, y, yaw)."""
        if len(values) == 3 and all(map(is_number, values)):
            self._positions[robot] = tuple(values[:2])


def _text(values, place):
    return str(values[place]) if len(values) > place else ''
