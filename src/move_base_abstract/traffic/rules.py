"""The choices of a scenario for its traffic: circles of waiting, blocks, groups, and the price of full lanes."""
from __future__ import annotations

from enum import Enum
from typing import Any, Dict, Mapping, NamedTuple

from ..common.kinds import error, integer, number, one_of
from ..common.parameter_table import Parameter, checked, place_of
from ..common.ros_names import is_robot_name

MOST_GROUPS = 10_000


class DeadlockPolicy(Enum):
    """What happens to a circle of waiting: nothing, a goal is aborted, circles are avoided, or a robot gives way."""

    WAIT = 'wait'
    ABORT = 'abort'
    AVOID = 'avoid'
    RETREAT = 'retreat'


class TrafficRules(NamedTuple):
    """The choices for the traffic.

    ``policy``: what happens to circles of waiting; ``blocks``: the number of areas ahead that must have room before a
    robot goes on; ``lane_price``: when a robot chooses its way, each robot in the way makes a lane cost this share of
    its travel time more, divided by the lane's number of places; ``groups``: {name: number of robots that have place in
    the group}, 1 for groups that are not in it.
    """

    policy: DeadlockPolicy = DeadlockPolicy.WAIT
    blocks: int = 1
    lane_price: float = 0.0
    groups: Mapping[str, int] = {}


_ROOM = integer(1)


def _groups(value: Any) -> Dict[str, int]:
    if not isinstance(value, dict) or len(value) > MOST_GROUPS or not all(
            isinstance(name, str) and is_robot_name(name) for name in value):
        raise ValueError
    return {name: _ROOM(room) for name, room in value.items()}


TABLE = (
    Parameter('deadlock', 'wait', one_of('wait', 'abort', 'avoid', 'retreat')),
    Parameter('blocks', 1, integer(1, 100)),
    Parameter('lane_price', 0.0, number(0.0, 1000.0)),
    Parameter('groups', {}, _groups, allowed='a mapping of names of groups to whole numbers >= 1 [robots]'),
)
KEYS = tuple(parameter.name for parameter in TABLE)


def read_rules(raw: Mapping[str, Any], where: str) -> TrafficRules:
    """Return the :class:`TrafficRules` among the keys of a scenario; the text of an error begins with ``where``.

    :raises ConfigurationError: for values that are not allowed, and for a ``lane_price`` with ``deadlock: avoid``.
    """
    policy, *others = (checked(raw.get(one.name, one.default), one.name, one, where) for one in TABLE)
    rules = TrafficRules(DeadlockPolicy(policy), *others)
    if rules.lane_price and rules.policy is DeadlockPolicy.AVOID:  # it assumes that a robot keeps its way
        raise error(place_of(where, 'lane_price'), rules.lane_price, '0 with it', " with deadlock: 'avoid'")
    return rules
