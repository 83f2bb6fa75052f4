#!/usr/bin/python3
"""A participant that sends goals to robots and writes what it hears into the event log. usage: PLAN ROBOT..."""
import math
import random
import sys

import rospy
from actionlib_msgs.msg import GoalID
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionGoal, MoveBaseActionResult
from tf2_msgs.msg import TFMessage

from move_base_abstract.srv import AddRobot, RemoveRobot
from move_base_abstract_ros import lockstep

NS_PER_S = 1_000_000_000


#: goals in the farm yard: around buildings, and one in a building
YARD = {'robot_0': [(10.0, 20.0), (30.0, 36.0, 1.0)], 'robot_1': [(50.0, 36.0), (10.0, 4.0)],
        'robot_2': [(10.0, 12.0), (20.0, 36.0, 2.0)]}


def plan_of(names, seed=5, goals=4):
    """Return {robot: [(x, y, yaw)]} on a grid, so that many robots arrive together and some have nowhere to go."""
    rng = random.Random(seed)
    return {name: [(float(rng.randint(-2, 2)) * 4.0, 0.0, 0.0) for _ in range(goals)] for name in names}


class Robot:
    """The topics of one robot's action."""

    def __init__(self, name, on_end=lambda name, result: None):
        prefix = '/{}/move_base/'.format(name)
        self._name = name
        self.count = 0
        self._goal = rospy.Publisher(prefix + 'goal', MoveBaseActionGoal, queue_size=100)
        self._cancel = rospy.Publisher(prefix + 'cancel', GoalID, queue_size=100)
        self._subscriber = rospy.Subscriber(prefix + 'result', MoveBaseActionResult,
                                            lambda result: on_end(name, result), queue_size=100)

    def send(self, x, y=0.0, yaw=0.0, frame='map', ahead=None):
        """Send a goal (m, m, rad), whose id is the name of the robot and a number, stamped ``ahead`` [s] of now."""
        self.count += 1
        goal = MoveBaseActionGoal(goal_id=GoalID(id='{}-{}'.format(self._name, self.count)))
        target = goal.goal.target_pose
        target.header.frame_id = frame
        if ahead is not None:
            target.header.stamp = rospy.Time.now() + rospy.Duration(ahead)
        target.pose.position.x, target.pose.position.y = x, y
        target.pose.orientation.z, target.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self._goal.publish(goal)

    def cancel(self):
        """Cancel all goals of the robot."""
        self._cancel.publish(GoalID())


