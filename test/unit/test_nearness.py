"""When robots meet: what the closed form finds against steps of a millisecond, for pairs of legs of all laws."""
import math
import random

import pytest

from move_base_abstract.encounters.control import find_stay, kind_of, next_meeting
from move_base_abstract.encounters.nearness import closest, distance, windows
from move_base_abstract.encounters.neighbours import Neighbours
from move_base_abstract.encounters.track import Track
from move_base_abstract.motion.calibration import read_calibration
from move_base_abstract.motion.encounter_law import CROSSING, HEAD_ON, OVERTAKING, STANDING
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import Leg, MotionLimits, Tolerances
from move_base_abstract.motion.pace import Pace, PacedLeg
from move_base_abstract.motion.phased_route import PhasedRoute
from move_base_abstract.motion.pieces import pose_of, stand
from move_base_abstract.motion.planned_way import PieceLimit, PlannedWay
from move_base_abstract.motion.route import CornerLaw, Route
from move_base_abstract.motion.told import ToldMotion

MS = 1_000_000
FASTEST = 4.0  # m/s, of the robots of this page: 2.0 by their limits, and a pace that doubles it
STAGE = read_calibration('move_base_dwa_stage', 'test')


def make_leg(chance, side, depart_ns):
    """Return a leg of one of the laws of motion, between places on a square of ``side`` [m]."""
    def pose():
        return Pose2D(chance.uniform(0.0, side), chance.uniform(0.0, side), chance.uniform(-3.0, 3.0))
    start, goal = pose(), pose()
    corners = tuple((chance.uniform(0.0, side), chance.uniform(0.0, side)) for _ in range(chance.randrange(4)))
    limits = MotionLimits(chance.uniform(0.3, 2.0), chance.choice([math.inf, 0.4, 1.5]), chance.choice([math.inf, 1.0]))
    tolerances = chance.choice([Tolerances(), Tolerances(0.1, 0.2)])
    kind = chance.choice(['leg', 'route', 'phased', 'lanes', 'arcs'])
    if kind == 'arcs':
        return arcs(chance, start, depart_ns)
    if kind == 'leg':
        leg = Leg(start, goal, limits, tolerances, depart_ns)
    elif kind == 'route':
        leg = Route(start, goal, corners, limits, tolerances, depart_ns, chance.choice(list(CornerLaw)))
    elif kind == 'lanes':
        way = PlannedWay(corners, [PieceLimit(chance.uniform(0.2, 1.0)) for _ in range(len(corners) + 1)])
        leg = Route(start, goal, way, limits, tolerances, depart_ns)
    else:
        leg = PhasedRoute(start, goal, corners, STAGE.limits, STAGE.phases, STAGE.tolerances, depart_ns)
    if chance.random() < 0.5:
        leg = PacedLeg(leg, Pace(chance.choice([0, 500 * MS, 7_123_456_789]), chance.uniform(0.5, 2.0)))
    return leg


def arcs(chance, pose, begin_ns):
    """Return a motion of a robot that is driven by velocities, from ``pose`` (Pose2D) on."""
    pieces = []
    for _ in range(chance.randrange(1, 6)):
        pieces.append(stand(pose, begin_ns)._replace(v=chance.uniform(-2.0, 2.0), w=chance.uniform(-1.0, 1.0), k=-1.0))
        begin_ns += chance.randrange(1, 20_000) * MS
        pose = pose_of(pieces[-1], begin_ns)
    return ToldMotion([*pieces, stand(pose, begin_ns)])


def search(one, other, radius, now_ns):
    """Return when two tracks meet, as the cells of Neighbours let it be found."""
    neighbours = Neighbours(radius)
    neighbours.put(0, one)
    neighbours.put(1, other)
    found = neighbours.near(0, now_ns)
    assert [[(t.begin_ns, t.end_ns) for t in times] for _, times in found] == [
        [(t.begin_ns, t.end_ns) for t in times] for _, times in neighbours.near(1, now_ns)]
    return next_meeting(one, other, radius, found[0][1], now_ns) if found else None


