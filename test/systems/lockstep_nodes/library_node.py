"""Functions that the small nodes of the library's tests share: joining, playing a role, and random wall delays."""

import random
import sys
import time

import rospy

from move_base_abstract_ros import lockstep


def play(roles):
    """Run the node that argv[1] names, one of the functions in ``roles``.

    It takes part if there is an argv[2], the longest wall delay [s].
    """
    role, delay = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else None
    rospy.init_node(role)
    if role.startswith('outside'):
        roles[role]()
        return
    if delay is None:  # a stock node
        roles[role](lambda *_said: None)
        return
    if delay > 0.0:
        _lose_time(delay)
    participant = lockstep.join()
    print('joined', flush=True)
    roles[role](Said(participant, role))


class Said:
    """The participant, and its lines in the event log."""

    def __init__(self, participant, role):
        self.participant = participant
        self._role = role

    def __call__(self, kind, *values):
        """Write a line with the present time into the event log."""
        self.participant.log(self._role, kind, values)

    @property
    def now(self):
        """Simulated time [s]."""
        return self.participant.now_ns / 1e9


def _lose_time(longest):
    """Let sending, receiving, calling and connecting take random wall time, up to ``longest`` [s]."""
    chance = random.SystemRandom()

    def slow(function):
        def call(*args, **kwds):
            time.sleep(chance.uniform(0.0, longest))
            return function(*args, **kwds)
        return call
    rospy.Publisher.publish = slow(rospy.Publisher.publish)
    rospy.topics._SubscriberImpl.add_connection = slow(rospy.topics._SubscriberImpl.add_connection)
    rospy.topics._SubscriberImpl.receive_callback = slow(rospy.topics._SubscriberImpl.receive_callback)
    rospy.impl.tcpros_service.ServiceProxy.call = slow(rospy.impl.tcpros_service.ServiceProxy.call)
    rospy.impl.registration.RegManager.start = slow(rospy.impl.registration.RegManager.start)
