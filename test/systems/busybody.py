#!/usr/bin/env python3
"""Does all kinds of things to the robots of two fleets, in an order and at instants that follow from a seed."""
import random
import sys

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatusArray
from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseAction, MoveBaseActionFeedback, MoveBaseGoal
from std_srvs.srv import Empty, Trigger

from move_base_abstract.srv import AddRobot, RemoveRobot, SetPose

TOPICS = ['odom', 'amcl_pose', 'robot_pose', 'base_pose_ground_truth', 'move_base/local_costmap/footprint',
          'move_base/status', 'move_base/feedback']
# An action client needs the types of what it hears, so they are the same for all subscribers of this node.
TYPES = {'move_base/status': GoalStatusArray, 'move_base/feedback': MoveBaseActionFeedback}


class Busybody(object):
    def __init__(self, seed):
        self.chance = random.Random(seed)
        self.fleets = {'robot_%d' % number: '/fleet_%d' % (number // 2) for number in range(4)}
        self.clients = {}
        self.heard = {}

    def any_robot(self):
        return self.chance.choice(list(self.fleets))

    def any_place(self):
        place = PoseStamped()
        place.header.frame_id, place.pose.orientation.w = 'map', 1.0
        place.pose.position.x, place.pose.position.y = self.chance.uniform(-5, 5), self.chance.uniform(-5, 5)
        return place

    def client(self, robot):
        if robot not in self.clients:
            self.clients[robot] = actionlib.SimpleActionClient('/%s/move_base' % robot, MoveBaseAction)
            self.clients[robot].wait_for_server()
        return self.clients[robot]

    def call(self, name, kind, *request):
        try:
            rospy.ServiceProxy(name, kind)(*request)
        except rospy.ServiceException as error:
            print(error)  # the radio has lost it

    def configure(self, robot, server, name, values):
        self.call('/%s/move_base%s/set_parameters' % (robot, server), Reconfigure,
                  Config(doubles=[DoubleParameter(name, self.chance.choice(values))]))

    def send(self):
        robot = self.any_robot()
        self.client(robot).send_goal(MoveBaseGoal(self.any_place()),
                                     feedback_cb=self.chance.choice([None, lambda feedback: None]))
        return robot

    def cancel(self):
        self.client(self.any_robot()).cancel_all_goals()

    def hear(self, topic, kind=rospy.AnyMsg):
        if topic in self.heard:
            self.heard.pop(topic).unregister()
        else:
            self.heard[topic] = rospy.Subscriber(topic, kind, lambda message: None)

    def hear_robot(self):
        topic = self.chance.choice(TOPICS)
        self.hear('/%s/%s' % (self.any_robot(), topic), TYPES.get(topic, rospy.AnyMsg))

    def hear_all(self):
        self.hear(self.chance.choice(['/tf', '/fleet_0/events']))

    def put(self):
        self.call('/%s/set_robot_pose' % self.any_robot(), SetPose, self.any_place())

    def tell_again(self):
        self.call('/%s/request_nomotion_update' % self.any_robot(), Empty)

    def set_rate(self):
        robot = self.send()
        rospy.sleep(0.317)
        self.configure(robot, '', 'controller_frequency', [3.0, 7.0, 40.0])

    def set_speed(self):
        self.configure(self.any_robot(), '/TrajectoryPlannerROS', 'max_vel_x', [0.5, 2.0])

    def add(self):
        robot = 'robot_%d' % len(self.fleets)
        self.fleets[robot] = '/fleet_1'
        self.call('/fleet_1/add_robot', AddRobot, robot, 1.0, 2.0, 0.5, '')

    def remove(self):
        robot, fleet = self.fleets.popitem()
        self.clients.pop(robot, None)
        self.call(fleet + '/remove_robot', RemoveRobot, robot)

    def reset(self):
        self.call('/fleet_0/reset', Trigger)

    def begin(self):
        """Come within a period at which nothing is told, and at the instant of a beat that tells nothing."""
        self.hear('/robot_0/odom')
        rospy.sleep(0.15)
        self.add()
        rospy.sleep(0.02)
        self.hear('/robot_4/odom')
        rospy.sleep(0.33)
        self.hear('/tf')
        rospy.sleep(0.1)
        self.hear('/tf')

    def work(self):
        self.begin()
        deeds = [self.put, self.tell_again, self.set_rate, self.set_rate, self.set_speed, self.add, self.remove,
                 self.reset, self.cancel, self.cancel] + 5 * [self.send] + 4 * [self.hear_all] + 10 * [self.hear_robot]
        self.chance.shuffle(deeds)
        for deed in deeds:
            pause = self.chance.choice([0.05 * self.chance.randrange(12), self.chance.uniform(0.0, 0.7)])
            rospy.sleep(pause)
            print('%.9f %s' % (rospy.get_time(), deed.__name__))
            deed()
        for client in self.clients.values():
            client.cancel_all_goals()
        rospy.sleep(0.5)


if __name__ == '__main__':
    rospy.init_node('busybody')
    try:
        Busybody(sys.argv[1]).work()
    except rospy.ROSInterruptException:
        pass  # the run may end first
