"""The goals of a mission's robots, from a seed: for each robot by itself, or in rounds that begin together.

Each kind of mission has a method ``goals(idle, poses, now)``, which says which of the idle robots get which goal now.
It keeps its own state. All draws follow from the mission's seed.
"""
import math
import random

from legs import angle

_REST = 1.0  # s between two goals
_LATER = 3.0  # s: longest delay of a robot after the begin of its round
_BEHIND = math.radians(120.0)
_CLASSES = (('short', 1.0, 5.0), ('medium', 5.0, 20.0), ('long', 20.0, math.inf))  # m
_GATHER = 2.0  # m
_APART = 0.8  # m between places to which robots go at the same time


class ByThemselves:
    """Each robot by itself: random goals, or goals behind it (``kind``: random, turns)."""

    def __init__(self, kind, place, robots, seed):
        self._kind, self._place = kind, place
        self._chances = [random.Random('{} {} {}'.format(kind, seed, robot)) for robot in range(robots)]
        self._since = [None] * robots  # s: since when it is idle
        self._goals = [None] * robots

    def goals(self, idle, poses, now):
        """Return [(robot, class, (x, y, yaw))]."""
        new = []
        for robot, pose in enumerate(poses):
            if robot not in idle:
                self._since[robot] = None
            elif self._since[robot] is None:
                self._since[robot] = now
            elif now - self._since[robot] >= _REST - 1e-6:
                others = [goal for other, goal in enumerate(self._goals) if goal and other != robot]
                others += [poses[other] for other in idle if other != robot]
                name, self._goals[robot] = self._goal(self._chances[robot], pose, others)
                new.append((robot, name, self._goals[robot]))
        return new

    def _goal(self, chance, pose, others):
        name, low, high = chance.choice(_CLASSES[:2] if self._place.width < 25.0 else _CLASSES)
        for attempt in range(20000):
            x, y = self._place.point(chance)
            distance = math.hypot(x - pose[0], y - pose[1])
            if attempt < 10000 and not (low <= distance <= high):
                continue
            behind = abs(angle(math.atan2(y - pose[1], x - pose[0]) - pose[2])) > _BEHIND
            if distance >= low and (behind or self._kind == 'random') and _free(x, y, others):
                break
        return self._kind if self._kind == 'turns' else name, (x, y, chance.uniform(-math.pi, math.pi))


def _free(x, y, others):
    return all(math.hypot(x - other[0], y - other[1]) >= _APART for other in others)