def make_tracks(seed, radius):
    """Return two tracks, and the present [ns]: of a leg that is under way and another leg, or a robot that stands."""
    chance = random.Random(seed)
    side = chance.choice([6.0, 20.0, 60.0])
    first = make_leg(chance, side, 0)
    now_ns = chance.randrange(0, max(1, first.arrive_ns // 2))
    second = make_leg(chance, side, now_ns) if chance.random() < 0.8 else None
    reach = Neighbours(radius).side
    return Track(first, None, now_ns, reach), Track(second, second.start if second else Pose2D(
        chance.uniform(0.0, side), chance.uniform(0.0, side)), now_ns, reach), now_ns


def steps(one, other, levels, now_ns):
    """Yield steps of 1 ms [ns] and the distance of the two [m], but for steps at which it cannot have crossed a level.

    It stays on one side of each of ``levels`` [m] for as long as two robots of FASTEST need to come there.
    """
    at_ns, end_ns = now_ns, max(one.end_ns, other.end_ns) + 2 * MS
    while at_ns < end_ns:
        gap = distance(one, other, at_ns)
        yield at_ns, gap
        room = min(abs(gap - level) for level in levels)
        at_ns += MS * max(1, math.floor(1000.0 * room / (2.0 * FASTEST)))


def by_steps(one, other, radius, now_ns):
    """Return the first step of 1 ms [ns] at which they meet, or None."""
    first = distance(one, other, now_ns)
    was_near = first <= radius
    for _, gap in steps(one, other, [radius, first - 0.01], now_ns) if was_near else ():
        if gap > radius:
            break
        if gap < first - 0.01:
            return now_ns
    for at_ns, gap in steps(one, other, [radius], now_ns):
        if gap <= radius and not was_near:
            return at_ns
        was_near = gap <= radius
    return None


def least_by_steps(one, other, now_ns):
    """Return the least distance at steps of 1 ms [m]; left out are those that cannot have it."""
    end_ns = max(one.end_ns, other.end_ns) + 2 * MS
    long_ns = 64 * MS
    gaps = [(at_ns, distance(one, other, at_ns)) for at_ns in range(now_ns, end_ns, long_ns)]
    least = min(gap for _, gap in gaps)
    for begin_ns, gap in gaps:
        if gap < least + 2.0 * FASTEST * long_ns / 1e9:
            last_ns = min(begin_ns + long_ns, end_ns)
            least = min(least, *(distance(one, other, at_ns) for at_ns in range(begin_ns, last_ns, MS)))
    return least


@pytest.mark.parametrize('seed', range(150))
def test_what_is_found_is_what_steps_of_a_millisecond_find(seed):
    radius = random.Random(seed).choice([0.5, 1.5, 3.0])
    one, other, now_ns = make_tracks(seed, radius)
    found = search(one, other, radius, now_ns)
    stepped = by_steps(one, other, radius, now_ns)
    if stepped is None:
        # A pass that is shorter than a step: it is one all the same.
        assert found is None or distance(one, other, found) <= radius < distance(one, other, found - 1)
        if found is not None:
            assert find_stay(one, other, radius, found).beyond_ns - found < MS
    else:
        assert stepped - MS < found <= stepped
        assert found == now_ns or distance(one, other, found) <= radius < distance(one, other, found - 1)


def test_most_of_these_seeds_meet_and_many_do_not():
    found = [search(*make_tracks(seed, 1.5)[:2], 1.5, make_tracks(seed, 1.5)[2]) for seed in range(150)]
    assert 30 < sum(one is None for one in found) < 120


@pytest.mark.parametrize('seed', range(40))
def test_the_closest_approach_is_that_of_the_steps(seed):
    one, other, now_ns = make_tracks(seed, 3.0)
    end_ns = max(one.end_ns, other.end_ns)
    least = min(closest(one, other, window)[0] for window in windows(one, other, now_ns, end_ns + 1))
    stepped = least_by_steps(one, other, now_ns)
    assert stepped - 0.004 < least < stepped + 0.0002  # m; in a step they come up to 4 mm nearer


def test_a_pass_that_only_touches_is_found_and_one_beside_it_is_not():
    limits = MotionLimits(1.0)
    stands = Track(None, Pose2D(5.0, 3.0), 0, 6.0)
    for off, meets in ((0.0, True), (-1e-6, True), (1e-6, False)):
        drives = Track(Leg(Pose2D(0.0, -off), Pose2D(10.0, -off), limits), None, 0, 6.0)
        found = search(drives, stands, 3.0, 0)
        assert (found is not None) == meets
        if meets:
            assert abs(found / 1e9 - 5.0) < 0.01


def test_two_in_step_side_by_side_take_no_time_to_be_looked_at():
    limits = MotionLimits(1.0, 0.5)
    tracks = [Track(Leg(Pose2D(0.0, y), Pose2D(1000.0, y), limits), None, 0, 6.0) for y in (0.0, 3.0 + 1e-9)]
    assert search(*tracks, 3.0, 0) is None


def test_a_leg_that_is_too_long_for_cells_is_found_as_well():
    far = 1e7
    drives = Track(Leg(Pose2D(0.0, 0.0), Pose2D(far, 0.0), MotionLimits(10.0)), None, 0, 6.0)
    stands = Track(None, Pose2D(0.5 * far, 1.0), 0, 6.0)
    found = search(drives, stands, 3.0, 0)
    assert abs(found / 1e9 - (0.5 * far - math.sqrt(8.0)) / 10.0) < 1e-6


def test_who_is_near_already_meets_if_they_come_nearer():
    limits = MotionLimits(1.0)
    stands = Track(None, Pose2D(2.0, 0.0), 0, 6.0)
    leaves = Track(Leg(Pose2D(0.0, 0.0), Pose2D(-10.0, 0.0), limits), None, 0, 6.0)
    comes = Track(Leg(Pose2D(0.0, 0.0), Pose2D(10.0, 0.0), limits), None, 0, 6.0)
    returns = Track(Route(Pose2D(0.0, 0.0), Pose2D(10.0, 0.0), [(-10.0, 0.0)], limits), None, 0, 6.0)
    assert search(leaves, stands, 3.0, 0) is None
    assert search(comes, stands, 3.0, 0) == 0
    assert search(returns, stands, 3.0, 0) == 19_000_000_000


@pytest.mark.parametrize('start, goal, kind, yields', [
    ((20.0, 0.5), (0.0, 0.5), HEAD_ON, (0, 1)), ((10.0, -10.0), (10.0, 10.0), CROSSING, (0, 1)),
    ((5.0, 0.5), (25.0, 0.5), OVERTAKING, (0,)), ((-5.0, 0.5), (35.0, 0.5), OVERTAKING, (1,)),
    ((10.0, 0.5), None, STANDING, (0,))])
def test_how_they_meet(start, goal, kind, yields):
    speed = 0.5 if start[0] == 5.0 else 2.0 if start[0] == -5.0 else 1.0
    one = Track(Leg(Pose2D(0.0, 0.0), Pose2D(20.0, 0.0), MotionLimits(1.0)), None, 0, 6.0)
    leg = goal and Leg(Pose2D(*start), Pose2D(*goal), MotionLimits(speed))
    other = Track(leg, Pose2D(*start), 0, 6.0)
    due_ns = search(one, other, 3.0, 0)
    assert kind_of(one, other, due_ns, find_stay(one, other, 3.0, due_ns).nearest_ns) == (kind, yields)


def test_a_way_that_bends_towards_a_robot_is_not_missed():
    radius = 3.0
    circle = stand(Pose2D(0.0, -1.9, 0.0), 0)._replace(v=1.0, w=1.0 / 1.9, k=-1.0)  # around (0, 0)
    reach = Neighbours(radius).side
    for angle in range(0, 360, 15):  # a part of the way is about half of the circle
        far = Pose2D(4.85 * math.cos(math.radians(angle)), 4.85 * math.sin(math.radians(angle)))
        motion = ToldMotion([circle, stand(pose_of(circle, 12 * 1000 * MS), 12 * 1000 * MS)])
        met_ns = search(Track(motion, None, 0, reach), Track(None, far, 0, reach), radius, 0)
        assert met_ns is not None and motion.pose_at(met_ns).distance_to(far) <= radius
        assert met_ns == 0 or motion.pose_at(met_ns - 1).distance_to(far) > radius