class Client:
    """Runs one of the plans below, and ends at the end of the plan."""

    def __init__(self, names):
        self.names = names
        self.participant = lockstep.join()
        self.ended = []
        self.robots = {name: Robot(name, self._on_end) for name in names}
        self.goals = {name: [] for name in names}

    def sleep_until(self, seconds):
        """Sleep until an instant of simulated time [s]."""
        rospy.sleep(rospy.Time.from_sec(seconds) - rospy.Time.now())

    def wait_for_ends(self, count):
        """Wait until there are ``count`` results in all."""
        self.participant.wait_until(lambda: len(self.ended) >= count, what='results')

    def log(self, kind, *values):
        """Write a line of the client into the event log."""
        self.participant.log('client', kind, values)

    def _on_end(self, name, result):
        self.ended.append((name, result))
        if self.goals[name]:
            self.robots[name].send(*self.goals[name].pop(0))

    def run_goals(self):
        """Drive all robots at once; the next goal follows at the instant of a result; cancel one goal, replace one."""
        self.goals = plan_of(self.names)
        total = sum(len(goals) for goals in self.goals.values())
        self.sleep_until(2.0)
        for name in self.names:
            self.robots[name].send(*self.goals[name].pop(0))
        self.sleep_until(3.0)
        self.robots[self.names[0]].cancel()
        self.robots[self.names[1]].send(30.0)
        self.wait_for_ends(total + 1)

    def run_backwards(self):
        """Send goals to where the robots stand, the last robot first; log the order of the results."""
        self.sleep_until(2.0)
        for number, name in reversed(list(enumerate(self.names))):
            self.robots[name].send(0.0, 2.0 * number)
        self.wait_for_ends(len(self.names))
        self.log('results', *(name for name, _ in self.ended))

    def run_telling(self):
        """Listen to feedback and poses during one leg."""
        rospy.Subscriber('/robot_0/move_base/feedback', MoveBaseActionFeedback, lambda message: self.log(
            'feedback', message.feedback.base_position.pose.position.x))
        rospy.Subscriber('/robot_0/robot_pose', PoseStamped, lambda message: self.log(
            'pose', message.pose.position.x))
        self.sleep_until(2.0)
        self.robots['robot_0'].send(2.0)
        self.wait_for_ends(1)

    def run_tf(self):
        """Listen to tf while all robots stand, and while two move."""
        self.sleep_until(100.0)
        rospy.Subscriber('/tf', TFMessage, lambda message: self.log('tf', *(
            (transform.child_frame_id, transform.transform.translation.x, transform.header.stamp.to_nsec())
            for transform in message.transforms)))
        self.sleep_until(101.0)
        self.robots['robot_0'].send(2.0)
        self.robots['robot_1'].send(2.0, 2.0)
        self.wait_for_ends(2)

    def run_frames(self):
        """Send goals in a frame that an onlooker has published, in an unknown frame, and as RViz does."""
        self.sleep_until(2.0)
        self.robots['robot_0'].send(1.0, frame='dock')
        self.wait_for_ends(1)
        self.robots['robot_0'].send(1.0, frame='moon')
        self.wait_for_ends(2)
        publisher = rospy.Publisher('/robot_0/move_base_simple/goal', PoseStamped, queue_size=1)
        self.sleep_until(20.0)
        goal = PoseStamped()
        goal.header.frame_id = 'map'
        goal.pose.orientation.w = 1.0
        publisher.publish(goal)
        self.wait_for_ends(3)

    def run_ahead(self):
        """Send goals in another robot's frame of instants that are yet to come, and in a fixed frame of one far off."""
        self.sleep_until(2.0)
        for number, (frame, ahead) in enumerate((('robot_1/base_link', 0.0), ('robot_1/base_link', 0.02),
                                                 ('robot_1/base_link', 0.3), ('dock', 1000.0)), 1):
            self.robots['robot_0'].send(float(number), frame=frame, ahead=ahead)
            self.wait_for_ends(number)

    def run_wall(self):
        """Send a goal with a stamp of the machine's clock, and one without."""
        self.sleep_until(2.0)
        self.robots['robot_0'].send(1.0, frame='robot_0/base_link', ahead=rospy.get_param('/stamp'))
        self.wait_for_ends(1)
        self.robots['robot_0'].send(1.0)
        self.wait_for_ends(2)

    def run_map(self):
        """Send a goal in a wall, and a free goal."""
        self.sleep_until(2.0)
        self.goals['robot_0'] = [(1.25, 0.25)]
        self.robots['robot_0'].send(2.25, 0.25)
        self.wait_for_ends(2)

    def run_yard(self):
        """Drive around the buildings of the yard; cancel one robot on its way."""
        self.goals = {name: list(goals) for name, goals in YARD.items()}
        self.sleep_until(2.0)
        for name in self.names:
            self.robots[name].send(*self.goals[name].pop(0))
        self.sleep_until(9.0)
        self.robots[self.names[1]].cancel()
        self.wait_for_ends(sum(map(len, YARD.values())))

    def run_services(self):
        """Add a robot, send it a goal, and remove it on its way."""
        add = rospy.ServiceProxy('/fleet/add_robot', AddRobot)
        rospy.wait_for_service('/fleet/add_robot')
        self.sleep_until(2.0)
        answer = add('late', 0.0, 8.0, 0.0, 'max_speed: 4.0')
        self.log('added', answer.success, answer.message)
        self.goals['late'] = [(100.0, 8.0)]
        self.robots['late'] = Robot('late', self._on_end)
        self.sleep_until(3.0)
        self.robots['late'].send(4.0, 8.0)
        self.sleep_until(5.0)
        answer = rospy.ServiceProxy('/fleet/remove_robot', RemoveRobot)('late')
        self.log('removed', answer.success)
        self.wait_for_ends(2)


def main():
    """Run the plan that the first argument names."""
    plan, names = rospy.myargv()[1], rospy.myargv()[2:]
    rospy.init_node('client')
    client = Client(names)
    getattr(client, 'run_' + plan)()
    client.participant.leave('its plan is through')
    sys.exit(0)


if __name__ == '__main__':
    main()