class Rounds:
    """All robots begin together and wait for each other (``kind``: headon, crossing, stander, gather)."""

    def __init__(self, kind, place, robots, seed):
        self._kind, self._place, self._robots = kind, place, robots
        self._chance = random.Random('{} {}'.format(kind, seed))
        self._ahead = []  # next rounds: (class, {robot: (x, y, yaw)})
        self._due = []  # of the present round: (s, robot, class, goal)
        self._rest = None  # s: since when all robots are idle

    def goals(self, idle, poses, now):
        """Return [(robot, class, (x, y, yaw))]."""
        if not self._due and len(idle) < self._robots:
            self._rest = None
        elif not self._due:
            self._rest = now if self._rest is None else self._rest
            if now - self._rest >= _REST - 1e-6:
                self._begin(now)
        new = [due for due in self._due if due[0] <= now + 1e-6 and due[1] in idle]
        self._due = [due for due in self._due if due not in new]
        return [due[1:] for due in new]

    def _begin(self, now):
        if not self._ahead:
            self._ahead = getattr(self, '_' + self._kind)()
        name, goals = self._ahead.pop(0)
        delays = [0.0] + [self._chance.uniform(0.0, _LATER) for _ in range(self._robots - 1)]
        self._chance.shuffle(delays)
        self._due = [(now + delays[robot], robot, name, goal) for robot, goal in sorted(goals.items())]
        self._rest = None

    def _swaps(self, ends, times=2, stay=()):
        """Return rounds: to the first of the two ``ends`` of each robot, then ``times`` times from end to end."""
        first = {robot: (*a, _heading(a, b)) for robot, (a, b) in ends.items()}
        rounds = [('position', {**first, **dict(stay)})]
        for number in range(times):
            pairs = {robot: pair if number % 2 == 0 else pair[::-1] for robot, pair in ends.items()}
            rounds.append((self._kind, {robot: (*b, self._end_yaw(a, b)) for robot, (a, b) in pairs.items()}))
        return rounds

    def _end_yaw(self, a, b):
        """Return the heading of the way, or of the way back, or a random one [rad]."""
        way = _heading(a, b)
        return self._chance.choice((way, angle(way + math.pi), self._chance.uniform(-math.pi, math.pi)))

    def _lane_ends(self, lane):
        """Return two places near the lane's ends, on its middle line, or beside that if the lane is wide."""
        (x0, y0), (x1, y1) = lane.start, lane.end
        length = math.hypot(x1 - x0, y1 - y0)
        aside = self._chance.uniform(-1.0, 1.0) * max(0.0, min(lane.width / 2.0 - 0.5, 0.6))
        across = (-(y1 - y0) / length * aside, (x1 - x0) / length * aside)
        return (x0 + across[0], y0 + across[1]), (x1 + across[0], y1 + across[1])

    def _headon(self):
        lanes = self._chance.sample(self._place.lanes, (self._robots + 1) // 2)
        robots = list(range(self._robots))
        self._chance.shuffle(robots)
        ends = {}
        for number, robot in enumerate(robots):
            a, b = self._lane_ends(lanes[number // 2])
            ends[robot] = (a, b) if number % 2 == 0 else (b, a)
        return self._swaps(ends)

    def _crossing(self):
        middle, arm, width = self._chance.choice(self._place.junctions)
        way = self._chance.uniform(-0.3, 0.3) * max(0.0, min(width / 2.0 - 0.5, 1.0))
        corners = [(middle[0] + way, middle[1] + arm), (middle[0] + arm, middle[1] - way),
                   (middle[0] - way, middle[1] - arm), (middle[0] - arm, middle[1] + way)]
        reachable = [number for number in range(4) if self._place.clearance(*corners[number]) > 0.3]
        starts = self._chance.sample(reachable, self._robots)
        ends, taken = {}, set()
        for robot, number in sorted(enumerate(starts), key=lambda start: (start[1] + 2) % 4 not in reachable):
            free = [other for other in reachable if other != number and other not in taken]
            to = (number + 2) % 4 if (number + 2) % 4 in free else self._chance.choice(free or reachable)
            taken.add(to)
            ends[robot] = (corners[number], corners[to])
        return self._swaps(ends)

    def _stander(self):
        lane = self._chance.choice([lane for lane in self._place.lanes if lane.width >= 1.5])
        stander = self._chance.randrange(self._robots)
        a, b = self._lane_ends(lane)
        share = self._chance.uniform(0.35, 0.65)
        aside = self._chance.uniform(-1.0, 1.0) * min(0.8, lane.width / 2.0 - 0.35)
        way = _heading(lane.start, lane.end)
        middle = [p + (q - p) * share for p, q in zip(lane.start, lane.end)]
        stands = (middle[0] - math.sin(way) * aside, middle[1] + math.cos(way) * aside,
                  self._chance.uniform(-math.pi, math.pi))
        movers = [robot for robot in range(self._robots) if robot != stander]
        ends = {}
        for number, robot in enumerate(movers):  # one behind the other
            shift = [(q - p) * 0.1 * number for p, q in zip(a, b)]
            ends[robot] = (a[0] + shift[0], a[1] + shift[1]), (b[0] - shift[0], b[1] - shift[1])
        return self._swaps(ends, stay=((stander, stands),))

    def _gather(self):
        x, y = self._place.point(self._chance)
        places = []
        while len(places) < self._robots:
            spot = self._place.point(self._chance)
            if math.hypot(spot[0] - x, spot[1] - y) <= _GATHER and _free(*spot, places):
                places.append(spot)
        return [('gather', {robot: (*spot, self._chance.uniform(-math.pi, math.pi))
                            for robot, spot in enumerate(places)})]


def _heading(a, b):
    return math.atan2(b[1] - a[1], b[0] - a[0])


def mission(kind, place, robots, seed):
    """Return the goals of a kind of mission.

    :raises SystemExit: if there is no such kind.
    """
    if kind in ('random', 'turns'):
        return ByThemselves(kind, place, robots, seed)
    if kind in ('headon', 'crossing', 'stander', 'gather'):
        return Rounds(kind, place, robots, seed)
    raise SystemExit('{}: no kind of mission; allowed: random, turns, headon, crossing, stander, gather'.format(kind))


def starts(place, robots, seed):
    """Return where the robots stand at first, (x, y, yaw in degrees), at least 2 m apart."""
    chance, found = random.Random('starts {}'.format(seed)), []
    while len(found) < robots:
        x, y = place.point(chance)
        if all(math.hypot(x - other[0], y - other[1]) >= 2.0 for other in found):
            found.append((x, y, chance.uniform(-180.0, 180.0)))
    return found
