import math

from soil_mapping.mission.commands import Place
from soil_mapping.mission.odometer import Odometer


def at_origin():
    odometer = Odometer()
    odometer.pose(0, 0.0, 0.0)
    odometer.take_place()
    return odometer


def test_poses_that_come_after_the_end_of_their_leg_count_no_way_twice():
    odometer = at_origin()
    odometer.pose(1, 2.0, 0.0)
    odometer.reached(10, 20.0, 0.0)
    assert odometer.take_place() == Place(20.0, 0.0, None)
    for stamp_ns in range(2, 10):  # late
        odometer.pose(stamp_ns, 2.0 * stamp_ns, 0.0)
    odometer.pose(10, 20.0, 0.0)
    assert odometer.take_place() == Place(20.0, 0.0, None)
    odometer.pose(11, 20.0, 3.0)
    assert odometer.take_place() == Place(20.0, 3.0, None)


def test_a_pose_from_after_the_end_of_a_leg_says_more_than_its_goal():
    odometer = at_origin()
    odometer.pose(12, 19.0, 0.0)
    odometer.reached(10, 20.0, 0.0)
    assert odometer.take_place() == Place(19.0, 0.0, None)


def test_a_way_that_is_not_straight_is_told_with_its_length():
    odometer = at_origin()
    odometer.pose(1, 3.0, 0.0)
    odometer.reached(2, 3.0, 4.0)
    place = odometer.take_place()
    assert (place.x, place.y) == (3.0, 4.0)
    assert math.isclose(place.driven_m, 7.0)
    assert odometer.take_place().driven_m is None
