"""When driving bodies touch walls and one another: held to brute force, which steps through time."""
import math
import random

import numpy as np
import pytest
from night import times

from move_base_abstract.driving.contact import (
    FREE,
    NEARER,
    OVERLAP,
    REACH,
    Course,
    disc,
    first_touch,
    gap_of,
    limit_of,
    polygon,
)
from move_base_abstract.driving.walls import Walls
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.pieces import Piece, pose_of

S = 1_000_000_000
US = 1_000
SQUARE = polygon([(0.2, 0.15), (-0.2, 0.15), (-0.2, -0.15), (0.2, -0.15)])
WEDGE = polygon([(0.3, 0.0), (-0.1, 0.2), (-0.1, -0.2)])
HOOK = polygon([(0.3, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.3, -0.2), (0.3, -0.1), (-0.1, -0.1), (-0.1, 0.1),
                (0.3, 0.1)])  # not convex: it is open ahead
FORK = polygon([(0.2, 0.0), (0.1, 0.3), (0.0, 0.05), (-0.3, 0.3), (-0.2, -0.2), (0.3, -0.3)])
SHAPES = [disc(0.25), SQUARE, WEDGE, HOOK, FORK, polygon([(0.02, 0.5), (-0.02, 0.5), (-0.02, -0.5), (0.02, -0.5)])]


def arc(x, y, yaw, v, w, lateral=0.0, begin_ns=0):
    """Return the piece of a twist (forward ``v``, ``lateral``, turning ``w``)."""
    speed = math.hypot(v, lateral) if lateral else v
    course = yaw + math.atan2(lateral, v) if lateral else yaw
    return Piece(begin_ns, x, y, yaw, math.cos(course), math.sin(course), speed, 0.0, w, -1.0)


def world(occupied, side=0.05, size=(80, 80), origin=Pose2D()):
    cells = np.zeros(size, np.int8)
    for row, column in occupied:
        cells[row, column] = 100
    return OccupancyMap(cells, side, origin)


