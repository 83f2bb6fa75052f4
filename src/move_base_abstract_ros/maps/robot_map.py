"""The map of one robot, between the process's map listener and the core."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, List, Sequence, Tuple

import rosgraph.names
import rospy

from move_base_abstract.maps.map_check import MapCheck

if TYPE_CHECKING:
    from move_base_abstract.config.settings import RobotSettings
    from move_base_abstract.maps.occupancy import OccupancyMap

    from ..clocks.timing import Clock
    from ..lockstep.participation.taking_part import Participant
    from ..robot.names import RobotNames
    from .map_listener import MapListener


#: enough to hear of a participant that publishes a map from its first round on
_ROUNDS = 2


def wait_for_maps(robots: Sequence[Tuple[RobotNames, RobotSettings]], participant: Participant) -> bool:
    """Wait for the first map of each of ``robots`` [(RobotNames, RobotSettings)]; False if ROS shuts down meanwhile.

    In lockstep call this in the first round. A participant's map comes in a round, and is waited for in simulated time.
    One of an onlooker is waited for while time stands still: if it came at some later wall time, each run would be
    different. (Not before the first round, since such a map_server waits for the first message on /clock.)
    """
    topics = sorted({_topic(names, settings) for names, settings in robots if settings.values['use_map']})
    for topic in topics:
        participant.constant(topic)
    if not topics:
        return True
    from .map_listener import MapListener
    listeners = [MapListener.on(topic) for topic in topics]
    _let_subscriptions_begin(participant)
    return all(_wait_for(listener, participant) for listener in listeners)


def _wait_for(listener: MapListener, participant: Participant) -> bool:
    if not participant.topics.is_of_participants(listener.topic):
        return listener.wait()
    return participant.wait_until(lambda: listener.has_come, what='a map on ' + listener.topic)


def _let_subscriptions_begin(participant: Participant) -> None:
    window = participant.rounds.window
    with participant.rounds.still_starting():
        if window.is_open:
            participant.wait_until(lambda: False, window.lookahead_ns * 1e-9, 'its subscriptions')
            return
        for _ in range(_ROUNDS):
            participant.scheduler.wait_round()


def _topic(names: RobotNames, settings: RobotSettings) -> str:
    """Return the absolute name of the map's topic: ``map_topic``, or the remapping of ``map``, or ``/map``."""
    given = settings.values['map_topic']
    if given is not None:
        return rospy.resolve_name(given, names.private)
    for caller in (names.private, rospy.get_name()):
        resolved = rospy.resolve_name('map', caller)
        if resolved != rosgraph.names.namespace(caller) + 'map':
            return resolved
    return rospy.resolve_name('/map')


class RobotMap:
    """The map of one robot. ``check`` (MapCheck) judges its goals; it is None if the robot uses no map."""

    def __init__(self, names: RobotNames, settings: RobotSettings, clock: Clock) -> None:
        values = settings.values
        self.check: Any = None
        self._followers: List[Callable[[Any, OccupancyMap], object]] = []
        self._changed = lambda: None
        self._clock = clock
        self._has_come = False
        if not values['use_map']:
            return
        self._global_frame = values['global_frame']
        self._timeout = values['frame_timeout']
        # Imported only if a map is used, since numpy takes some 0.1 s and 15 MB in each process.
        from .map_listener import MapListener
        self._listener = MapListener.on(_topic(names, settings))
        self.check = MapCheck(None, values['allow_unknown'], values['allow_occupied_goals'],
                              "No map has come on '{}' yet (~use_map is true). Is a map server running?".format(
                                  self._listener.topic))
        self.follow(self._take)

    def follow(self, follower: Callable[[Any, OccupancyMap], object]) -> None:
        """Call ``follower(message, occupancy)`` with the latest map and with each new one, until :meth:`close`."""
        if self.check is not None:
            self._followers.append(follower)
            self._listener.follow(follower)

    def follow_changes(self, changed: Callable[[], None]) -> None:
        """Call ``changed()`` whenever goals are judged by another map than before."""
        self._changed = changed

    def wait(self) -> None:
        """Wait for the first map, up to frame_timeout [s, of the clock]. May block, so do not hold a lock."""
        if self.check is not None:
            self._clock.wait_until(lambda: self._has_come, self._timeout, 'a map')

    def give(self, message: Any) -> str:
        """Use the nav_msgs/OccupancyGrid ``message`` from now on, until another map comes on the topic.

        Return '', or the reason why it cannot be used. If the robot uses no map, do nothing and return ''.
        """
        if self.check is not None:
            from .map_listener import occupancy_in
            if message.header.frame_id.lstrip('/') != self._global_frame:
                return "the map is given in the frame '{}', the robot's global frame is '{}'".format(
                    message.header.frame_id, self._global_frame)
            try:
                occupancy = occupancy_in(message)
            except ValueError as error:
                return 'the map: {}'.format(error)
            for follower in self._followers:
                follower(message, occupancy)
        return ''

    def close(self) -> None:
        """Stop following the map."""
        for follower in self._followers:
            self._listener.leave(follower)
        self._followers = []

    def _take(self, message: Any, occupancy: OccupancyMap) -> None:
        frame_id = message.header.frame_id.lstrip('/')
        if frame_id == self._global_frame:
            self.check.use(occupancy)
        else:
            self.check.use_none("The map on '{}' cannot be used: it is given in the frame '{}', the robot's global "
                                "frame is '{}'".format(self._listener.topic, frame_id, self._global_frame))
        self._has_come = True
        self._changed()
