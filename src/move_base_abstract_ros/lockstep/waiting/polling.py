"""Loops that wait by looking, without sleeping: ``while not rospy.is_shutdown(): if flag: ...``.

What they look at are functions of rospy and actionlib. After so many looks in a row the thread gives its turn away
(:meth:`Scheduler.look`), so that what it looks for can happen. All is counted, nothing is timed: a run with such loops
is as repeatable as any.
"""
import sys
from functools import lru_cache

import rospy
import rospy.client
import rospy.rostime
import rospy.topics

from move_base_abstract.lockstep.loops import STEP_NS, TIME_STEP_NS
from move_base_abstract.lockstep.scheduler import TurnLost

from .waits import replace_within

#: for so many looks counts one at a parameter that has been looked at since the thread has waited
AGAIN = 250
_ROS = ('rospy.', 'actionlib.', 'tf2_ros.')


def install(participant):
    """Count the looks of the application's threads."""
    scheduler = participant.scheduler
    for function in (rospy.core.is_shutdown, rospy.topics.Topic.get_num_connections):
        _count(function, scheduler, STEP_NS)
    for function in (rospy.client.get_param, rospy.client.has_param):
        _count(function, scheduler, STEP_NS, _Parameters(scheduler).weight_of)
    _count(rospy.rostime.get_rostime, scheduler, TIME_STEP_NS)
    try:
        from actionlib import action_client, simple_action_client
    except ImportError:
        return  # then nobody here uses it
    for function in (simple_action_client.SimpleActionClient.get_state,
                     action_client.ClientGoalHandle.get_comm_state, action_client.ClientGoalHandle.get_goal_status):
        _count(function, scheduler, STEP_NS)


class _Parameters:
    """Looks at parameters. Each asks the ROS master, for a millisecond; so who looks at one again weighs more."""

    def __init__(self, scheduler):
        self._scheduler = scheduler
        self._names = set()

    def weight_of(self, name, *_args, **_kwds):
        """Return for how many looks this one counts."""
        if not self._scheduler.current().looks:
            self._names.clear()
        if name in self._names:
            return AGAIN
        self._names.add(name)
        return 1


def _count(function, scheduler, step_ns, weight_of=None):
    def counting(original):
        def look(*args, **kwds):
            if scheduler.is_mine() and not _is_of_ros(sys._getframe(2)):
                try:
                    scheduler.look(step_ns, weight_of(*args, **kwds) if weight_of else 1)
                except TurnLost:
                    pass  # lockstep is over, which the answer says
            return original(*args, **kwds)
        return look
    replace_within(function, counting)


@lru_cache(maxsize=None)
def _is_module_of_ros(name):
    return (name or '').startswith(_ROS)


def _is_of_ros(frame):
    """Whether ROS's own code looks, behind rospy's functions that only hand the question on."""
    name = frame.f_globals.get('__name__')
    while name == 'rospy.rostime':
        frame = frame.f_back
        if frame is None:
            return False
        name = frame.f_globals.get('__name__')
    return _is_module_of_ros(name)
