"""Robots that have nothing to do park: where, in which order, and what calls them away."""
import pytest

from dispatches import S, dispatch_of, order, told
from move_base_abstract.motion.geometry import Pose2D

NEAR_LOT = {'name': 'near', 'y': 5.0, 'parking': True, 'capacity': 1}
FAR_LOT = {'name': 'far', 'y': 50.0, 'parking': True}
PARK = {'park_when_idle': True}


def parked(dispatch):
    return [(time, robot, place) for time, robot, _, place in told(dispatch, 'park_assigned')]


def test_idle_robots_park_at_the_nearest_place_with_room_by_their_names():
    dispatch = dispatch_of(places=[FAR_LOT, NEAR_LOT, {'name': 'dock', 'x': 10.0}], dispatcher=PARK)
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near'), (0.0, 'r_1', 'far')]
    assert [robot.pose.y for robot in dispatch.fleet.robots] == [5.0, 50.0]


def test_robots_stay_if_no_place_has_room_or_if_it_was_not_asked_for():
    dispatch = dispatch_of(robots=3, places=[NEAR_LOT], dispatcher=PARK)
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near')]
    assert not parked(dispatch_of(places=[NEAR_LOT]))


def test_a_robot_on_its_way_to_park_takes_an_order_at_once_and_parks_after_it():
    dispatch = dispatch_of(robots=1, places=[FAR_LOT], dispatcher=PARK)
    dispatch.run(until=10.0)
    dispatch.order(order('one', (0.0, 12.0)))
    dispatch.run()
    assert told(dispatch, 'order_assigned', 'order_done', 'park_assigned') == [
        (0.0, 'r_0', 'park_assigned', 'far'), (10.0, 'r_0', 'order_assigned', 'one', 1),
        (12.0, 'r_0', 'order_done', 'one', 'done', 2 * S), (12.0, 'r_0', 'park_assigned', 'far')]
    assert dispatch.fleet.robot('r_0').pose.y == 50.0


def test_a_robot_parks_after_an_order_that_is_done_at_the_instant_at_which_it_was_sent_to_park():
    dispatch = dispatch_of(robots=1, places=[FAR_LOT], dispatcher=PARK)
    dispatch.run(until=0.0)
    dispatch.order(order('here', (0.0, 0.0)))
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'far')] * 2
    assert dispatch.fleet.robot('r_0').pose.y == 50.0


def test_a_robot_that_starts_at_a_parking_place_holds_its_room_and_one_that_is_placed_elsewhere_gives_it_back():
    lot = {'name': 'lot', 'x': 10.0, 'parking': True, 'capacity': 1}
    dispatch = dispatch_of(places=[lot], dispatcher=PARK)
    dispatch.run()
    assert parked(dispatch) == []  # r_1 stands there
    dispatch.fleet.robot('r_1').place(Pose2D(40.0, 0.0))
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'lot')]
    dispatch.fleet.robot('r_0').place(Pose2D(40.0, 0.0))
    dispatch.run()
    assert parked(dispatch)[1:] == [(10.0, 'r_0', 'lot')]


def test_more_robots_than_places_at_the_start_go_elsewhere():
    dispatch = dispatch_of(robots=3, each={k: {'start_x': 0.0, 'start_y': 5.0} for k in range(3)},
                           places=[NEAR_LOT, FAR_LOT], dispatcher=PARK)
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_1', 'far'), (0.0, 'r_2', 'far')]


def test_a_robot_that_stops_short_of_its_parking_place_has_parked():
    dispatch = dispatch_of(robots=1, places=[{**NEAR_LOT, 'reach': 0.1}], dispatcher=PARK, xy_goal_tolerance=0.5)
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near')]


def test_a_robot_that_fails_on_its_way_to_park_parks_when_it_is_repaired():
    dispatch = dispatch_of(robots=1, places=[NEAR_LOT], dispatcher=PARK, failure_kind='stall', repair_time=20.0,
                           failure_times=[2.0])
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near'), (22.0, 'r_0', 'near')]
    assert dispatch.fleet.robot('r_0').pose.y == 5.0


def test_a_robot_that_fails_or_gets_an_order_gives_its_room_to_another():
    broken = {'failure_kind': 'stall', 'failure_times': [2.0], 'repair_distribution': 'never'}
    dispatch = dispatch_of(places=[NEAR_LOT], dispatcher=PARK, each={0: broken})
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near'), (2.0, 'r_1', 'near')]
    dispatch = dispatch_of(places=[NEAR_LOT], dispatcher=PARK)
    dispatch.run(until=8.0)
    dispatch.order(order('one', (0.0, 6.0)))
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near'), (8.0, 'r_1', 'near')]


def test_a_robot_that_cannot_reach_its_parking_place_goes_to_another():
    dispatch = dispatch_of(robots=1, places=[NEAR_LOT, {**FAR_LOT, 'y': -50.0}], dispatcher=PARK,
                           world_bounds=[-100.0, -100.0, 100.0, 4.0])
    dispatch.run()
    assert parked(dispatch) == [(0.0, 'r_0', 'near'), (0.0, 'r_0', 'far')]
    assert dispatch.fleet.robot('r_0').pose.y == -50.0


@pytest.mark.parametrize('away', [5.0, 500.0])
def test_a_robot_that_waits_for_a_charger_parks_and_one_that_leaves_a_charger_parks_too(away):
    """With the far place, r_1 is still on its way when r_0 has charged, after 180 s and what it needed meanwhile."""
    zone = {'name': 'plug', 'rectangle': [-1, -1, 1, 1], 'charger': True, 'capacity': 1}
    dispatch = dispatch_of(
        places=[{**NEAR_LOT, 'y': away, 'capacity': 2}], zones=[zone], dispatcher={**PARK, 'charge_below': 0.5},
        battery_capacity=1.0, battery_start=0.4, charging_current=10.0, friction_coefficient=0.0)
    dispatch.run(until=300.0)
    rows = told(dispatch, 'charge_assigned', 'charge_awaited', 'park_assigned', 'charge_over')
    assert [row[1:4] for row in rows[:5]] == [
        ('r_1', 'charge_awaited', 'low'), ('r_1', 'park_assigned', 'near'),
        ('r_0', 'charge_over', 'plug'), ('r_0', 'park_assigned', 'near'), ('r_1', 'charge_assigned', 'plug')]
