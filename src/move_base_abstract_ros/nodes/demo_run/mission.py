"""Carry out a mission: send each robot its goals one after the other.

It works with any move_base action servers under the robots' names. It uses actionlib's ActionClient, because a
SimpleActionClient loses replies if a goal is sent from its done callback.
"""

import queue
import time

import rospy
from actionlib import ActionClient, CommState, GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

from move_base_abstract.motion.geometry import quaternion_of_yaw

SERVER_TIMEOUT = 30.0  # s, wall


class MissionFailed(RuntimeError):
    """An action server is missing, or a goal did not succeed. The text names the robot, the goal and the reason."""


class RobotRun:
    """One robot of the mission: its plan, its action client, and the number of goals that it has reached."""

    def __init__(self, plan):
        self.plan = plan
        self.goals_done = 0
        self._client = ActionClient(f'/{plan.name}/move_base', MoveBaseAction)
        self._handle = None  # a client forgets a goal whose handle is gone

    def ready(self):
        """Return, without waiting, whether client and server are connected."""
        return self._client.wait_for_server(rospy.Duration(nsecs=-1))

    def send_next(self, events):
        """Send the next goal. When it ends, (self, handle) is put into the queue ``events``."""
        self._handle = self._client.send_goal(make_goal(self.plan.goals[self.goals_done]), lambda handle: (
            events.put((self, handle)) if handle.get_comm_state() == CommState.DONE else None))


class MissionRun:
    """All robots of a mission. Call wait_until_ready, then run, both from one thread.

    ``participant``: the Participant of this process in lockstep, or None on the scaled clock.
    """

    def __init__(self, mission, participant=None):
        self._participant = participant
        self.mission = mission
        self.robots = [RobotRun(plan) for plan in mission.robots]
        self.started = None  # (simulated, wall) time [s] when the first goal was sent
        self.ended = None  # (simulated, wall) time [s] of the last result; simulated: the latest stamp of a result
        self._events = queue.Queue()

    @property
    def done(self):
        """Number of goals reached by all robots together."""
        return sum(robot.goals_done for robot in self.robots)

    def elapsed(self):
        """Return the (simulated, wall) seconds from the first goal to the end, or to now if it has not ended."""
        if self.started is None:
            return 0.0, 0.0
        now = self.ended or (rospy.get_time(), time.monotonic())
        return now[0] - self.started[0], now[1] - self.started[1]

    def wait_until_ready(self, check):
        """Wait for all action servers. On the scaled clock call ``check``, which may raise, meanwhile.

        :raises MissionFailed: on the scaled clock, if that takes more than SERVER_TIMEOUT of wall time.
        """
        if self._participant is not None:
            self._participant.wait_until(lambda: all(robot.ready() for robot in self.robots), what='the robots')
            return
        deadline = time.monotonic() + SERVER_TIMEOUT
        waiting = list(self.robots)
        while waiting:
            check()
            if rospy.get_rostime():  # 0 until the first /clock
                waiting = [robot for robot in waiting if not robot.ready()]
            if waiting and time.monotonic() > deadline:
                names = ', '.join(f'/{robot.plan.name}/move_base' for robot in waiting)
                raise MissionFailed(f'after {SERVER_TIMEOUT:g} s there is no ' + (
                    f'action server: {names}' if rospy.get_rostime() else 'message on /clock'))
            time.sleep(0.02)

    def run(self, tick, period=0.1):
        """Carry out the mission. Call ``tick``, which may raise, about every ``period`` [s, wall].

        In lockstep, it is called only when a goal ends.

        :raises MissionFailed: if a goal does not succeed.
        """
        self.started = rospy.get_time(), time.monotonic()
        for robot in self.robots:
            robot.send_next(self._events)
        last_stamp = 0.0
        next_tick = self.started[1]
        while self.done < self.mission.goal_count:
            if time.monotonic() >= next_tick:
                tick()
                next_tick = time.monotonic() + period
            ended = self._next_ended(period)
            if ended is not None:
                last_stamp = max(last_stamp, self._finish_goal(*ended))
        self.ended = last_stamp, time.monotonic()

    def _next_ended(self, period):
        """Return the next (robot, handle) of an ended goal; None if there is none within ``period`` [s, wall]."""
        if self._participant is not None:  # no timeout: in lockstep it would take simulated time
            self._participant.wait_until(self._events.qsize, what='the end of a goal')
            return self._events.get_nowait()
        try:
            return self._events.get(timeout=period)
        except queue.Empty:
            return None

    def _finish_goal(self, robot, handle):
        """Count a goal and send the next; return the simulated time of its end [s]."""
        state = handle.get_terminal_state()
        if state != GoalStatus.SUCCEEDED:
            place = robot.plan.goals[robot.goals_done]
            raise MissionFailed(f'{robot.plan.name}: goal {robot.goals_done + 1} of {len(robot.plan.goals)}, '
                                f'({place.x:.2f}, {place.y:.2f}) m in map, ended {GoalStatus.to_string(state)}: '
                                f"'{handle.get_goal_status_text()}'")
        robot.goals_done += 1
        if robot.goals_done < len(robot.plan.goals):
            robot.send_next(self._events)
        return handle.comm_state_machine.latest_result.header.stamp.to_sec()


def make_goal(place, frame_id='map'):
    """Return a MoveBaseGoal for ``place`` (x and y [m], yaw [rad]) in the frame, stamped now."""
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = frame_id
    goal.target_pose.header.stamp = rospy.Time.now()
    goal.target_pose.pose.position.x = place.x
    goal.target_pose.pose.position.y = place.y
    orientation = goal.target_pose.pose.orientation
    orientation.x, orientation.y, orientation.z, orientation.w = quaternion_of_yaw(place.yaw)
    return goal
