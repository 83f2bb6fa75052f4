"""How a goal ends: the states of goals, and all endings with the texts that clients get."""
from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class GoalState(Enum):
    """The states of a goal, with the numbers of actionlib_msgs/GoalStatus."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLING = 7
    RECALLED = 8


TEXT_ACCEPTED = 'This goal has been accepted by the simple action server'
TEXT_ANOTHER_GOAL = 'This goal was canceled because another goal was received by the simple action server'
TEXT_BEFORE_LAST_CANCEL = ('This goal handle was canceled by the action server because its timestamp is before the '
                           'timestamp of the last cancel request')


@dataclass(frozen=True)
class Outcome:
    """An ending: the goal's final state, the text for the client, and whether the wheels are told to stop."""

    state: GoalState
    text: str = ''
    stops_wheels: bool = True


REACHED = Outcome(GoalState.SUCCEEDED, 'Goal reached.')
CANCELLED = Outcome(GoalState.PREEMPTED, '')
REPLACED = Outcome(GoalState.PREEMPTED, TEXT_ANOTHER_GOAL, stops_wheels=False)
INVALID_QUATERNION = Outcome(GoalState.ABORTED, 'Aborting on goal because it was sent with an invalid quaternion',
                             stops_wheels=False)
NO_PLAN = Outcome(GoalState.ABORTED, 'Failed to find a valid plan. Even after executing recovery behaviors.')
NO_CONTROL = Outcome(GoalState.ABORTED, 'Failed to find a valid control. Even after executing recovery behaviors.')
NODE_KILLED = Outcome(GoalState.ABORTED, 'Aborting on the goal because the node has been killed')
ROBOT_REMOVED = Outcome(GoalState.ABORTED, 'Aborting on the goal because the robot has been removed')
ROBOT_RESET = Outcome(GoalState.ABORTED, 'Aborting on the goal because the robots have been reset')
BATTERY_EMPTY = Outcome(GoalState.ABORTED, 'Aborting on the goal because the battery is empty')
FAILED = Outcome(GoalState.ABORTED, 'Aborting on the goal because the robot has failed')

DRIVEN_BY_VELOCITIES = Outcome(
    GoalState.ABORTED, 'The robot is driven by velocities and takes no goals: send commands to cmd_vel or, in Python, '
    'by drive(); with driven_by: goals it travels to goals', stops_wheels=False)
CLOCK_RESTARTED = Outcome(GoalState.ABORTED, 'Aborting on the goal because simulated time has started anew')


def aborted(text: str) -> Outcome:
    """Return the ending of a goal that is refused for the reason ``text``."""
    return Outcome(GoalState.ABORTED, text)
