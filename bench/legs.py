"""The simulated time that legs take, as a stock action client sees it, compared with the ideal duration."""

import math
import queue
import statistics
import time

import rospy
from actionlib import ActionClient, CommState, GoalStatus
from move_base_msgs.msg import MoveBaseAction
from nav_msgs.msg import Odometry

from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract_ros.nodes.demo_run.mission import make_goal

SPEED = 2.0  # m/s
# The original package on a 2-core machine: {(length [m], factor): excess of the leg's duration [%]}.
PUBLISHED = {(20.0, 10): 4.5, (20.0, 15): 6.6, (20.0, 100): 40.0}
WANTED_SHARE = 0.2  # largest wanted share of the published excess
GUARD = 60.0  # s, wall, beyond three times the ideal duration


class Leg:
    """One leg: the times when it was sent, acknowledged and ended; simulated times in ns, wall times in s."""

    def __init__(self, start_x, goal_x):
        self.start_x = start_x  # m, map
        self.goal_x = goal_x
        self.ideal_ns = round(1e9 * abs(goal_x - start_x) / SPEED)
        self.sent_ns = rospy.get_rostime().to_nsec()
        self.sent_wall = time.monotonic()
        self.acknowledged_wall = None
        self.done_ns = None
        self.arrival_ns = None  # the result's own stamp
        self.departure_ns = None  # the stamp of the first pose of the leg, if it was seen

    def note(self, handle):
        """Note a transition of the client's state; return whether the goal has ended."""
        state = handle.get_comm_state()
        if state == CommState.ACTIVE and self.acknowledged_wall is None:
            self.acknowledged_wall = time.monotonic()
        if state != CommState.DONE:
            return False
        self.done_ns = rospy.get_rostime().to_nsec()
        self.arrival_ns = handle.comm_state_machine.latest_result.header.stamp.to_nsec()
        return True


class BenchRobot:
    """One robot that goes to and fro along x."""

    def __init__(self, name):
        self.name = name
        self.legs = []
        self.x = 0.0
        self.left = 0
        self._handle = None
        self._client = ActionClient(f'/{name}/move_base', MoveBaseAction)
        if not self._client.wait_for_server(rospy.Duration.from_sec(GUARD * 1000)):
            raise RuntimeError(f'no action server /{name}/move_base')

    def send(self, length_m, y, ended):
        """Send one leg of ``length_m`` at ``y`` [m]; at its end, (robot, goal handle) is put on the queue ``ended``."""
        start_x = self.x
        out = start_x <= 0.0
        self.x += length_m if out else -length_m
        goal = make_goal(Pose2D(self.x, y, 0.0 if out else math.pi))
        leg = Leg(start_x, self.x)
        self.legs.append(leg)
        self._handle = self._client.send_goal(
            goal, lambda handle: ended.put((self, handle)) if leg.note(handle) else None)


def run_legs(robots, length_m, count, factor):
    """Let all robots travel ``count`` legs each at the same time; return the Leg objects."""
    ended = queue.Queue()
    limit = GUARD + 3.0 * count * length_m / SPEED / factor
    for i, robot in enumerate(robots):
        robot.legs, robot.left = [], count
        robot.send(length_m, 2.0 * i, ended)
    deadline = time.monotonic() + limit
    while any(robot.left for robot in robots):
        robot, handle = ended.get(timeout=max(0.0, deadline - time.monotonic()))
        if handle.get_terminal_state() != GoalStatus.SUCCEEDED:
            raise RuntimeError(f'{robot.name}: a leg ended {GoalStatus.to_string(handle.get_terminal_state())}: '
                               f"'{handle.get_goal_status_text()}'")
        robot.left -= 1
        if robot.left:
            robot.send(length_m, 2.0 * robots.index(robot), ended)
    return [leg for robot in robots for leg in robot.legs]


