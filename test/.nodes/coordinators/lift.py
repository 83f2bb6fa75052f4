#!/usr/bin/env python3
"""Answers the questions in their order; each answer takes 0.87 s."""
import rospy
from std_msgs.msg import Int32MultiArray


def main():
    """Run until the node is shut down."""
    rospy.init_node('lift')
    answers = rospy.Publisher('answers', Int32MultiArray, queue_size=10)

    def on_question(question):
        rospy.sleep(0.87)
        answers.publish(question)
    rospy.Subscriber('questions', Int32MultiArray, on_question)
    rospy.spin()


if __name__ == '__main__':
    main()
