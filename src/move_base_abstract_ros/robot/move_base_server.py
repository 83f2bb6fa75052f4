"""One robot under move_base's interface: connects the core's navigator with topics, services and parameters."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence

import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseActionGoal
from nav_msgs.srv import SetMap, SetMapResponse
from std_srvs.srv import Empty, EmptyResponse

from move_base_abstract.fleet.robot_parts import make_planner, make_robot_parts
from move_base_abstract.fleet.robot_rows import tell_start
from move_base_abstract.goals.events import Beyond, Departed
from move_base_abstract.goals.recovery import RecoveryPolicy

from .. import backends
from ..maps.costmap_topics import CostmapTopics
from ..maps.planner_interface import PlannerInterface
from ..maps.robot_map import RobotMap
from ..messages import conversions
from ..replacing.single_connections import keep_apart
from ..transforms.tf_lookup import TfLookup
from .goal_server import GoalServer
from .reconfigure import Reconfigure
from .robot_publisher import RobotPublisher
from .robot_server import PriorityTopic, RobotServer
from .teleport import Teleport

if TYPE_CHECKING:
    from move_base_abstract.goals.goal_pose import GoalPose
    from move_base_abstract.motion.leg import MotionLimits, Tolerances

    from ..clocks.timing import Clock
    from .names import RobotNames


class MoveBaseServer(RobotServer):
    """One robot of a process's :class:`Host` that travels to goals."""

    def _set_up(self) -> None:
        names, settings, clock, host = self._names, self._settings, self._clock, self._host
        self._teleport = Teleport(names, settings, clock, self.navigator.robot, self.navigator.travel.place,
                                  self._frames, self._prefetch_frame)
        self._localization = Localization(names, self._map, self._show, self._teleport.place) if (
            settings.values['backend'] in backends.BUILTIN) else None  # with other backends amcl itself may run
        self._planner_interface = PlannerInterface(names, settings, clock, self.navigator, self._map,
                                                   self._stream)
        self._reconfigure = Reconfigure(names, settings, self)
        self._condition_server.serve()
        if self._traveller is not None:
            self._priority = PriorityTopic(names, clock, self._traveller)
        through_the_topic = host.timing.has_own_goal_connection(host.is_crowded)
        # The publisher of the goal topic comes before the subscription of the same topic, see single_connections.
        self._simple_goals = SimpleGoals(names, clock, None if through_the_topic else self._goal_server.take)
        self._goal_server.start(self._ledger, self.navigator, self._prefetch)
        self._simple_goals.listen()
        self._map.follow_changes(self._map_changed)

    def _build(self, robot_index: int) -> None:
        settings, values = self._settings, self._settings.values
        self._controller_frequency = values['controller_frequency']
        self._stream.subscribe('shown', {Beyond: self._host.warn_of_beyond})
        if settings.original is not None:
            self._stream.subscribe('shown', {Departed: self._compare})
        backend = backends.make(values['backend'], self._names, settings, self._host.timing)
        self._lookup = TfLookup(values['global_frame'], values['frame_timeout'], self._clock)
        self._map = RobotMap(self._names, settings, self._clock)
        self._goal_server = GoalServer(self._names.action('').rstrip('/'), self._names.private, self._host,
                                       self._stream, values)
        parts = make_robot_parts(settings, self._names.robot, robot_index, self._clock.simulation, self._stream,
                                 self._goal_server, self._lookup.lookup, make_planner(settings, self._map.check),
                                 self._host.zones, encounters=self._host.encounters,
                                 patience_ns=lambda: self._clock.patience_ns(values['frame_timeout']))
        robot, self._frames, self._ledger, self.navigator, self.condition = parts[:5]
        self._host.timing.tell_motion(robot, robot_index)
        tell_start(self._stream, robot, settings.durations, self._clock.look_ns())
        self.navigator.feedback.set_frequency(values['feedback_freq'])
        costmaps = CostmapTopics(self._names, settings, self._host, self._map)
        self._publisher = RobotPublisher(self._names, settings, self._host, robot, backend, costmaps,
                                         self._stream)
        self._begin(robot, backend, robot_index)

    def shut_down(self) -> None:
        """End the active goal as a killed move_base does, and send its answer."""
        super().shut_down()
        self._goal_server.flush()

    def _topics(self) -> Sequence[Any]:
        return (self._map, self._simple_goals, self._teleport, self._reconfigure, self._planner_interface,
                self._condition_server, self._localization, self._priority)

    def _forget_goals(self, is_removed: bool) -> None:
        self._goal_server.flush()
        if is_removed:
            self._goal_server.close()
            return
        self._ledger.clear()
        self._goal_server.reset()

    def _put_at_start(self, now_ns: int) -> None:
        self.navigator.robot.set_motion(self._settings.limits, self._settings.tolerances)
        super()._put_at_start(now_ns)

    def set_motion(self, limits: MotionLimits, tolerances: Tolerances) -> None:
        """Use other limits (MotionLimits) from now on, and tolerances (Tolerances) from the next leg on."""
        with self._clock.lock:
            self.navigator.travel.set_motion(limits, tolerances, self._clock.now_ns())

    def reconfigure_goals(self, config: Any) -> None:
        """Use the values that dynamic_reconfigure has set for move_base itself. ``config``: {name: value}."""
        policy, behaviors = self._settings.recovery, self._settings.behaviors
        with self._clock.lock:
            self._clock.now_ns()  # new feedback begins now
            self.navigator.set_recovery_policy(RecoveryPolicy(
                policy.fast, 0.0 if config['max_planning_retries'] >= 0 else config['planner_patience'],
                behaviors if config['recovery_behavior_enabled'] else ()))
            if config['controller_frequency'] != self._controller_frequency:
                self._controller_frequency = config['controller_frequency']
                self.navigator.feedback.set_frequency(config['controller_frequency'])
                self._host.rates.changed()
        self._planner_interface.set_add_unreachable_goal(config['make_plan_add_unreachable_goal'])

    def _show(self) -> None:
        with self._clock.lock:
            self._publisher.place(self._clock.now_ns())

    def _compare(self, _event: Departed) -> None:
        robot, law = self.navigator.robot, self._settings.original
        assert robot.leg is not None and law is not None  # it departs; without a law nothing is subscribed
        rospy.loginfo('%s: %s', robot.name, law.compare(robot.leg.distance, robot.limits))

    def _map_changed(self) -> None:
        with self._clock.lock:
            if self.navigator.travel.target is not None:
                self.navigator.travel.map_changed(self._clock.now_ns())

    def _prefetch(self, goal: GoalPose) -> None:
        self._map.wait()
        self._prefetch_frame(goal.frame_id, goal.stamp_ns)


