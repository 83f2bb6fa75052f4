"""Loops that wait by looking, without sleeping, such as ``while not rospy.is_shutdown(): if flag: ...``.

They look by functions of rospy and actionlib. After a number of looks in a row the thread gives its turn away
(:meth:`Scheduler.look`), so that what it looks for can happen. Looks are counted and not timed, so a run with such
loops is as repeatable as any other.
"""
from __future__ import annotations

import sys
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Callable, Optional, Set

import rospy
import rospy.client
import rospy.rostime
import rospy.topics

from move_base_abstract.lockstep.loops import STEP_NS, TIME_STEP_NS

from .waits import replace_within

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

    from ..participation.taking_part import Participant

#: the weight of a look at a parameter at which the thread has looked before, since its last wait
AGAIN = 250
_ROS = ('rospy.', 'actionlib.', 'tf2_ros.')


def install(participant: Participant) -> None:
    """Count the looks of the application's threads."""
    from actionlib import action_client, simple_action_client  # only now: the locks that it makes are replaced ones
    scheduler = participant.scheduler
    for function in (rospy.core.is_shutdown, rospy.topics.Topic.get_num_connections,
                     simple_action_client.SimpleActionClient.get_state,
                     action_client.ClientGoalHandle.get_comm_state, action_client.ClientGoalHandle.get_goal_status):
        _count(function, scheduler, STEP_NS)
    for function in (rospy.client.get_param, rospy.client.has_param):
        _count(function, scheduler, STEP_NS, _Parameters(scheduler).weight_of)
    _count(rospy.rostime.get_rostime, scheduler, TIME_STEP_NS)


class _Parameters:
    """Looks at parameters. Each takes a millisecond, by a call of the ROS master, so a repeated one weighs more."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._names: Set[str] = set()

    def weight_of(self, name: str, *_args: Any, **_kwds: Any) -> int:
        """Return the number of looks as which this one counts."""
        if not self._scheduler.current().looks:
            self._names.clear()
        if name in self._names:
            return AGAIN
        self._names.add(name)
        return 1


def _count(function: Callable[..., Any], scheduler: Scheduler, step_ns: int,
           weight_of: Optional[Callable[..., int]] = None) -> None:
    def counting(original: Callable[..., Any]) -> Callable[..., Any]:
        def look(*args: Any, **kwds: Any) -> Any:
            if scheduler.is_mine() and not _is_of_ros(sys._getframe(2)):
                scheduler.look(step_ns, weight_of(*args, **kwds) if weight_of else 1)
            return original(*args, **kwds)
        return look
    replace_within(function, counting)


@lru_cache(maxsize=None)
def _is_module_of_ros(name: str) -> bool:
    return (name or '').startswith(_ROS)


def _is_of_ros(frame: Any) -> bool:
    """Return whether ROS's own code looks, above rospy's functions that only pass the question on."""
    name = frame.f_globals.get('__name__')
    while name == 'rospy.rostime':
        frame = frame.f_back
        if frame is None:
            return False
        name = frame.f_globals.get('__name__')
    return _is_module_of_ros(name)
