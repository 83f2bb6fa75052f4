"""The rule for names in the ROS graph, which scenarios, missions and parameters use.

http://wiki.ros.org/Names: a letter first, then letters, digits and '_'; '/' between the parts of a longer name.
"""
from __future__ import annotations

import re
from typing import Tuple, Union

ROBOT_NAME_RULE = "letters, digits and '_', a letter first"
NAMESPACE_RULE = "names of {}, with '/' between them".format(ROBOT_NAME_RULE)
MAX_NAME_LENGTH = 200  # characters; a name becomes a part of many others
_NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]*\Z')
_NAMESPACE = re.compile(r'/?([A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*/?)?\Z')


def is_robot_name(value: object) -> bool:
    """Return whether ``value`` can be the name of a robot, which is also its namespace and the prefix of its frames."""
    return isinstance(value, str) and len(value) <= MAX_NAME_LENGTH and bool(_NAME.match(value))


def robot_name(value: object) -> str:
    """Return ``value`` if it can be the name of a robot, and so of a place, a zone or a group.

    :raises ValueError: if it cannot.
    """
    if not isinstance(value, str) or not is_robot_name(value):
        raise ValueError
    return value


def natural_order(name: str) -> Tuple[Tuple[Union[str, int], ...], str]:
    """Return a key to sort names such that numbers in them count as numbers: bot_2 comes before bot_10."""
    parts = re.split('([0-9]+)', name)  # texts and numbers in turn, so that only like is compared with like
    return tuple(int(part) if number % 2 else part for number, part in enumerate(parts)), name


def is_namespace(value: object) -> bool:
    """Return whether ``value`` can be a namespace, with or without a slash in front; '' and '/' are allowed."""
    return isinstance(value, str) and len(value) <= MAX_NAME_LENGTH and bool(_NAMESPACE.match(value))
