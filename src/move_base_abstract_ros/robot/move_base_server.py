"""One robot under move_base's interface: the core's navigator between its topics, services and parameters."""
import rospy

from move_base_abstract.energy.battery import EMPTY
from move_base_abstract.fleet.robot_parts import make_planner, make_robot_parts
from move_base_abstract.goals.activity import activity
from move_base_abstract.goals.navigator import NavigatorListener
from move_base_abstract.goals.outcome import BATTERY_EMPTY, NODE_KILLED, ROBOT_REMOVED, ROBOT_RESET
from move_base_abstract.goals.recovery import RecoveryPolicy
from move_base_abstract.runs.trace import RobotTrace

from .. import backends, lockstep
from ..clocks.throttle import WallThrottle
from ..lockstep.exchange import rollback
from ..maps.costmap_topics import CostmapTopics
from ..maps.planner_interface import PlannerInterface
from ..maps.robot_map import RobotMap
from ..markers import robot_markers
from ..messages.packing import InFrame
from ..transforms import tf_watch
from ..transforms.tf_lookup import TfLookup
from .condition_server import ConditionServer
from .goal_server import GoalServer
from .reconfigure import Reconfigure
from .robot_publisher import RobotPublisher
from .simple_goals import SimpleGoals
from .teleport import Teleport
from .work_server import ACTION as WORK
from .work_server import WorkServer

_REPEATED_WARNINGS_RATE = 0.2  # Hz, wall
_DEAF_SECONDS = 0.1  # wall; how long a robot to whose feedback nobody listens is silent


