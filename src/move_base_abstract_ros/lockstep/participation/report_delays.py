"""Delays of a participant's reports and first turns, in wall time. By them ``verify`` shows that they do not matter.

``MOVE_BASE_ABSTRACT_REPORT_DELAY`` is SEED:MILLISECONDS. One report in sixteen is then held back for a random time of
at most MILLISECONDS. The seed and the node's name determine which reports these are, and for how long.

``MOVE_BASE_ABSTRACT_FIRST_TURNS`` is COUNT:MILLISECONDS. Each of the first COUNT turns then begins MILLISECONDS later,
so that calls of several nodes to the ROS master at one instant come in another order.
"""
from __future__ import annotations

import os
import random
import re
from time import sleep  # the real one, by the wall clock: the launcher replaces the name in the module
from typing import Any

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

VARIABLE = 'MOVE_BASE_ABSTRACT_REPORT_DELAY'
FIRST_VARIABLE = 'MOVE_BASE_ABSTRACT_FIRST_TURNS'
ONE_IN = 16
_FORM = re.compile(r'([0-9]{1,9}):([0-9]{1,4})\Z', re.ASCII)


def _read(name: str, variable: str, form: str) -> Any:
    """Return (first number as a text, seconds) of an environment variable, or None if it is not set.

    :raises ConfigurationError: if it has another form than ``form``.
    """
    text = os.environ.get(variable, '')
    if not text:
        return None
    found = _FORM.match(text)
    if not found:
        raise ConfigurationError('{}: the environment variable {} must be {}, whole numbers of at most 9 and 4 digits, '
                                 'got {}'.format(name, variable, form, shown(text)))
    return found.group(1), int(found.group(2)) * 1e-3


def make_delay(name: str) -> Any:
    """Return a function that delays some reports of the node ``name``; None if no delays are asked for.

    :raises ConfigurationError: if the environment variable has another form.
    """
    found = _read(name, VARIABLE, 'SEED:MILLISECONDS')
    if found is None:
        return None
    chance = random.Random('{}:{}'.format(found[0], name))

    def delay() -> None:
        if chance.randrange(ONE_IN) == 0:
            sleep(chance.random() * found[1])
    return delay


def make_beginning(name: str) -> Any:
    """Return a function to be called in each turn of the node ``name``, which delays the first turns.

    Return None if no delays are asked for.

    :raises ConfigurationError: if the environment variable has another form.
    """
    found = _read(name, FIRST_VARIABLE, 'COUNT:MILLISECONDS')
    if found is None:
        return None
    left = [int(found[0])]

    def begin() -> None:
        if left[0] > 0:
            left[0] -= 1
            sleep(found[1])
    return begin
