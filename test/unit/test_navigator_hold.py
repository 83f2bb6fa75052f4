"""A robot that is held stands, and its goal stays active; released, it goes on. With all that may happen meanwhile."""
import numpy as np
import pytest

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.outcome import CLOCK_RESTARTED, NODE_KILLED, ROBOT_RESET
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.maps.planning import WorldBounds
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.motion.leg import MotionLimits, Tolerances
from move_base_abstract.scenario import make_scenario
from traces import leg_of

S = NS_PER_S
STOP = ('stop wheels',)
ANOTHER = 'This goal was canceled because another goal was received by the simple action server'
NO_PLAN = 'Failed to find a valid plan. Even after executing recovery behaviors.'
NO_CONTROL = 'Failed to find a valid control. Even after executing recovery behaviors.'
GOAL = Pose2D(20.0, 0.0)


def held(*reasons, at):
    return ('held', reasons, int(at * S))


def stands(x, at):
    return ('stands', Pose2D(x, 0.0), int(at * S))


def departed(x, at):
    return ('departed', Pose2D(x, 0.0), int(at * S))


def reached(goal_id, x, at):
    return [stands(x, at), STOP, ('result', goal_id, 'SUCCEEDED', 'Goal reached.', int(at * S))]


def on_the_way(rig, **how):
    """Return a rig whose robot (2 m/s) is held for 'door' after 3 s of its way of 20 m, and has told of it."""
    robot = rig(**how)
    robot.send('g', GOAL.x, 0.0)
    robot.advance(3.0)
    assert robot.hold('door') == [held('door', at=3), stands(6.0, 3)]
    return robot


def test_it_stands_at_its_exact_pose_and_goes_on_from_there_when_released(rig):
    robot = on_the_way(rig)
    assert robot.advance(50.0) == []
    travel = robot.navigator.travel
    assert (robot.navigator.is_active, travel.target, travel.held_for) == (True, GOAL, ('door',))
    assert robot.release('door') == [held(at=50), departed(20.0, 50)]
    assert robot.advance(99.0) == reached('g', 20.0, 57)
    assert robot.robot.distance_at(99 * S) == 20.0


def test_it_starts_again_from_rest(rig):
    robot = on_the_way(rig)
    robot.robot.set_motion(MotionLimits(2.0, 1.0), Tolerances())
    robot.release('door')
    assert robot.advance(99.0) == reached('g', 20.0, 3 + 14 / 2 + 2)


def test_feedback_goes_on_while_it_is_held(rig):
    robot = on_the_way(rig, feedback_freq=1.0)
    for at in (4, 5):
        assert robot.advance(at) == [('feedback', 'g', Pose2D(6.0, 0.0), at * S)]


def test_of_two_reasons_both_must_go_and_a_reason_counts_once(rig):
    robot = on_the_way(rig)
    assert robot.hold('zone') == [held('door', 'zone', at=3)]
    assert robot.hold('door') == robot.release('never said') == []
    assert robot.release('door') == [held('zone', at=3)]
    assert robot.hold('door') == [held('zone', 'door', at=3)]
    assert robot.release('zone') == [held('door', at=3)]
    assert robot.release('door') == [held(at=3), departed(20.0, 3)]


def test_a_cancel_ends_the_goal_and_leaves_the_hold(rig):
    robot = on_the_way(rig)
    assert robot.cancel() == [STOP, ('result', 'g', 'PREEMPTED', '', 3 * S)]
    assert robot.release('door') == [held(at=3)]
    assert robot.advance(99.0) == []


def test_a_new_goal_replaces_the_one_before_it_and_waits(rig):
    robot = on_the_way(rig)
    assert robot.send('h', 8.0, 0.0) == [('result', 'g', 'PREEMPTED', ANOTHER, 3 * S),
                                         ('target', Pose2D(8.0, 0.0), 3 * S)]
    assert robot.advance(10.0) == []
    assert robot.release('door') == [held(at=10), departed(8.0, 10)]
    assert robot.advance(99.0) == reached('h', 8.0, 11)


def test_held_while_idle_it_takes_a_goal_in_and_waits(rig):
    robot = rig()
    assert robot.hold('door') == [held('door', at=0)]
    assert robot.send('g', 4.0, 0.0) == [STOP, ('target', Pose2D(4.0, 0.0), 0)]
    robot.advance(2.0)
    assert robot.release('door') == [held(at=2), departed(4.0, 2)]
    assert robot.advance(99.0) == reached('g', 4.0, 4)


def test_held_and_released_while_idle_nothing_moves(rig):
    robot = rig()
    assert robot.hold('door') + robot.release('door') == [held('door', at=0), held(at=0)]
    assert (robot.advance(9.0), robot.simulation.next_due_ns()) == ([], None)


def test_a_goal_without_a_way_ends_though_the_robot_is_held(rig):
    robot = on_the_way(rig, bounds=WorldBounds(-1.0, -1.0, 30.0, 1.0))
    told = robot.send('far', 40.0, 0.0)
    assert told[-2:] == [STOP, ('result', 'far', 'ABORTED', NO_PLAN, 3 * S)]


