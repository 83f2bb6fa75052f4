"""The robots of a process as one MarkerArray, drawn only while a node subscribes to it.

A change of a robot is drawn within 50 ms of wall time, and robots under way are drawn five times a second. All that is
drawn at one instant is one message.
"""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Sequence, Set, Tuple

import rospy
from visualization_msgs.msg import MarkerArray

from move_base_abstract.goals.events import Aimed, ChargePassed, Charging, Failed, Held, Repaired, Stands
from move_base_abstract.goals.task_events import TaskBegan, TaskEnded, TaskWaits
from move_base_abstract.motion.geometry import Pose2D

from .. import lockstep
from . import marker_builder
from .marker_builder import Look, View

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.engine.stream import Stream
    from move_base_abstract.goals.navigator import Navigator

    from ..clocks.timing import Clock

TOPIC = 'move_base_abstract/markers'  # the default of the parameter marker_topic
_CHANGE_SECONDS = 0.05  # wall; the shortest time between two messages
_REFRESH_SECONDS = 0.2  # wall; the period at which robots with a goal are drawn

#: the events after which a robot looks different
_CHANGES = (Stands, Aimed, Held, Failed, Repaired, ChargePassed, Charging, TaskWaits, TaskBegan, TaskEnded)
_lock = threading.Lock()
_boards: Dict[str, _Board] = {}


def add(clock: Clock, settings: RobotSettings, navigator: Navigator, stream: Stream,
        state: Callable[[], str], is_changing: bool = False) -> RobotMarkers:
    """Draw the robot of ``navigator`` from now on, again at each event of ``stream``; return its :class:`RobotMarkers`.

    ``state()`` returns a line of text about what the robot does; it is called with the clock's lock held.
    ``is_changing`` says that this text may also change while the robot stands.
    """
    robot = navigator.robot
    look = Look(robot.name, marker_builder.robot_number(robot.name, robot.index), settings.values['global_frame'],
                settings.values['marker_size'])
    markers = RobotMarkers(board(clock, settings.values['marker_topic']), look, navigator, state, is_changing)
    stream.subscribe('markers', dict.fromkeys(_CHANGES, markers.changed))
    return markers


def board(clock: Clock, topic: str) -> _Board:
    """Return this process's board on a topic. There is one for each topic."""
    topic = '/' + topic.strip('/')
    with _lock:
        if topic not in _boards:
            _boards[topic] = _Board(clock, topic)
        return _boards[topic]


class RobotMarkers:
    """One robot on the board of its process."""

    def __init__(self, board: _Board, look: Look, navigator: Navigator, state: Callable[[], str],
                 is_changing: bool) -> None:
        self.look = look
        self._state = state
        self._is_changing = is_changing
        self._drawn_route = None
        self._board = board
        self._navigator = navigator
        board.add(self)

    def changed(self, _event: Any) -> None:
        """Ask the board to draw the robot soon. This returns at once."""
        self._board.change(self)

    def close(self) -> None:
        """Ask the board to delete the robot's markers."""
        self._board.remove(self)

    def draw(self, view: View) -> List[Any]:
        """Return the markers that show ``view``; a route that has not changed since the last call is left out."""
        markers = marker_builder.body(self.look, view)
        if self._drawn_route != view.route:
            self._drawn_route = view.route
            markers += marker_builder.route(self.look, view)
        return markers

    def forget_drawn(self) -> None:
        """Draw everything next time, since a new subscriber has seen nothing yet."""
        self._drawn_route = None

    def view(self, now_ns: int) -> View:
        """Return the :class:`View` of the robot at ``now_ns`` [ns]. The caller must hold the clock's lock."""
        robot, leg = self._navigator.robot, self._navigator.robot.leg
        target = self._navigator.travel.target  # a robot under velocities has no goal, and no way that is known
        way = (leg.start, *(Pose2D(x, y) for x, y in leg.corners), leg.end) if leg and target else None
        return View(robot.pose_at(now_ns), target, way, self._state(), self._is_changing)


class _Board(rospy.SubscribeListener):
    """One publisher and one thread. The thread never waits for the clock's lock while it holds the condition.

    What is on it (RobotMarkers, parts of the world) has ``look``, ``view(now_ns)``, ``draw(view)``, ``forget_drawn()``.
    """

    def __init__(self, clock: Clock, topic: str) -> None:
        super().__init__()
        self._clock = clock
        self._condition = threading.Condition()
        self._robots: Dict[str, Any] = {}  # {name of its look: what is drawn}
        self._changed: Set[Any] = set()
        self._under_way: Set[Any] = set()
        self._removed: List[RobotMarkers] = []
        participant = lockstep.participant()
        if participant is not None:  # the markers are drawn by the wall clock
            participant.exclude(topic)
        self._publisher = rospy.Publisher(topic, MarkerArray, subscriber_listener=self, queue_size=10)
        threading.Thread(target=self._run, name='markers', daemon=True).start()

    def add(self, robot: Any) -> None:
        """Draw ``robot`` from now on."""
        with self._condition:
            self._robots[robot.look.name] = robot
        self.change(robot)

    def is_watched(self) -> bool:
        """Return whether any node subscribes."""
        return bool(self._publisher.impl.connections)  # not get_num_connections: this is asked at each event

    def change(self, robot: Any) -> None:
        """Draw ``robot`` soon, if there is a subscriber."""
        if self.is_watched():
            with self._condition:
                self._changed.add(robot)
                self._condition.notify()

    def remove(self, robot: RobotMarkers) -> None:
        """Stop drawing ``robot``, and delete its markers."""
        with self._condition:
            self._robots.pop(robot.look.name, None)
            self._changed.discard(robot)
            self._under_way.discard(robot)
            self._removed.append(robot)
            self._condition.notify()

    def peer_subscribe(self, _topic_name: str, _topic_publish: Callable[[Any], object],
                       _peer_publish: Callable[[Any], object]) -> None:
        """Draw everything for a new subscriber."""
        with self._condition:
            for robot in self._robots.values():
                robot.forget_drawn()
                self._changed.add(robot)
            self._condition.notify()

    def _run(self) -> None:
        while not rospy.is_shutdown():
            chosen, removed = self._wait()
            if self._publisher.get_num_connections() == 0:
                continue
            markers = [marker for robot in removed for marker in marker_builder.farewell(robot.look)]
            for robot, view in self._views(chosen):
                markers += self._draw(robot, view)
            try:
                self._publisher.publish(MarkerArray(markers))
            except rospy.ROSException:
                return  # the node is going down
            time.sleep(_CHANGE_SECONDS)

    def _wait(self) -> Tuple[List[Any], List[RobotMarkers]]:
        """Wait until there is something to do, and return (robots to draw, robots to delete)."""
        with self._condition:
            watched = self._publisher.get_num_connections() > 0
            self._condition.wait_for(lambda: self._changed or self._removed,
                                     _REFRESH_SECONDS if watched and self._under_way else None)
            chosen, removed = self._changed | self._under_way, self._removed
            self._changed, self._under_way, self._removed = set(), set(), []
        return sorted(chosen, key=lambda robot: robot.look.name), removed

    def _views(self, robots: Sequence[Any]) -> List[Tuple[Any, Any]]:
        with self._clock.lock:
            now_ns = self._clock.look_ns()
            return [(robot, robot.view(now_ns)) for robot in robots]

    def _draw(self, robot: Any, view: Any) -> List[Any]:
        markers = robot.draw(view)
        with self._condition:
            if (view.goal or view.is_changing) and self._robots.get(robot.look.name) is robot:
                self._under_way.add(robot)
        return markers