def summarize(runs, length_m, factor, robot_count):
    """Return the record of one case; its figures are medians of the medians of the runs, each a list of legs.

    The excess over the ideal duration has two parts: `out` from the client's sending to the server's departure, and
    `back` from the arrival to the client's callback. The travel between them takes exactly the ideal duration; see the
    record 'stamps'.
    """
    ideal_s = length_m / SPEED

    def middle(value):
        return [statistics.median(value(leg) for leg in legs) for legs in runs]

    excess = [100.0 * value / ideal_s for value in middle(lambda leg: (leg.done_ns - leg.sent_ns - leg.ideal_ns) / 1e9)]
    record = {'kind': 'leg', 'length_m': length_m, 'factor': factor, 'robots': robot_count, 'runs': len(runs),
              'legs': sum(len(legs) for legs in runs), 'ideal_s': ideal_s, 'error_percent': statistics.median(excess),
              'error_percent_runs': excess,
              'out_s': statistics.median(middle(lambda leg: (leg.arrival_ns - leg.ideal_ns - leg.sent_ns) / 1e9)),
              'back_s': statistics.median(middle(lambda leg: (leg.done_ns - leg.arrival_ns) / 1e9))}
    hops = [leg.acknowledged_wall - leg.sent_wall for legs in runs for leg in legs if leg.acknowledged_wall]
    if hops:
        record['client_hop_wall_ms'] = 1e3 * statistics.median(hops)
        record['client_hop_percent'] = 100.0 * statistics.median(hops) * factor / ideal_s
    published = PUBLISHED.get((length_m, factor))
    if published is not None:
        record.update(published_percent=published, wanted_percent=WANTED_SHARE * published,
                      published_over_ours=published / record['error_percent'] if record['error_percent'] > 0 else None,
                      within_wanted=record['error_percent'] <= WANTED_SHARE * published)
    return record


def stamp_error(robots, length_m, count, factor):
    """Return the record of the errors of the server's own stamps [ns], without what the messages to the client add.

    The travel error is arrival stamp - departure stamp - ideal duration, for the legs whose departure was seen. The
    pose error, for every pose on base_pose_ground_truth, is its stamp - (arrival stamp - way left / speed).
    """
    poses = {robot.name: [] for robot in robots}
    subscribers = [rospy.Subscriber(f'/{name}/base_pose_ground_truth', Odometry, kept.append, tcp_nodelay=True)
                   for name, kept in poses.items()]
    while not all(poses.values()):  # the topic is latched, so each connection brings one pose
        time.sleep(0.01)
    run_legs(robots, length_m, count, factor)
    time.sleep(0.5)  # so that the last poses arrive
    for subscriber in subscribers:
        subscriber.unregister()
    travel, on_the_way = [], []
    for robot in robots:
        for leg in robot.legs:
            errors = _pose_errors(leg, poses[robot.name])
            on_the_way += errors
            if errors and leg.departure_ns is not None:
                travel.append(leg.arrival_ns - leg.departure_ns - leg.ideal_ns)
    return {'kind': 'stamps', 'factor': factor, 'robots': len(robots), 'legs': len(robots) * count,
            'legs_with_departure': len(travel), 'largest_travel_error_ns': max(map(abs, travel), default=None),
            'poses': len(on_the_way), 'largest_pose_error_ns': max(map(abs, on_the_way), default=None)}


def _pose_errors(leg, poses):
    """Return the stamp errors [ns] of the moving poses of a leg, and note the departure of the leg."""
    errors = []
    for pose in poses:
        stamp_ns = pose.header.stamp.to_nsec()
        if leg.sent_ns <= stamp_ns < leg.arrival_ns and pose.twist.twist.linear.x > 0.0:
            left_ns = round(1e9 * abs(leg.goal_x - pose.pose.pose.position.x) / SPEED)
            errors.append(stamp_ns + left_ns - leg.arrival_ns)
            if pose.pose.pose.position.x == leg.start_x:
                leg.departure_ns = stamp_ns
    return errors