class MoveBaseServer(NavigatorListener):
    """One robot of a process's :class:`Host`; ``rooms`` (Rooms): it does tasks at places, too."""

    def __init__(self, names, settings, host, robot_index=0, traffic=None, rooms=None):
        """``traffic``: the Traffic in which the robot takes part, None: it is alone."""
        clock = host.clock
        self._traffic = traffic
        self._traveller = None
        self._condition_server = None  # until the robot is whole
        self._rooms = rooms
        self._work = None
        self._names = names
        self._settings = settings
        self._clock = clock
        self._host = host
        self._controller_frequency = settings.values['controller_frequency']
        self._last_warning = None
        self._in_global_frame = InFrame(settings.values['global_frame'])
        self._told = None  # (goal id, stamp [ns]) of the latest feedback
        self._warning_throttle = WallThrottle(_REPEATED_WARNINGS_RATE)
        self._trace = RobotTrace(names.robot, host.events.record(robot_index), settings.values['log_motion'])
        with lockstep.sender(robot_index):
            self._set_up(robot_index)
        clock.follow_restarts(self._restart)
        host.add_robot()  # last: a robot whose settings are refused takes no share

    def _set_up(self, robot_index):
        names, settings, clock, host = self._names, self._settings, self._clock, self._host
        with clock.lock:
            clock.now_ns()
            self._build(robot_index)
        self._teleport = Teleport(names, settings, clock, self.navigator, self._frames, self._prefetch_frame)
        self._planner_interface = PlannerInterface(names, settings, clock, self.navigator, self._map)
        self._reconfigure = Reconfigure(names, settings, self)
        self._condition_server.serve()
        through_the_topic = host.timing.has_own_goal_connection(host.is_crowded)
        # First its publisher, then the subscription of the same topic: see single_connections.
        self._simple_goals = SimpleGoals(names, clock, None if through_the_topic else self._goal_server.take)
        self._goal_server.start(self._ledger, self.navigator, self._prefetch)
        self._simple_goals.listen()
        self._map.follow_changes(self._map_changed)
        if self._rooms is not None:
            values = settings.values
            self._work = WorkServer(names.topic(WORK), names.robot, robot_index, host, self._rooms, {
                'seed': values['seed'], 'frame': values['global_frame'],
                'feedback_freq': host.timing.task_feedback_frequency,
                'min_answer_delay': values['min_answer_delay']}, self.navigator.robot,
                None if self.condition.battery is None else self.condition.battery.load,
                lambda: self.condition.is_out_of_order, self._markers.changed)

    def _build(self, robot_index):
        settings, values = self._settings, self._settings.values
        backend = backends.make(values['backend'], self._names, settings, self._host.timing)
        self._lookup = TfLookup(values['global_frame'], values['frame_timeout'], self._clock)
        self._map = RobotMap(self._names, settings, self._clock)
        self._goal_server = GoalServer(self._names.action('').rstrip('/'), self._names.private, self._host,
                                       self._trace, values['min_answer_delay'])
        self.is_feedback_heard = self._host.timing.when_heard(self._goal_server.has_feedback_listeners)
        parts = make_robot_parts(settings, self._names.robot, robot_index, self._clock.simulation, self._goal_server,
                                 self, self._lookup.lookup, make_planner(settings, self._map.check),
                                 self._host.zones, encounters=self._host.encounters)
        robot, self._frames, self._ledger, self.navigator, self.condition = parts
        self._trace.motion(robot, self._clock.look_ns())
        self._trace.recorded(settings.durations, self._clock.look_ns())
        self.navigator.set_feedback_frequency(values['feedback_freq'])
        self._feedback_throttle = self._host.throttle(values['max_feedback_rate'])
        costmaps = CostmapTopics(self._names, settings, self._host, self._map)
        self._publisher = RobotPublisher(self._names, settings, self._host, robot, backend, costmaps)
        self._frames_told = backend.frames
        self._host.surroundings.add(robot, values['global_frame'], settings.costmaps.global_footprint)
        self._scans = self._make_scans(robot, backend)
        self._host.timing.claim_frames(self._names.robot, self._frames_told)
        condition_server = ConditionServer(self._names, settings, self._host, robot_index, self.condition)
        self.is_battery_heard = condition_server.is_battery_heard
        self._markers = robot_markers.add(self._clock, settings, self.navigator, self._state,
                                          self.condition.battery is not None)
        self._condition_server = condition_server
        if self._traffic is not None:
            self._traveller = self._traffic.join(self.navigator, settings.network, self._trace.note, self.warn)
        self.condition.begin(self._clock.simulation.now_ns)

    def _make_scans(self, robot, backend):
        if not self._settings.laser.rate:
            return None
        from .scan_publisher import ScanPublisher  # only who scans pays for numpy
        return ScanPublisher(self._names, self._settings, self._host, robot, backend, self._map)

    def shut_down(self):
        """End the active goal as a killed move_base does, and let the answer leave."""
        if self._work is not None:
            self._work.shut_down(NODE_KILLED)
        with self._clock.lock:
            self.navigator.close(NODE_KILLED, self._clock.now_ns())
        self._goal_server.flush()

    def close(self):
        """Take the robot out of the world: its goal ends, its topics and services go."""
        if self._work is not None:
            self._work.close(ROBOT_REMOVED)
        for part in (self._map, self._simple_goals, self._teleport, self._reconfigure, self._planner_interface,
                     self._condition_server):
            part.close()
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self.condition.close()
            self.navigator.close(ROBOT_REMOVED, now_ns)
            if self._traveller is not None:
                self._traveller.leave(now_ns)
            self._clock.simulation.queue.guard(self.navigator.robot.index, None)
            self._goal_server.flush()
            self._goal_server.close()
            self._publisher.close()
            self._host.surroundings.remove(self.navigator.robot)
            if self._scans is not None:
                self._scans.close()
            tf_watch.release(self._frames_told)
            self._markers.close()
            self._clock.leave_restarts(self._restart)
        self._host.remove_robot()

    def reset(self):
        """Be as at the start, but for the time: at the start pose, with the start's limits, without goals."""
        settings = self._settings
        if self._work is not None:
            self._work.shut_down(ROBOT_RESET)
        with self._clock.lock:
            now_ns = self._clock.now_ns()
            self.navigator.reset(ROBOT_RESET, now_ns)
            self._goal_server.flush()
            self._ledger.clear()
            self._goal_server.reset()
            self.condition.reset(now_ns)
            self.navigator.robot.set_motion(settings.limits, settings.tolerances)
            self.navigator.robot.reset(settings.start, now_ns)
            self._trace.motion(self.navigator.robot, now_ns)
            self.stands(self.navigator.robot, now_ns)

    def _restart(self, before_ns, now_ns):
        self._publisher.restart()
        if self._scans is not None:
            self._scans.restart(now_ns)
        self.condition.restart(now_ns - before_ns)
        self.navigator.restart(before_ns, now_ns)

    def set_motion(self, limits, tolerances):
        """Travel with other limits from the next leg on."""
        with self._clock.lock:
            self.navigator.robot.set_motion(limits, tolerances)
            self._trace.motion(self.navigator.robot, self._clock.look_ns())

    def reconfigure_goals(self, config):
        """Take over what dynamic_reconfigure says of move_base itself."""
        policy, behaviors = self._settings.recovery, self._settings.behaviors
        with self._clock.lock:
            self.navigator.set_recovery_policy(RecoveryPolicy(
                policy.fast, 0.0 if config['max_planning_retries'] >= 0 else config['planner_patience'],
                behaviors if config['recovery_behavior_enabled'] else ()))
            if config['controller_frequency'] != self._controller_frequency:
                self._controller_frequency = config['controller_frequency']
                self.navigator.set_feedback_frequency(config['controller_frequency'])
                self._host.rates.changed()
        self._planner_interface.set_add_unreachable_goal(config['make_plan_add_unreachable_goal'])

    def departed(self, robot, goal, now_ns):
        """Show that the robot starts."""
        corners = robot.leg.corners
        self._trace.departed(goal, now_ns, corners)
        self._publisher.departed(now_ns)
        if not self.navigator.feedback_frequency:
            self._clock.falls_silent(robot, self._goal_server, 'feedback_freq')
        self._planner_interface.show(robot.pose_at(now_ns), corners, goal, now_ns)
        self._moved(now_ns)
        if self._traveller is not None:  # last: it may hold the robot
            self._traveller.departed(robot.leg, now_ns)

    def stands(self, robot, now_ns):
        """Show that the robot stands."""
        try:
            self._trace.stands(robot.pose_at(now_ns), now_ns)
            self._publisher.stands(now_ns)
            self._markers.changed()
            self._moved(now_ns)
        finally:  # its places are its own, whatever goes wrong with showing it
            if self._traveller is not None:
                self._traveller.stands(now_ns)

    def beyond(self, recorded, found, now_ns):
        """Note that the robot's goal lies outside of what was recorded; the first one of the process is warned of."""
        self._trace.note('beyond', now_ns, *found)
        self._host.warn_of_beyond(self._names.robot, recorded.words(found))

    def abandons(self, now_ns):
        """Leave the queues in which the robot waits."""
        if self._traveller is not None:
            self._traveller.abandons(now_ns)

    def broken_off(self, now_ns):
        """Leave the robot no place that it is not in, and no queue with it."""
        if self._traveller is not None:
            self._traveller.put_in_order(now_ns)

    def held(self, reasons, now_ns):
        """Note for which reasons the robot is held, or that it is released."""
        self._trace.held(reasons, now_ns)
        self._tell_condition(now_ns)

    def failed(self, kind, cause, now_ns):
        """Note that the robot has failed."""
        self._trace.failed(kind, cause, now_ns)
        if self._work is not None:
            self._work.tasks.failed(now_ns)
        self._tell_condition(now_ns)

    def noted(self, kind, now_ns, *values):
        """Write a row of its own down."""
        self._trace.note(kind, now_ns, *values)

    def repaired(self, now_ns):
        """Note that it is as before."""
        self._trace.repaired(now_ns)
        self._tell_condition(now_ns)

    def battery(self, level, what, now_ns):
        """Note that the state of charge has passed a level."""
        self._trace.battery(level, what, now_ns)
        if what == EMPTY and self._work is not None:
            self._work.tasks.shut_down(BATTERY_EMPTY, now_ns)
        self._tell_battery(now_ns)

    def charging(self, charger, is_charging, now_ns):
        """Note that the robot is charged, or no more."""
        self._trace.charging(charger, is_charging, now_ns)
        self._tell_battery(now_ns)

    def _tell_battery(self, now_ns):
        if self._condition_server is not None:
            self._condition_server.battery_changed(now_ns)
            self._markers.changed()

    def _tell_condition(self, now_ns):
        if self._condition_server is not None:
            self._condition_server.changed(now_ns)
            self._markers.changed()

    def _state(self):
        return activity(self.navigator, self.condition, self._work and self._work.tasks)

    def _moved(self, now_ns):
        if self._work is not None:
            self._work.tasks.moved(now_ns)

    def target(self, goal, now_ns):
        """Show the goal that is worked on."""
        self._publisher.target(goal, now_ns)
        self._markers.changed()

    def stop_wheels(self):
        """Publish a zero velocity."""
        self._publisher.stop_wheels()

    def feedback(self, record, pose, stamp_ns, is_last=False):
        """Tell the goal's client where the robot is, as often as the cap in wall time allows, and at the goal."""
        if not self._goal_server.has_feedback_listeners():
            return self._clock.wall_to_ns(_DEAF_SECONDS)
        told = (record.goal_id, stamp_ns)
        if self._feedback_throttle.ready() or (is_last and told != self._told):
            rollback.changes(self, '_told')
            self._told = told
            self._goal_server.publish_feedback(
                record, self._in_global_frame.pose_stamped(0, pose, stamp_ns), stamp_ns)
        return self._clock.wall_to_ns(self._feedback_throttle.remaining())

    def recovery(self, pose, index, behaviors, stamp_ns):
        """Announce a recovery behaviour."""
        self._publisher.recovery(pose, index, behaviors, stamp_ns)

    def warn(self, text):
        """Log a warning; the same one once in 5 s."""
        if text != self._last_warning or self._warning_throttle.ready():
            self._last_warning = text
            rospy.logwarn('%s: %s', self._names.robot, text)

    def _map_changed(self):
        with self._clock.lock:
            if self.navigator.target is not None:
                self.navigator.map_changed(self._clock.now_ns())

    def _prefetch(self, goal):
        self._map.wait()
        self._prefetch_frame(goal.frame_id, goal.stamp_ns)

    def _prefetch_frame(self, frame_id, stamp_ns):
        """Give a foreign frame time to become known; this blocks only the topic that asks for it."""
        if self._frames.is_foreign(frame_id) and not frame_id.startswith('/'):
            self._lookup.wait_for(frame_id, stamp_ns)
