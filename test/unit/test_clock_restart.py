"""A clock that has started anew: goals end, and everything goes on by the new time from where it was."""
import pytest

from move_base_abstract.common.errors import TimeError
from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.motion.geometry import Pose2D

S = NS_PER_S
RESTARTED = 'Aborting on the goal because simulated time has started anew'


def restart(robot, now_ns):
    """Have the clock of a NavigatorRig start anew at ``now_ns``; return what is told."""
    before_ns = robot.simulation.now_ns
    robot.simulation.restart(now_ns)
    robot.navigator.restart(before_ns, now_ns)
    return robot.told()


def test_what_was_due_comes_as_much_later_in_the_old_order():
    simulation = Simulation(now_ns=100 * S)
    lines = []
    for due_ns, name in ((103 * S, 'b'), (101 * S, 'a'), (103 * S, 'c')):
        simulation.queue.schedule(due_ns, 0, lambda due, _now, name=name: lines.append((due, name)))
    series = simulation.series(1, 0.5, lambda due, _now: lines.append((due, 'beat')))
    series.start(102 * S)
    simulation.restart(S // 10)
    assert simulation.now_ns == S // 10
    for second in range(1, 6):
        simulation.advance(second * S)
    assert lines == [(11 * S // 10, 'a'), (21 * S // 10, 'beat'), (31 * S // 10, 'b'), (31 * S // 10, 'c'),
                     (41 * S // 10, 'beat')]


def test_the_goal_under_way_is_aborted_by_the_new_time_and_the_robot_stands_where_it_was(rig):
    robot = rig()
    robot.advance(100.0)
    robot.send('g', 20.0, 0.0)
    robot.advance(103.0)
    assert restart(robot, S // 10) == [('stop wheels',), ('result', 'g', 'ABORTED', RESTARTED, S // 10),
                                       ('stands', Pose2D(6.0, 0.0), S // 10)]
    assert robot.advance(1000.0) == []
    assert robot.robot.distance_at(1000 * S) == 6.0


def test_a_robot_that_stands_goes_on_standing_and_takes_goals_of_the_new_time(rig):
    robot = rig(start=Pose2D(1.0, 2.0))
    robot.advance(100.0)
    assert restart(robot, S // 10) == [('stands', Pose2D(1.0, 2.0), S // 10)]
    robot.send('g', 3.0, 2.0)
    assert robot.advance(2.0)[-1] == ('result', 'g', 'SUCCEEDED', 'Goal reached.', 11 * S // 10)
    with pytest.raises(TimeError, match='nothing before 100000000 ns is remembered'):
        robot.robot.pose_at(0)


def test_stamps_of_the_old_time_decide_nothing_any_more(rig):
    robot = rig()
    robot.advance(100.0)
    robot.send('old', 2.0, 0.0, id_stamp=100.0)
    robot.advance(102.0)
    robot.cancel(stamp=102.0)
    restart(robot, S // 10)
    told = robot.send('new', 4.0, 0.0, id_stamp=0.1)
    assert ('departed', Pose2D(4.0, 0.0), S // 10) in told


def test_a_goal_that_waits_for_its_stamp_is_aborted_too(rig):
    robot = rig(foreign={'camera': lambda _stamp_ns: Pose2D()})
    robot.advance(100.0)
    robot.send('g', 1.0, 0.0, frame='camera', stamp=200.0)
    assert ('result', 'g', 'ABORTED', RESTARTED, S // 10) in restart(robot, S // 10)
    assert robot.advance(1000.0) == []


def test_what_has_ended_stays_on_the_list_for_its_five_seconds_of_the_new_time(rig):
    robot = rig()
    robot.advance(100.0)
    robot.send('g', 20.0, 0.0)
    restart(robot, S)
    assert [record.goal_id for record in robot.ledger.records(6 * S)] == ['g']
    assert robot.ledger.records(6 * S + 1) == []


def test_feedback_comes_with_the_next_goal(rig):
    robot = rig(feedback_freq=1.0)
    robot.advance(100.0)
    robot.send('g', 20.0, 0.0)
    restart(robot, S)
    assert robot.advance(10.0) == []
    robot.send('h', 10.0, 0.0)
    robot.advance(10.5)
    assert ('feedback', 'h', Pose2D(2.0, 0.0), 11 * S) in robot.advance(11.0)
