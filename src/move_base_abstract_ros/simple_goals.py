"""Goals from RViz: ``move_base_simple/goal`` is passed on to the action's own goal topic, as move_base does."""
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseActionGoal

from . import conversions

_CONNECT_SECONDS = 5.0  # of the clock's wait_until


class SimpleGoals:
    """Listens for poses and sends them as any client would, without an id.

    Publishing on a topic that the node itself listens to costs two threads and a connection per robot, so that the
    publisher is made when the first pose comes, unless ``at_once``.
    """

    def __init__(self, names, clock, at_once):
        self._names = names
        self._clock = clock
        self._goals = None
        if at_once:
            self._advertise()
        self._subscriber = rospy.Subscriber(names.topic('move_base_simple/goal'), PoseStamped, self._on_pose,
                                            queue_size=1)

    def close(self):
        """Leave the graph."""
        self._subscriber.unregister()
        if self._goals is not None:
            self._goals.unregister()

    def _advertise(self):
        self._goals = rospy.Publisher(self._names.action('goal'), MoveBaseActionGoal, queue_size=1)

    def _on_pose(self, pose):
        if self._goals is None:
            self._advertise()
        # In lockstep this node is connected to itself within the present instant, or the goal topic is gone.
        self._clock.wait_until(lambda: self._goals.get_num_connections() > 0, _CONNECT_SECONDS, 'its own goal topic')
        goal = MoveBaseActionGoal()
        with self._clock.lock:
            goal.header.stamp = conversions.to_time(self._clock.now_ns())
        goal.goal.target_pose = pose
        self._goals.publish(goal)