def gap_by_hand(shape, pose, occupancy):
    """Return the gap of a body and the occupied cells, each a square, by distances of all corners and all sides."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    outline = np.array(shape.outline or [(0.0, 0.0)])
    outline = np.stack([pose.x + cos * outline[:, 0] - sin * outline[:, 1],
                        pose.y + sin * outline[:, 0] + cos * outline[:, 1]], 1)
    rows, columns = np.nonzero(occupancy.cells >= 65)
    side = occupancy.resolution
    squares = [np.array([occupancy.from_cells(c + i, r + j) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))])
               for r, c in zip(rows, columns)
               if math.dist(occupancy.from_cells(c + 0.5, r + 0.5), (pose.x, pose.y)) < shape.reach + 2.0 * side]
    return min((polygons_apart(outline, square) - shape.radius for square in squares), default=math.inf)


def polygons_apart(one, other):
    if any(inside(point, other) for point in one) or any(inside(point, one) for point in other):
        return 0.0
    if sides_cross(one, other):
        return 0.0
    return min(to_sides(one, other), to_sides(other, one))


def to_sides(points, polygon_):
    begin, way = polygon_, np.roll(polygon_, -1, 0) - polygon_
    squared = np.maximum((way ** 2).sum(1), 1e-300)
    share = np.clip(((points[:, None] - begin) * way).sum(2) / squared, 0.0, 1.0)
    return float(np.sqrt((((points[:, None] - begin) - share[:, :, None] * way) ** 2).sum(2).min()))


def inside(point, polygon_):
    if len(polygon_) < 3:
        return False
    a, b = polygon_, np.roll(polygon_, -1, 0)
    spans = (a[:, 1] > point[1]) != (b[:, 1] > point[1])
    with np.errstate(divide='ignore', invalid='ignore'):
        x = a[:, 0] + (point[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return bool((spans & (point[0] < x)).sum() % 2)


def sides_cross(one, other):
    def turn(a, b, c):
        return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    a, b = one[:, None], np.roll(one, -1, 0)[:, None]
    c, d = other[None], np.roll(other, -1, 0)[None]
    return bool(((turn(a, b, c) * turn(a, b, d) < 0.0) & (turn(c, d, a) * turn(c, d, b) < 0.0)).any())


def check_touch(gap, touch_ns, end_ns, limit=REACH, step_ns=2_000_000):
    """Hold an answer to the gap at instants before it, at 1 us around it, and at its nanosecond."""
    last_ns = end_ns if touch_ns is None else touch_ns
    for at_ns in [*range(0, last_ns, step_ns), *range(max(0, last_ns - 20 * US), last_ns, US), max(0, last_ns - 2)]:
        assert gap(at_ns) > limit - 1e-12, at_ns
    if touch_ns is not None:
        assert gap(touch_ns) <= limit + 1e-12
        assert touch_ns == 0 or gap(touch_ns - 1) > limit - 1e-12


@pytest.mark.parametrize('seed', range(times(60, 2000)))
def test_the_first_touch_of_a_random_body_and_random_walls_is_that_of_brute_force(seed):
    draw = random.Random(seed)
    shape = SHAPES[seed % len(SHAPES)]
    origin = Pose2D(draw.uniform(-2.0, 2.0), draw.uniform(-2.0, 2.0), draw.choice([0.0, 0.0, draw.uniform(-3.0, 3.0)]))
    occupancy = world([(draw.randrange(80), draw.randrange(80)) for _ in range(draw.choice([3, 20, 60]))],
                      draw.choice([0.05, 0.1]), origin=origin)
    x, y = occupancy.from_cells(draw.uniform(10.0, 70.0), draw.uniform(10.0, 70.0))
    v, w = draw.choice([(0.0, 1.0), (1.0, 0.0), (-0.7, 0.4), (0.5, -2.0), (0.3, 1e-9)])
    piece = arc(x, y, draw.uniform(-3.0, 3.0), v, w, draw.choice([0.0, 0.0, 0.3]))

    def gap(at_ns):
        return gap_by_hand(shape, pose_of(piece, at_ns), occupancy)
    walls = Walls(occupancy, shape)
    assert min(walls.gap_at(pose_of(piece, 0)), REACH) == pytest.approx(max(0.0, min(gap(0), REACH)), abs=1e-12)
    touch_ns = walls.first_touch([(piece, 4 * S)], 0)
    if gap(0) > 2.0 * REACH:
        check_touch(gap, touch_ns, 4 * S, step_ns=20_000_000)


def touch_of(occupancy, shape, piece, end_ns=4 * S):
    return Walls(occupancy, shape).first_touch([(piece, end_ns)], piece.begin_ns)


EAST = world([(row, 60) for row in range(80)])  # a wall whose western face is at 3 m
FACE = 60 * EAST.resolution


def test_the_instant_is_that_of_the_formula():
    assert touch_of(EAST, disc(0.25), arc(1.0, 2.0, 0.0, 0.5, 0.0)) == pytest.approx(
        (FACE - 0.25 - REACH - 1.0) / 0.5 * S, abs=1.5)
    corner = math.atan2(0.15, 0.2)  # of SQUARE, 0.25 m from its middle; it turns towards the wall
    assert touch_of(EAST, SQUARE, arc(FACE - 0.22, 2.0, math.pi / 2.0, 0.0, -0.5)) == pytest.approx(
        (math.pi / 2.0 - corner - math.acos((0.22 - REACH) / 0.25)) / 0.5 * S, abs=3)
    assert touch_of(EAST, SQUARE, arc(FACE - 0.25 - 2.0 * REACH, 2.0, math.pi / 2.0, 0.0, -0.5)) is None
    radius = 0.5  # of an arc: the middle is first at FACE - 0.2 after asin(0.4 / 0.5)
    assert touch_of(EAST, disc(0.2), arc(FACE - 0.6, 2.0, 0.0, radius, 1.0)) == pytest.approx(
        math.asin((0.4 - REACH) / radius) * S, abs=3)


@pytest.mark.parametrize('degrees', range(60, 301, 15))
def test_a_tip_that_turns_away_comes_round(degrees):
    tip = polygon([(0.5, 0.0), (-0.04, 0.03), (-0.04, -0.03)])
    piece = arc(FACE - 0.3, 2.0, math.radians(degrees), 0.0, 1.0)
    angle = math.acos((0.3 - REACH) / 0.5)  # at which it touches the wall, to both sides
    assert touch_of(EAST, tip, piece, 10 * S) == pytest.approx(
        (-angle - math.radians(degrees)) % (2.0 * math.pi) * S, abs=3)


@pytest.mark.parametrize('shape', SHAPES)
def test_a_body_that_was_pushed_often_comes_no_nearer_and_may_drive_along_the_wall(shape):
    walls, pose, now_ns = Walls(EAST, shape), Pose2D(2.0, 2.0, 0.0), 0
    at_once = 0
    for number in range(200):
        piece = arc(pose.x, pose.y, pose.yaw, 0.3 / (1 + number), 0.0, begin_ns=now_ns)
        touch_ns = walls.first_touch([(piece, now_ns + 10 * S)], now_ns)
        if number < 2:  # when the way is short enough
            assert touch_ns is not None
        if touch_ns is None:
            break
        at_once += touch_ns - now_ns < 1000
        pose = pose_of(piece, touch_ns - 1)
        now_ns = touch_ns
        assert REACH - 1e-11 < walls.gap_at(pose) < REACH + 1e-9
        lateral = 0.3 * (-1) ** number
        along = arc(pose.x, pose.y, pose.yaw, 0.0, 0.0, lateral, now_ns)
        along = along._replace(ux=0.0)  # along the wall to the last digit
        assert walls.first_touch([(along, now_ns + S)], now_ns) is None
        pose = pose_of(along, now_ns + S)
        now_ns += S
    assert at_once == 199


def test_a_corridor_as_wide_as_the_body_and_a_hair_lets_it_through():
    occupancy = world([(row, column) for row in (20, 26) for column in range(10, 80)])
    wide = 5 * occupancy.resolution  # between both walls
    middle = 23.5 * occupancy.resolution
    piece = arc(0.2, middle, 0.0, 1.0, 0.0)
    assert touch_of(occupancy, disc(0.5 * wide - 2.0 * REACH), piece) is None
    assert touch_of(occupancy, disc(0.5 * wide + REACH), piece) is not None


def test_a_body_inside_a_wall_may_leave_but_not_go_deeper():
    wall = world([(row, column) for row in range(80) for column in (60, 61, 62)])
    inside = FACE - 0.2  # the body is 0.05 m deep in the wall: in one column of cells
    assert touch_of(wall, disc(0.25 - 1e-3), arc(inside, 2.0, math.pi, 0.5, 0.0)) is None
    assert touch_of(wall, disc(0.25 - 1e-3), arc(inside, 2.0, 0.0, 0.5, 0.0)) == pytest.approx(1e-3 / 0.5 * S, rel=0.01)
    assert touch_of(wall, HOOK, arc(61.5 * wall.resolution, 2.0, 0.0, 0.0, 0.3)) is not None
    thin = world([(40, 60)])
    around = arc(60.5 * thin.resolution, 40.5 * thin.resolution, 0.0, 0.2, 0.1)  # the cell is inside of the body
    assert Walls(thin, FORK).gap_at(pose_of(around, 0)) == 0.0
    assert touch_of(thin, FORK, around) is None


def test_far_from_walls_no_cell_is_looked_at(monkeypatch):
    monkeypatch.setattr(Walls, '_near', None)
    occupancy = world([(row, column) for row in range(200) for column in (0, 199)], size=(200, 200))
    assert touch_of(occupancy, SQUARE, arc(5.0, 5.0, 0.3, 1.0, 0.5)) is None
    assert touch_of(occupancy, SQUARE, arc(50.0, -50.0, 0.3, 1.0, 0.0)) is None  # off the map


def test_several_pieces_are_one_course():
    pieces = [arc(1.0, 2.0, 0.0, 1.0, 0.0), arc(2.0, 2.0, 0.0, 0.0, 1.0, begin_ns=S),
              arc(2.0, 2.0, 1.0, 1.0, -1.0, begin_ns=2 * S)]
    spans = list(zip(pieces, (S, 2 * S, 4 * S)))
    walls = Walls(EAST, SQUARE)
    touch_ns = walls.first_touch(spans, 0)
    check_touch(lambda at_ns: gap_by_hand(SQUARE, pose_of(pieces[min(2, at_ns // S)], at_ns), EAST), touch_ns, 4 * S,
                step_ns=10_000_000)
    assert touch_ns > 2 * S
    assert [walls.first_touch(spans, begin_ns) for begin_ns in (S // 2, S + 5, touch_ns - 1)] == [touch_ns] * 3


@pytest.mark.parametrize('seed', range(times(60, 2000)))
def test_the_first_touch_of_two_random_bodies_is_that_of_brute_force(seed):
    draw = random.Random(seed)
    one, other = (Course(arc(draw.uniform(-1.0, 1.0) + 1.3 * number, draw.uniform(-1.0, 1.0), draw.uniform(-3.0, 3.0),
                             *draw.choice([(0.0, 1.0), (0.5, 0.0), (-0.7, 0.4), (0.5, -2.0), (0.0, 0.0), (0.3, 1e-9)]),
                             draw.choice([0.0, 0.2])), draw.choice(SHAPES)) for number in (0, 1))

    def gap(at_ns):
        bodies = []
        for course in (one, other):
            points = course.shape.outline or [(0.0, 0.0)]
            bodies.append(np.array(course.corners(at_ns, points)))
        return polygons_apart(*bodies) - one.shape.radius - other.shape.radius
    assert gap_of(one, other, 0) == pytest.approx(max(0.0, gap(0)), abs=1e-12)
    if gap(0) > REACH + NEARER:
        touch_ns = first_touch(one, other, FREE, 0, 4 * S)
        assert touch_ns == first_touch(other, one, FREE, 0, 4 * S)
        check_touch(gap, touch_ns, 4 * S, step_ns=10_000_000)


def test_one_that_follows_another_at_its_speed_never_touches_it():
    leader, follower = Course(arc(0.5 + 2.0 * REACH, 0.0, 0.0, 0.5, 0.0), disc(0.25)), Course(
        arc(0.0, 0.0, 0.0, 0.5, 0.0), disc(0.25))
    assert first_touch(follower, leader, FREE, 0, 100 * S) is None
    faster = follower._replace(piece=follower.piece._replace(v=0.50001))
    assert first_touch(faster, leader, FREE, 0, 100 * S) == pytest.approx(0.1 * S, rel=1e-3)


def test_bodies_that_overlap_have_no_limit():
    assert limit_of(0.0) is limit_of(OVERLAP) is None
    assert limit_of(1.0) is FREE
    near = limit_of(REACH)
    assert OVERLAP < near.touch < near.stand < REACH
