"""The states in which robots are: one table for reports, metrics, properties and replays.

At each time a robot is in the state with the lowest precedence of those that hold, and idle if none does. A robot that
has failed can do nothing else. Driving and working come before waiting, because the robot does what it is there for.
Waiting comes before charging: a robot that stands in a charger's zone with a goal is kept from its goal. It would stand
there as long without the charger. So a robot is charging only while it has nothing else to do.
"""
from __future__ import annotations

from typing import NamedTuple, Optional, Tuple


class Cause(NamedTuple):
    """Something that puts a robot into a state, from a row of a kind of ``begin`` to one of a kind of ``end``.

    ``what``: what begins and ends. It puts the robot into one state only: if it begins another one, it leaves this one.
    Of a ``named`` thing a robot can have several at once, and the first value of each row is its name.
    """

    what: str
    begin: Tuple[str, ...]
    end: Tuple[str, ...]
    named: bool = False


class State(NamedTuple):
    """A state. Of those that hold, a robot is in the one with the lowest ``precedence``. ``words``: when it holds.

    ``colours``: on light and on dark screens, and on paper, as #rrggbb. ``better``: whether 'lower' or 'higher' shares
    of time are better, None: neither. ``stands_out``: whether maps name a robot in this state before others.
    """

    name: str
    precedence: int
    words: str
    colours: Tuple[str, str, str]
    causes: Tuple[Cause, ...] = ()
    better: Optional[str] = None
    stands_out: bool = False

    @property
    def key(self) -> str:
        """The key of the time in this state [s] among the values of a robot in trial.json."""
        return 'moving_s' if self.name == 'driving' else self.name + '_s'


#: in the order in which they are shown
STATES = (
    State('driving', 10, 'from its departure until it stands', ('#2f74c0', '#6ba8ec', '#2f74c0'),
          (Cause('leg', ('departed', 'driven'), ('stands',)),)),
    State('working', 20, 'while it does a task', ('#23906a', '#55bd94', '#23906a'),
          (Cause('task', ('task_began',), ('task_ended',), True),)),
    State('waiting', 30, 'while it stands with a goal, in the queue of a place, or for a charger',
          ('#d0921a', '#e3b34c', '#d0921a'),
          (Cause('goal', ('goal',), ('ended',), True), Cause('task', ('waiting_began',), ('waiting_ended',), True),
           Cause('charger', ('charge_awaited',), ('charge_assigned',))), 'lower', True),
    State('charging', 40, 'while a charger charges it', ('#8a5fb8', '#b795dd', '#8a5fb8'),
          (Cause('charge', ('charging_began',), ('charging_ended',)),)),
    State('idle', 50, 'otherwise', ('#c3c9c7', '#4b555a', '#b0b0b0')),
    State('failed', 0, 'until it is repaired', ('#c43d33', '#ef7b6f', '#c43d33'),
          (Cause('failure', ('failed', 'failed_began'), ('repaired', 'failed_ended')),), 'lower', True),
)
NAMES = tuple(state.name for state in STATES)
IDLE = NAMES.index('idle')
