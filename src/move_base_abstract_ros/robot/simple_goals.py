"""Goals from RViz: pass those on ``move_base_simple/goal`` to the action's own goal topic, as move_base does."""
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseActionGoal

from ..messages import conversions
from ..replacing.single_connections import keep_apart

_CONNECT_SECONDS = 5.0  # for the clock's wait_until: wall time, or simulated time in lockstep


class SimpleGoals:
    """Listens for poses and sends them as goals without an id, as any client could.

    The publisher on the goal topic is there from the start, before the node itself listens to that topic. It is
    connected to this node as to any other, unless ``take`` is given: a connection of a node to itself costs two threads
    and two sockets for each robot. With ``take``, ``take(id, stamp_ns, GoalPose)`` gets the goal, and only other nodes
    get it by the topic.
    """

    def __init__(self, names, clock, take=None):
        self._names = names
        self._clock = clock
        self._take = take
        self._subscriber = None
        self._goals = rospy.Publisher(names.action('goal'), MoveBaseActionGoal, queue_size=1)

    def listen(self):
        """Begin to listen. The node must listen to the goal topic by now."""
        if self._take is not None:
            keep_apart(self._names.action('goal'))
        self._subscriber = rospy.Subscriber(self._names.topic('move_base_simple/goal'), PoseStamped, self._on_pose,
                                            queue_size=1)

    def close(self):
        """Unregister both topics."""
        self._subscriber.unregister()
        self._goals.unregister()

    def _on_pose(self, pose):
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
