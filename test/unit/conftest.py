"""What the unit tests share: repeatable properties, a navigator with its surroundings."""

import os

import pytest
from hypothesis import HealthCheck, settings
from night import times

from move_base_abstract.common.errors import FrameError
from move_base_abstract.common.units import seconds_to_ns
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import (
    Aimed,
    Departed,
    Ended,
    Held,
    Recovery,
    Stands,
    Warned,
    WheelsStopped,
    robot_stream,
)
from move_base_abstract.goals.ledger import GoalLedger
from move_base_abstract.goals.navigator import BadFramePolicy, GoalPose, Navigator
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.maps.planning import StraightLinePlanner, WorldBounds
from move_base_abstract.motion.frames import RobotFrames
from move_base_abstract.motion.geometry import Pose2D, quaternion_of_yaw
from move_base_abstract.motion.leg import MotionLimits, Tolerances
from move_base_abstract.motion.robot import Robot

# Every run takes the same examples, however slow the machine is: what is found by chance is found by `make explore`.
settings.register_profile('repeatable', derandomize=True, database=None, deadline=None, max_examples=times(80, 600),
                          suppress_health_check=[HealthCheck.too_slow])
settings.register_profile('explore', settings.get_profile('repeatable'), derandomize=False, print_blob=True,
                          max_examples=int(os.environ.get('EXAMPLES') or 5000))
settings.load_profile('repeatable')


class NavigatorRig(NoClient):
    """One navigator, driven by hand in simulated seconds; ``trace`` gets all that it tells the outside, in order."""

    def __init__(self, start=Pose2D(), limits=MotionLimits(2.0), tolerances=Tolerances(), bounds=WorldBounds(),
                 feedback_freq=0.0, foreign=None, bad_frame_policy=BadFramePolicy.ABORT,
                 recovery_policy=RecoveryPolicy(), patience=0.0, longest_wait=2147483647.0):
        super().__init__('made-up')
        self.trace = []
        self.foreign = foreign or {}
        self.simulation = Simulation()
        self.robot = Robot(0, 'robot_0', start, limits, tolerances)
        stream = self._stream()
        self.ledger = GoalLedger('robot_0', stream, self)
        frames = RobotFrames(self.robot, 'map', 'odom', 'base_link', self._lookup, lambda: seconds_to_ns(patience))
        self.navigator = Navigator(self.robot, self.simulation, self.ledger, frames, stream, self,
                                   StraightLinePlanner(bounds), bad_frame_policy, recovery_policy,
                                   longest_wait_ns=seconds_to_ns(longest_wait))
        self.navigator.feedback.set_frequency(feedback_freq)

    def advance(self, seconds):
        """Let the clock show ``seconds``; return the trace up to then and begin a new one."""
        self.simulation.advance(seconds_to_ns(seconds))
        return self.told()

    def told(self):
        trace, self.trace = self.trace, []
        return trace

    def send(self, goal_id, x, y, yaw=0.0, frame='map', stamp=0.0, id_stamp=0.0, quaternion=None,
             height=0.0):
        """Hand the navigator a goal at the present; return what it tells about it at once."""
        goal = GoalPose(frame, seconds_to_ns(stamp), (x, y), quaternion or quaternion_of_yaw(yaw),
                        height)
        self.navigator.receive(goal_id, seconds_to_ns(id_stamp), goal, self.simulation.now_ns)
        return self.told()

    def cancel(self, goal_id='', stamp=0.0):
        self.navigator.cancel(goal_id, seconds_to_ns(stamp), self.simulation.now_ns)
        return self.told()

    def place(self, pose):
        self.navigator.travel.place(pose, self.simulation.now_ns)
        return self.told()

    def hold(self, reason):
        self.navigator.travel.hold(reason, self.simulation.now_ns)
        return self.told()

    def release(self, reason):
        self.navigator.travel.release(reason, self.simulation.now_ns)
        return self.told()

    def _lookup(self, frame_id, stamp_ns):
        if frame_id not in self.foreign:
            raise FrameError("'{}' is not known to tf".format(frame_id))
        return self.foreign[frame_id](stamp_ns)

    def feedback(self, record, pose, stamp_ns, is_last):
        self.trace.append(('feedback', record.goal_id, pose, stamp_ns))

    def _note(self, kind, *values):
        """Return what puts ``kind`` with these fields of an event into the trace."""
        return lambda event: self.trace.append((kind, *(getattr(event, value) for value in values)))

    def _stream(self):
        stream = robot_stream()
        stream.subscribe('trace', {
            Ended: lambda event: self.trace.append(
                ('result', event.goal_id, event.state.name, event.text, event.time_ns)),
            Departed: lambda event: self.trace.append(('departed', Pose2D(*event[3:6]), event.time_ns)),
            Stands: lambda event: self.trace.append(('stands', Pose2D(*event[3:6]), event.time_ns)),
            Aimed: self._note('target', 'goal', 'time_ns'), Held: self._note('held', 'reasons', 'time_ns'),
            WheelsStopped: self._note('stop wheels'), Warned: self._note('warn', 'text'),
            Recovery: lambda event: self.trace.append(('recovery', event.behaviors[event.index].name, event.index,
                                                       len(event.behaviors), event.time_ns))})
        return stream


@pytest.fixture(scope='session')
def rig():
    """Return the class, so that each test says what its robot is like."""
    return NavigatorRig
