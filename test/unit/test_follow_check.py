from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.supervision.follow_check import FollowCheck


def test_reports_of_where_it_was_placed_are_right():
    check = FollowCheck()
    for step in range(100):
        check.placed(Pose2D(step), 0.1 * step)
        assert check.reported(Pose2D(step), 0.1 * step) is None


def test_reports_may_lag_behind_by_the_patience():
    check = FollowCheck(patience=2.0)
    for step in range(100):
        check.placed(Pose2D(step), 0.1 * step)
        assert check.reported(Pose2D(max(0, step - 19)), 0.1 * step) is None


def test_a_robot_that_stands_while_it_should_move_is_told_once_and_with_the_distance():
    check = FollowCheck(patience=2.0)
    told = []
    for step in range(100):
        check.placed(Pose2D(step), 0.1 * step)
        told.append(check.reported(Pose2D(), 0.1 * step))
    gaps = [gap for gap in told if gap is not None]
    assert len(gaps) == 1
    assert 40 <= gaps[0] <= 43


def test_it_is_told_again_after_it_has_followed():
    check = FollowCheck(patience=2.0)
    check.placed(Pose2D(5.0), 0.0)
    gaps = [check.reported(Pose2D(), wall) for wall in (0.0, 1.0, 2.0, 3.0)]
    assert gaps == [None, None, 5.0, None]
    assert check.reported(Pose2D(5.0), 4.0) is None
    assert [check.reported(Pose2D(4.0), wall) for wall in (5.0, 7.0)] == [None, 1.0]


def test_nothing_is_told_before_the_first_placement():
    assert FollowCheck().reported(Pose2D(100.0), 1000.0) is None
