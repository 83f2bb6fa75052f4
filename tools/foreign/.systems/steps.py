#!/usr/bin/env python3
"""A node that does what its parameter ~steps says: it publishes messages, and calls services, each at its instant.

A step is {at: S, topic: NAME, type: PACKAGE/TYPE, fields: {...}}, or has `service` in the place of `topic`. With
`every` [s] and `times` it is done again. `at` [s, simulated] counts from the node's start; a step that is late is done
at once. Topics are advertised at the start, and latched unless `latch` is false. ~hears, [[topic, type], ...], are
topics that it subscribes to, so that the run's events have what is published on them.
"""
import genpy
import roslib.message
import rospy
import rosservice


def main():
    """Do the steps, then wait for the end of the run."""
    rospy.init_node('steps')
    for topic, name in rospy.get_param('~hears', []):
        rospy.Subscriber(topic, roslib.message.get_message_class(name), lambda message: None)
    steps = rospy.get_param('~steps', [])
    start = rospy.Time.now()
    topics = {}
    for step in steps:
        if 'topic' in step:
            kind = roslib.message.get_message_class(step['type'])
            topics[step['topic']] = (kind, rospy.Publisher(step['topic'], kind, queue_size=10,
                                                           latch=step.get('latch', True)))
    turns = [(step['at'] + turn * step.get('every', 0.0), number, step) for number, step in enumerate(steps)
             for turn in range(step.get('times', 1))]
    for at, _number, step in sorted(turns, key=lambda turn: turn[:2]):
        rospy.sleep(start + rospy.Duration(at) - rospy.Time.now())
        if 'topic' in step:
            kind, publisher = topics[step['topic']]
            publisher.publish(_filled(kind(), step))
        else:
            _call(step)
    rospy.spin()


def _call(step):
    rospy.wait_for_service(step['service'])
    kind = rosservice.get_service_class_by_name(step['service'])
    rospy.loginfo('%s: %s', step['service'], rospy.ServiceProxy(step['service'], kind).call(
        _filled(kind._request_class(), step)))


def _filled(message, step):
    genpy.message.fill_message_args(message, [step.get('fields', {})], {'now': rospy.Time.now()})
    return message


if __name__ == '__main__':
    main()
