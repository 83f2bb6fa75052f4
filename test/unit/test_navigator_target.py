"""The target of a robot: where the goal that it works on is, as others are shown it."""

from move_base_abstract.motion.geometry import Pose2D


def test_while_a_goal_waits_for_its_stamp_the_target_of_the_one_before_it_is_none_any_more(rig):
    robot = rig()
    robot.send('a', 9.0, 0.0)
    assert robot.navigator.travel.target == Pose2D(9.0, 0.0)
    robot.advance(1.0)
    robot.send('b', 1.0, 0.0, frame='base_link', stamp=5.0)
    assert robot.navigator.travel.target is None
    robot.advance(5.0)
    assert robot.navigator.travel.target == Pose2D(3.0, 0.0)