@pytest.mark.parametrize('is_released', [False, True])
def test_giving_a_goal_up_takes_as_long_whether_the_robot_is_held_or_not(rig, is_released):
    robot = rig(bounds=WorldBounds(-1.0, -1.0, 30.0, 1.0), recovery_policy=RecoveryPolicy(False, 5.0, ()))
    robot.send('far', 40.0, 0.0)
    robot.advance(1.0)
    assert robot.hold('door') == [held('door', at=1)]
    if is_released:
        assert robot.release('door') == [held(at=1)]
    assert robot.advance(4.999999999) == []
    assert robot.advance(99.0) == [STOP, ('result', 'far', 'ABORTED', NO_PLAN, 5 * S)]


def test_a_goal_waits_for_its_stamp_first_and_for_the_release_then(rig):
    robot = rig()
    robot.send('a', 9.0, 0.0)
    robot.advance(1.0)
    robot.hold('door')
    robot.send('b', 1.0, 0.0, frame='base_link', stamp=5.0)
    assert robot.advance(5.0) == [('target', Pose2D(3.0, 0.0), 5 * S)]
    assert robot.release('door') == [held(at=5), departed(3.0, 5)]


def test_released_before_its_goal_has_a_place_it_sets_out_when_that_is_found(rig):
    robot = rig()
    robot.send('a', 9.0, 0.0)
    robot.advance(1.0)
    robot.send('b', 1.0, 0.0, frame='base_link', stamp=5.0)
    assert robot.hold('door') + robot.release('door') == [held('door', at=1), held(at=1)]
    assert robot.advance(5.0) == [('target', Pose2D(3.0, 0.0), 5 * S), departed(3.0, 5)]


def test_put_elsewhere_it_goes_on_from_there(rig):
    robot = on_the_way(rig)
    assert robot.place(Pose2D(10.0, 0.0)) == [stands(10.0, 3)]
    assert robot.release('door') == [held(at=3), departed(20.0, 3)]
    assert robot.advance(99.0) == reached('g', 20.0, 8)


def test_held_at_the_instant_of_its_arrival_it_arrives_when_released(rig):
    robot = rig()
    robot.send('g', 4.0, 0.0)
    robot.simulation.queue.schedule(2 * S, -1, lambda due_ns, _now_ns: robot.navigator.travel.hold('door', due_ns))
    assert robot.advance(2.0) == [held('door', at=2), stands(4.0, 2)]
    robot.advance(3.0)
    robot.release('door')
    assert robot.advance(3.0) == reached('g', 4.0, 3)


class Gate:
    """Holds the robot at the end of the instant of its first departure."""

    def __init__(self, robot):
        self.robot, self.asked = robot, []

    def way_on(self, now_ns):
        """The robot goes by its planner's way."""

    def departs(self, leg, now_ns):
        """Note the departure."""
        self.asked.append((leg.end.x, now_ns))
        if not now_ns:
            self.robot.simulation.queue.decide(now_ns, lambda due_ns, _now_ns: (
                self.robot.navigator.travel.hold('border', due_ns)))


def test_a_gate_may_hold_the_robot_at_its_departure(rig):
    robot = rig()
    gate = Gate(robot)
    robot.navigator.travel.set_gate(gate)
    robot.send('g', 4.0, 0.0)
    assert robot.advance(0.0) == [held('border', at=0), stands(0.0, 0)]
    assert robot.advance(9.0) == []
    robot.release('border')
    assert robot.advance(99.0) == reached('g', 4.0, 11)
    assert gate.asked == [(4.0, 0), (4.0, 9 * S)]


@pytest.mark.parametrize('end, outcome, left', [
    (lambda navigator: navigator.shut_down(NODE_KILLED, 3 * S), NODE_KILLED, ('door',)),
    (lambda navigator: navigator.reset(ROBOT_RESET, 3 * S), ROBOT_RESET, ())])
def test_the_end_of_a_goal_leaves_the_hold_but_a_reset_ends_it(rig, end, outcome, left):
    robot = on_the_way(rig)
    end(robot.navigator)
    assert robot.told() == [STOP, ('result', 'g', 'ABORTED', outcome.text, 3 * S)] + [held(at=3)] * (not left)
    assert robot.navigator.travel.held_for == left


def test_when_the_clock_starts_anew_the_goal_ends_and_the_hold_stays(rig):
    robot = on_the_way(rig)
    robot.simulation.restart(0)
    robot.navigator.restart(3 * S, 0)
    assert robot.told() == [STOP, ('result', 'g', 'ABORTED', CLOCK_RESTARTED.text, 0), stands(6.0, 0)]
    robot.send('h', 8.0, 0.0)
    assert robot.advance(2.0) == []
    assert robot.release('door') == [held(at=2), departed(8.0, 2)]


# ---- on a map

