"""The choices of a scenario for its traffic: circles of waiting, blocks, groups, and what waiting costs a route."""
from __future__ import annotations

from enum import Enum
from typing import Any, Dict, Mapping, NamedTuple

from ..common.errors import ConfigurationError
from ..common.parameter_table import Parameter, checked, integer, number, one_of
from ..common.ros_names import is_robot_name

MOST_GROUPS = 10_000


class DeadlockPolicy(Enum):
    """What becomes of a circle of waiting: nothing, a goal is aborted, none comes to be, or a robot gives way."""

    WAIT = 'wait'
    ABORT = 'abort'
    AVOID = 'avoid'
    RETREAT = 'retreat'


class TrafficRules(NamedTuple):
    """``policy``: what becomes of circles of waiting; ``blocks``: how many areas ahead must have room to go on.

    ``lane_price``: how much a robot that is in the way makes a lane longer for the choice of a route; ``groups``: for
    how many robots there is place in groups, {name: number}, 1 in those that are not there.
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
    Parameter('deadlock', 'wait', one_of('wait', 'abort', 'avoid', 'retreat'),
              "'wait', 'abort', 'avoid' or 'retreat'"),
    Parameter('blocks', 1, integer(1, 100), 'a whole number in 1..100'),
    Parameter('lane_price', 0.0, number(0.0, 1000.0), 'a number in 0..1000'),
    Parameter('groups', {}, _groups, 'a mapping of names of groups to whole numbers >= 1 [robots]'),
)
KEYS = tuple(parameter.name for parameter in TABLE)


def read_rules(raw: Mapping[str, Any], where: str) -> TrafficRules:
    """Return the :class:`TrafficRules` among the keys of a scenario; ``where`` begins the text of an error.

    :raises ConfigurationError: for values that are not allowed, and a price where ways are kept.
    """
    policy, *others = (checked(raw.get(one.name, one.default), one.name, one, where) for one in TABLE)
    rules = TrafficRules(DeadlockPolicy(policy), *others)
    if rules.lane_price and rules.policy is DeadlockPolicy.AVOID:  # which holds of the way that a robot has
        raise ConfigurationError("parameter {}/lane_price: got {:g} with deadlock: 'avoid'; allowed: 0 with it".format(
            where.rstrip('/'), rules.lane_price))
    return rules
