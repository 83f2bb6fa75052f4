"""Areas in the plane: what is inside, which pieces of a way are, and which outlines are refused."""
import math
import random

import pytest

from move_base_abstract.traffic.outline import BORDER, Outline, rectangle

SQUARE = rectangle(0.0, 0.0, 10.0, 10.0)
ARROW = Outline([(0.0, 0.0), (10.0, 10.0), (20.0, 0.0), (10.0, 4.0)])  # its fourth corner points inwards


@pytest.mark.parametrize(('place', 'inside'), [
    ((5.0, 5.0), True), ((-1.0, 5.0), False), ((0.0, 5.0), False), ((10.0, 10.0), False), ((5.0, 10.0 - 1e-9), False),
    ((5.0, 10.0 - 1e-5), True), ((5.0, 10.0 + 1e-9), False)])
def test_inside_is_what_lies_more_than_a_micrometre_from_the_border(place, inside):
    assert SQUARE.contains(*place) is inside


def test_a_corner_that_points_inwards_is_left_out():
    assert ARROW.contains(10.0, 5.0) and not ARROW.contains(10.0, 3.0) and ARROW.contains(4.0, 2.0)


@pytest.mark.parametrize(('way', 'pieces'), [
    ([(-5.0, 5.0), (15.0, 5.0)], [(5.0, 15.0)]),
    ([(5.0, 5.0), (15.0, 5.0)], [(0.0, 5.0)]),  # starts inside
    ([(-5.0, 5.0), (5.0, 5.0)], [(5.0, 10.0)]),  # ends inside
    ([(2.0, 5.0), (5.0, 5.0)], [(0.0, 3.0)]),
    ([(-5.0, 0.0), (15.0, 0.0)], []),  # along the border
    ([(-5.0, 1e-9), (15.0, 1e-9)], []),  # as near as that is on it
    ([(-5.0, 5.0), (5.0, 15.0)], []),  # touches a corner
    ([(-5.0, -5.0), (15.0, 15.0)], [(5.0 * math.sqrt(2.0), 15.0 * math.sqrt(2.0))]),  # through two corners
    ([(-5.0, 0.0), (5.0, 0.0), (5.0, 5.0)], [(10.0, 15.0)]),  # along the border, then in
    ([(-5.0, 5.0), (5.0, 5.0), (5.0, 15.0)], [(5.0, 15.0)]),  # a corner of the way inside parts nothing
    ([(5.0, 5.0), (5.0, 10.0), (7.0, 8.0)], [(0.0, 5.0 + math.hypot(2.0, 2.0))]),  # touches the border from inside
    ([(5.0, 5.0), (5.0, 10.0), (7.0, 12.0)], [(0.0, 5.0)]),
    ([(5.0, 5.0), (15.0, 5.0), (5.0, 5.0)], [(0.0, 5.0), (15.0, 20.0)]),
    ([(10.0, 5.0), (15.0, 5.0)], []),  # from the border away
    ([(10.0 - 1e-9, 5.0), (15.0, 5.0)], []),  # likewise, as near as numbers are
    ([(10.0 + 1e-9, 5.0), (5.0, 5.0)], [(1e-9, 5.0)]),
    ([(3.0, 3.0), (3.0, 3.0)], []),
])
def test_the_pieces_of_a_way_that_lie_inside(way, pieces):
    assert [value for piece in SQUARE.pieces_inside(way) for value in piece] == pytest.approx(
        [value for piece in pieces for value in piece], abs=2e-9)
    assert len(SQUARE.pieces_inside(way)) == len(pieces)


def test_a_way_past_a_corner_that_points_inwards_is_inside_twice():
    assert ARROW.pieces_inside([(0.0, 2.0), (20.0, 2.0)]) == [(2.0, 5.0), (15.0, 18.0)]
    assert ARROW.pieces_inside([(0.0, 4.0), (20.0, 4.0)]) == [(4.0, 16.0)]  # touches it from inside


def test_the_direction_of_the_points_and_the_first_one_repeated_change_nothing():
    backwards = Outline([*reversed(ARROW.points), ARROW.points[-1]])
    generator = random.Random(3)
    for _ in range(200):
        way = [(generator.uniform(-5.0, 25.0), generator.uniform(-5.0, 15.0)) for _ in range(4)]
        one, other = ARROW.pieces_inside(way), backwards.pieces_inside(way)
        assert [value for piece in one for value in piece] == pytest.approx(
            [value for piece in other for value in piece])


def test_pieces_are_where_small_steps_find_them():
    star = Outline([((4.0 + 3.0 * (-1) ** k) * math.cos(0.7 * k), (4.0 + 3.0 * (-1) ** k) * math.sin(0.7 * k))
                    for k in range(9)])
    generator = random.Random(4)
    for _ in range(50):
        (ax, ay), (bx, by) = begin, end = [(generator.uniform(-8.0, 8.0), generator.uniform(-8.0, 8.0))
                                           for _ in range(2)]
        length = math.hypot(bx - ax, by - ay)
        pieces = star.pieces_inside([begin, end])
        for number in range(200):
            along = (number + 0.5) / 200 * length
            if min((abs(along - value) for piece in pieces for value in piece), default=1.0) > 2 * BORDER:
                share = along / length
                assert star.contains(ax + share * (bx - ax), ay + share * (by - ay)) is any(
                    one < along < other for one, other in pieces)


@pytest.mark.parametrize('points', [
    [], [(0.0, 0.0), (1.0, 0.0)], [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0)],
    [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)],  # no area
    [(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)],  # crosses itself
    [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 1.0)],  # twice the same
    [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 0.0), (0.0, 4.0)],  # touches itself
    [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (4.0, 1.0)],  # turns back on itself
    [(math.cos(k), math.sin(k)) for k in range(201)],
])
def test_what_is_no_simple_polygon_is_refused(points):
    with pytest.raises(ValueError):
        Outline(points)
