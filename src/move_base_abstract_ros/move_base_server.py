"""One robot under move_base's interface: the core's navigator between its topics, services and parameters."""
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseActionGoal

from move_base_abstract.frames import RobotFrames
from move_base_abstract.navigator import Navigator, NavigatorListener
from move_base_abstract.outcome import NODE_KILLED
from move_base_abstract.planning import StraightLinePlanner
from move_base_abstract.recovery import DEFAULT_BEHAVIORS, RecoveryPolicy
from move_base_abstract.robot import Robot

from . import backends, conversions
from .goal_server import GoalServer
from .planner_interface import PlannerInterface
from .reconfigure import Reconfigure
from .robot_publisher import RobotPublisher
from .teleport import Teleport
from .tf_lookup import TfLookup
from .throttle import WallThrottle

_REPEATED_WARNINGS_RATE = 0.2


class MoveBaseServer(NavigatorListener):
    """Hosts one robot. Several of them may share a process and its :class:`RosClock`."""

    def __init__(self, names, settings, clock, robot_index=0):
        self._names = names
        self._settings = settings
        self._clock = clock
        self._last_warning = None
        self._warning_throttle = WallThrottle(_REPEATED_WARNINGS_RATE)
        with clock.lock:
            now_ns = clock.now_ns()
            self._build(robot_index, now_ns)
        self._teleport = Teleport(names, clock, self.navigator, self._frames, self._prefetch_frame)
        self._planner_interface = PlannerInterface(names, settings, clock, self.navigator)
        self._reconfigure = Reconfigure(names, settings, self)
        self._goal_server.start(self.navigator, robot_index, self._prefetch)
        self._own_goals = rospy.Publisher(names.action('goal'), MoveBaseActionGoal, queue_size=1)
        rospy.Subscriber(names.topic('move_base_simple/goal'), PoseStamped, self._on_simple_goal, queue_size=1)

    def _build(self, robot_index, now_ns):
        settings, values = self._settings, self._settings.values
        backend = backends.make(values['backend'], self._names, settings)
        robot = Robot(robot_index, self._names.robot, settings.start, settings.limits, settings.tolerances, now_ns)
        self._lookup = TfLookup(values['global_frame'], values['frame_timeout'])
        self._frames = RobotFrames(robot, values['global_frame'], settings.frame(values['odom_frame']),
                                   settings.frame(values['robot_base_frame']), self._lookup.lookup)
        self._goal_server = GoalServer(self._names.action('').rstrip('/'), self._names.private, self._clock,
                                       values['min_answer_delay'])
        self.navigator = Navigator(robot, self._clock.simulation, self._goal_server.ledger, self._frames, self,
                                   StraightLinePlanner(settings.bounds))
        self.navigator.bad_frame_policy = settings.bad_frame_policy
        self.navigator.recovery_policy = settings.recovery
        self.navigator.set_feedback_frequency(values['feedback_freq'])
        self._feedback_throttle = WallThrottle(values['max_feedback_rate'])
        self._publisher = RobotPublisher(self._names, settings, self._clock.simulation, robot, backend)

    def shut_down(self):
        """End the active goal as a killed move_base does, and let the answer leave."""
        with self._clock.lock:
            self.navigator.shut_down(NODE_KILLED, self._clock.now_ns())
        self._goal_server.flush()

    def set_motion(self, limits, tolerances):
        """Travel with other limits from the next leg on."""
        with self._clock.lock:
            self.navigator.robot.limits = limits
            self.navigator.robot.tolerances = tolerances

    def reconfigure_goals(self, config):
        """Take over what dynamic_reconfigure says of move_base itself."""
        policy = self._settings.recovery
        behaviors = policy.behaviors or DEFAULT_BEHAVIORS
        with self._clock.lock:
            self.navigator.recovery_policy = RecoveryPolicy(
                policy.fast, 0.0 if config['max_planning_retries'] >= 0 else config['planner_patience'],
                behaviors if config['recovery_behavior_enabled'] else ())
            if config['controller_frequency'] != self._settings.values['controller_frequency']:
                self._settings.values['controller_frequency'] = config['controller_frequency']
                self.navigator.set_feedback_frequency(config['controller_frequency'])
        self._planner_interface.add_unreachable_goal = config['make_plan_add_unreachable_goal']

    def departed(self, robot, goal, now_ns):
        """Show that the robot starts."""
        self._publisher.departed(now_ns)
        self._planner_interface.show(robot.pose_at(now_ns), goal, now_ns)

    def stands(self, robot, now_ns):
        """Show that the robot stands."""
        self._publisher.stands(now_ns)

    def target(self, goal, now_ns):
        """Show the goal that is worked on."""
        self._publisher.target(goal, now_ns)

    def stop_wheels(self):
        """Publish a zero velocity."""
        self._publisher.stop_wheels()

    def feedback(self, record, pose, stamp_ns):
        """Tell the goal's client where the robot is, as often as the cap in wall time allows."""
        if self._goal_server.has_feedback_listeners() and self._feedback_throttle.ready():
            self._goal_server.publish_feedback(
                record, conversions.to_pose_stamped(pose, self._frames.global_frame, stamp_ns), stamp_ns)

    def recovery(self, pose, index, behaviors, stamp_ns):
        """Announce a recovery behaviour."""
        self._publisher.recovery(pose, index, behaviors, stamp_ns)

    def warn(self, text):
        """Log a warning; the same one once in 5 s."""
        if text != self._last_warning or self._warning_throttle.ready():
            self._last_warning = text
            rospy.logwarn('%s: %s', self._names.robot, text)

    def _prefetch(self, goal):
        self._prefetch_frame(goal.frame_id, goal.stamp_ns)

    def _prefetch_frame(self, frame_id, stamp_ns):
        """Give a foreign frame time to become known; this blocks only the topic that asks for it."""
        if self._frames.is_foreign(frame_id) and not frame_id.startswith('/'):
            self._lookup.wait_for(frame_id, stamp_ns)

    def _on_simple_goal(self, pose):
        """Send an RViz goal the way any client does: on the action's own goal topic, without an id."""
        goal = MoveBaseActionGoal()
        with self._clock.lock:
            goal.header.stamp = conversions.to_time(self._clock.now_ns())
        goal.goal.target_pose = pose
        self._own_goals.publish(goal)
