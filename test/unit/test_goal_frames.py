"""Goals in frames that tf tells of, with stamps whose poses are yet to come."""
import pytest

from move_base_abstract.common.errors import FrameError
from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.motion.geometry import Pose2D
from test_navigator import S, aborted, bad_frame, begins


class Tractor:
    """A frame at 1 m/s whose poses tf knows up to ``known`` [s]."""

    def __init__(self, known=0.0):
        self.known = known

    def __call__(self, stamp_ns):
        if stamp_ns > self.known * S:
            raise FrameError('the latest data is at {} s'.format(self.known))
        return Pose2D((stamp_ns / S) or self.known, 0.0)


def test_a_goal_in_a_moving_foreign_frame_of_the_future_waits_for_its_stamp(rig):
    tractor = Tractor()
    robot = rig(foreign={'tractor': tractor})
    assert robot.send('g', 0.0, 1.0, frame='tractor', stamp=2.0) == []
    assert robot.advance(1.9) == []
    tractor.known = 2.0
    assert robot.advance(2.0) == begins(Pose2D(2.0, 1.0), 2 * S)


@pytest.mark.parametrize('sent, stamp, found', [
    (0.0, 2.0, 2.55), (2.0, 2.0, 2.55), (2.1, 2.0, 2.55), (1.98, 2.02, 2.52)])
def test_the_pose_of_the_stamp_is_waited_for_too(rig, sent, stamp, found):
    tractor = Tractor(1.9)
    robot = rig(foreign={'tractor': tractor}, patience=1.0)
    robot.advance(sent)
    assert robot.send('g', 0.0, 1.0, frame='tractor', stamp=stamp) == []
    robot.advance(2.5)
    tractor.known = 2.6
    assert robot.advance(found)[1:] == begins(Pose2D(stamp, 1.0), seconds_to_ns(found))[1:]


def test_a_pose_that_does_not_come_within_the_patience_ends_the_goal(rig):
    robot = rig(foreign={'tractor': Tractor(1.9)}, patience=1.0)
    robot.send('g', 0.0, 1.0, frame='tractor', stamp=2.0)
    text = bad_frame('tractor', 'the latest data is at 1.9 s')
    assert robot.advance(9.0) == [('warn', text), *aborted('g', text, 3 * S)]
    assert robot.send('h', 0.0, 1.0, frame='tractor', stamp=7.0) == [('warn', text), *aborted('h', text, 9 * S)]


def test_a_foreign_frame_that_does_not_move_is_found_at_once_at_any_stamp(rig):
    robot = rig(foreign={'dock': lambda _stamp_ns: Pose2D(3.0, 0.0)})
    assert robot.send('g', 1.0, 0.0, frame='dock', stamp=1e6) == begins(Pose2D(4.0, 0.0), 0)


def test_a_goal_of_the_future_in_an_unknown_frame_does_not_wait(rig):
    text = bad_frame('nowhere', "'nowhere' is not known to tf")
    assert rig(patience=1.0).send('g', 0.0, 1.0, frame='nowhere', stamp=9.0) == [('warn', text), *aborted('g', text, 0)]


def test_a_frame_that_is_lost_before_the_stamp_ends_the_goal_then(rig):
    robot = rig(foreign={'tractor': Tractor()}, patience=1.0)
    robot.send('g', 0.0, 1.0, frame='tractor', stamp=2.0)

    def lost(_stamp_ns):
        raise FrameError('lost')

    robot.foreign['tractor'] = lost
    text = bad_frame('tractor', 'lost')
    assert robot.advance(9.0) == [('warn', text), *aborted('g', text, 2 * S)]