class Localization:
    """Offers ``global_localization``, ``request_nomotion_update`` and ``set_map`` in the robot's namespace.

    ``show()`` publishes the robot's pose once more. ``place(header, pose)`` moves the robot to a pose, and returns ''
    or the reason why it cannot.
    """

    def __init__(self, names: RobotNames, robot_map: RobotMap, show: Callable[[], object],
                 place: Callable[[Any, Any], str]) -> None:
        self._robot = names.robot
        self._map = robot_map
        self._show = show
        self._place = place
        self._services = [rospy.Service(names.topic('global_localization'), Empty, self._spread),
                          rospy.Service(names.topic('request_nomotion_update'), Empty, self._update),
                          rospy.Service(names.topic('set_map'), SetMap, self._set_map)]

    def close(self) -> None:
        """Shut the services down."""
        for service in self._services:
            service.shutdown('the robot is removed')

    def _spread(self, _request: Any) -> Any:
        """Do nothing: there are no particles to spread, and the pose stays exact."""
        rospy.loginfo('%s: global_localization changes nothing: the pose is exact', self._robot)
        return EmptyResponse()

    def _update(self, _request: Any) -> Any:
        self._show()
        return EmptyResponse()

    def _set_map(self, request: Any) -> Any:
        """Move the robot to the pose of the request, and use the map of the request, if the robot uses one."""
        initial = request.initial_pose
        text = self._place(initial.header, initial.pose.pose) or self._map.give(request.map)
        if text:
            rospy.logwarn('%s: set_map: %s', self._robot, text)
        return SetMapResponse(success=not text)


_CONNECT_SECONDS = 5.0  # for the clock's wait_until: wall time, or simulated time in lockstep


class SimpleGoals:
    """Listens for poses and sends them as goals without an id, as any client could.

    The publisher on the goal topic is there from the start, before the node itself listens to that topic. It is
    connected to this node as to any other, unless ``take`` is given: a connection of a node to itself costs two threads
    and two sockets for each robot. With ``take``, ``take(id, stamp_ns, GoalPose)`` gets the goal, and only other nodes
    get it by the topic.
    """

    def __init__(self, names: RobotNames, clock: Clock,
                 take: Optional[Callable[[str, int, GoalPose], object]] = None) -> None:
        self._names = names
        self._clock = clock
        self._take = take
        self._subscriber: Any = None
        self._goals = rospy.Publisher(names.action('goal'), MoveBaseActionGoal, queue_size=1)

    def listen(self) -> None:
        """Begin to listen. The node must listen to the goal topic by now."""
        if self._take is not None:
            keep_apart(self._names.action('goal'))
        self._subscriber = rospy.Subscriber(self._names.topic('move_base_simple/goal'), PoseStamped, self._on_pose,
                                            queue_size=1)

    def close(self) -> None:
        """Unregister both topics."""
        self._subscriber.unregister()
        self._goals.unregister()

    def _on_pose(self, pose: Any) -> None:
        if self._take is None:
            # In lockstep this node is connected to itself within the present instant, or the goal topic is gone.
            self._clock.wait_until(lambda: self._goals.get_num_connections() > 0, _CONNECT_SECONDS,
                                   'its own goal topic')
        goal = MoveBaseActionGoal()
        with self._clock.lock:
            goal.header.stamp = conversions.to_time(self._clock.now_ns())
        goal.goal.target_pose = pose
        self._goals.publish(goal)
        if self._take is not None:
            self._take('', 0, conversions.from_target(pose))