def area(*walls):
    """Return a map of 12 x 12 cells of 1 m; a wall is (rows, column)."""
    cells = np.zeros((12, 12), np.int8)
    for rows, column in walls:
        cells[rows, column] = 100
    return OccupancyMap(cells, 1.0)


def held_on(occupancy):
    """Return a Fleet of one robot, 'bot', that goes from (2.5, 5.5) to (8.5, 5.5) at 2 m/s and is held after 0.5 s."""
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, 'use_map': True, 'routes': 'grid', 'robot_radius': 0.0},
                                 'robots': [{'name': 'bot', 'start_x': 2.5, 'start_y': 5.5}]}), 0, occupancy=occupancy)
    fleet.robot('bot').send(8.5, 5.5)
    fleet.run(S // 2)
    fleet.robot('bot').hold('door')
    fleet.trace.clear()
    return fleet


def kinds(fleet):
    return [(entry.time_ns / S, entry.kind, *entry.values[:1]) for entry in fleet.trace]


def test_another_map_counts_from_the_release_on():
    fleet = held_on(area())
    fleet.run(S)
    fleet.use_map(area((slice(2, 12), 5)))
    fleet.run(2 * S)
    assert fleet.trace == []
    fleet.robot('bot').release('door')
    assert kinds(fleet) == [(2.0, 'released'), (2.0, 'departed', 8.5)]
    assert leg_of(fleet).corners[0][0] == 4.992188
    fleet.run()
    assert fleet.trace[-1].values[1] == 'SUCCEEDED'


def test_a_way_that_is_gone_at_the_release_ends_the_goal():
    fleet = held_on(area())
    fleet.use_map(area((slice(0, 12), 5)))
    fleet.robot('bot').release('door')
    assert [entry.values for entry in fleet.trace] == [(), ('bot-1', 'ABORTED', NO_PLAN)]


def test_a_map_that_opens_a_way_to_who_gives_up_waits_for_the_release():
    fleet = Fleet(make_scenario({'defaults': {'max_speed': 2.0, 'use_map': True, 'routes': 'grid', 'robot_radius': 0.0,
                                              'abort_policy': 'upstream'},
                                 'robots': [{'name': 'bot', 'start_x': 2.5, 'start_y': 5.5}]}), 0,
                  occupancy=area((slice(0, 12), 5)))
    fleet.robot('bot').hold('door')
    fleet.robot('bot').send(8.5, 5.5)
    fleet.run(S)
    fleet.use_map(area())
    fleet.run(100 * S)
    assert kinds(fleet) == [(0.0, 'held', 'door'), (0.0, 'goal', 'bot-1')]
    fleet.robot('bot').release('door')
    assert kinds(fleet)[2:] == [(100.0, 'released'), (100.0, 'departed', 8.5)]


# ---- with durations

def fleet_with(**settings):
    return Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 2.0, **settings}]}), 0)


def test_the_overhead_is_waited_for_once_and_the_factor_stays():
    fleet = fleet_with(goal_overhead=2.0, duration_factor=1.5)
    fleet.robot('bot').send(12.0, 0.0)
    fleet.run(S)
    fleet.robot('bot').hold('door')  # of the overhead a second is left, which passes meanwhile
    fleet.run(int(1.5 * S))
    fleet.robot('bot').release('door')
    fleet.run(5 * S)
    assert fleet.robot('bot').pose.x == 4.0
    fleet.robot('bot').hold('door')
    fleet.run(7 * S)
    fleet.robot('bot').release('door')
    fleet.run()
    assert (fleet.now_ns, fleet.robot('bot').pose.x) == (13 * S, 12.0)


def test_a_drawn_factor_is_that_of_the_goal_before_and_after_a_hold():
    settings = {'duration_distribution': 'lognormal', 'duration_cv': 0.5, 'seed': 3}
    whole, parted = fleet_with(**settings), fleet_with(**settings)
    for fleet in (whole, parted):
        fleet.robot('bot').send(40.0, 0.0)
    parted.run(5 * S)
    parted.robot('bot').hold('door')
    parted.run(9 * S)
    parted.robot('bot').release('door')
    assert parted.run() - 4 * S == pytest.approx(whole.run(), abs=10)


@pytest.mark.parametrize('seed', range(5))
def test_where_a_robot_is_to_fail_it_fails_however_often_it_is_held_on_the_way(seed):
    settings = {'failure_by_length': [[0.0, 1.0]], 'acceleration': 1.0, 'seed': seed}
    whole, parted = fleet_with(**settings), fleet_with(**settings)
    for fleet in (whole, parted):
        fleet.robot('bot').send(40.0, 0.0)
    whole.run()
    for at in range(2, 60, 2):
        parted.run(at * S)
        parted.robot('bot').hold('door')
        parted.run(at * S + S // 3)
        parted.robot('bot').release('door')
    parted.run()
    assert [entry.values for entry in parted.trace if entry.kind == 'ended'] == [('bot-1', 'ABORTED', NO_CONTROL)]
    assert parted.robot('bot').pose.x == pytest.approx(whole.robot('bot').pose.x, abs=1e-7)
