#!/usr/bin/env python3
"""Roles with services."""

import sys

import rospy
from library_node import play
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse


def server(say):
    def slow(request):
        say('begins', request.data)
        rospy.sleep(2.0 if request.data else 0.5)
        say('ends', request.data)
        return SetBoolResponse(True, 'slept')

    def fails(_request):
        raise KeyError('no such key')

    def refuses(_request):
        raise rospy.ServiceException('not now')
    rospy.Service('slow', SetBool, slow)
    rospy.Service('fails', Trigger, fails)
    rospy.Service('refuses', Trigger, refuses)
    rospy.Service('nothing', Trigger, lambda request: None)
    rospy.Service('wrong', Trigger, lambda request: 'text')
    rospy.sleep(20)


def caller(say):
    rospy.wait_for_service('slow')
    say('found')
    proxy = rospy.ServiceProxy('slow', SetBool)
    say('answer', proxy(True).message)
    say('answer', proxy(data=False).message)
    persistent = rospy.ServiceProxy('slow', SetBool, persistent=True)
    say('answer', persistent(False).message)
    say('answer', persistent(False).message)
    persistent.close()
    _errors(say)


def other_caller(say):
    rospy.wait_for_service('slow')
    say('answer', rospy.ServiceProxy('slow', SetBool)(False).message)


def _errors(say):
    for name in ('fails', 'refuses', 'nothing', 'wrong', 'unknown'):
        try:
            say('no error', str(rospy.ServiceProxy(name, Trigger)()))
        except Exception as error:
            say('error', name, type(error).__name__, str(error))
    try:
        rospy.ServiceProxy('slow', SetBool)('text')
    except Exception as error:
        say('error', 'request', type(error).__name__, str(error))


def outside_errors():
    """Print the same errors as stock rospy makes them."""
    rospy.wait_for_service('wrong')
    _errors(lambda *words: print('STOCK', *words, sep='|', flush=True))


def late_server(say):
    rospy.sleep(3)
    rospy.Service('late', Trigger, lambda request: TriggerResponse(True, 'here'))
    say('serves')
    rospy.sleep(5)


def waiter(say):
    try:
        rospy.wait_for_service('late', timeout=1.5)
    except rospy.ROSException as error:
        say('error', str(error))
    rospy.wait_for_service('late', timeout=10)
    say('answer', rospy.ServiceProxy('late', Trigger)().message)
    rospy.sleep(6)
    try:
        rospy.wait_for_service('late', timeout=1.0)
        say('still there')
    except rospy.ROSException:
        say('gone')


def node_a(say):
    """Offer /a and call /b, which calls /a, while a timer goes on."""
    rospy.Service('a', Trigger, lambda request: (rospy.sleep(0.25), TriggerResponse(True, 'a'))[1])
    rospy.Timer(rospy.Duration(0.5), lambda event: say('tick'))
    rospy.wait_for_service('b')
    say('answer', rospy.ServiceProxy('b', Trigger)().message)
    rospy.sleep(1)


def node_b(_say):
    def serve(_request):
        rospy.sleep(0.5)
        return TriggerResponse(True, 'b of ' + rospy.ServiceProxy('a', Trigger)().message)
    rospy.Service('b', Trigger, serve)
    rospy.sleep(4)


def leaver(say):
    def serve(_request):
        say('leaves')
        rospy.Timer(rospy.Duration(1), lambda event: rospy.signal_shutdown('it leaves'), oneshot=True)
        rospy.sleep(100)
        return TriggerResponse()
    rospy.Service('leaves', Trigger, serve)
    rospy.spin()


def left_behind(say):
    rospy.wait_for_service('leaves')
    try:
        rospy.ServiceProxy('leaves', Trigger)()
    except rospy.ServiceException as error:
        say('error', str(error))
    rospy.sleep(1)
    say('goes on')


def timer_caller(say):
    """Call in the callback of a timer and from the main thread at the same instant."""
    rospy.wait_for_service('slow')
    proxy = rospy.ServiceProxy('slow', SetBool)
    rospy.Timer(rospy.Duration(1), lambda event: say('timer', proxy(False).message), oneshot=True)
    rospy.sleep(1)
    say('main', proxy(True).message)


def asked_from_outside(say):
    rospy.Service('ask', Trigger, lambda request: (say('asked'), rospy.sleep(1.0), TriggerResponse(True, 'yes'))[2])
    rospy.sleep(0.5)
    asked = rospy.wait_for_service('outside_done')
    say('over', asked is None)


def outside_caller():
    rospy.wait_for_service('ask')
    print('OUTSIDE', rospy.ServiceProxy('ask', Trigger)().message, flush=True)
    rospy.Service('outside_done', Trigger, lambda request: TriggerResponse())
    sys.stdout.flush()
    rospy.spin()


if __name__ == '__main__':
    play(globals())
