"""Delays of a participant's reports and first turns, in wall time: what `verify` uses to show that they do not matter.

``MOVE_BASE_ABSTRACT_REPORT_DELAY`` is SEED:MILLISECONDS. One report in sixteen is then held back for a random part of
so many milliseconds; which ones, and for how long, follows from the seed and the node's name.

``MOVE_BASE_ABSTRACT_FIRST_TURNS`` is COUNT:MILLISECONDS. Each of so many first turns then begins so much later: what
several nodes tell the ROS master at one instant comes in another order.
"""
import os
import random
import re
from time import sleep  # the wall's: the launcher replaces the name in the module

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

VARIABLE = 'MOVE_BASE_ABSTRACT_REPORT_DELAY'
FIRST_VARIABLE = 'MOVE_BASE_ABSTRACT_FIRST_TURNS'
ONE_IN = 16
_FORM = re.compile(r'([0-9]{1,9}):([0-9]{1,4})\Z', re.ASCII)


def _read(name, variable, form):
    """Return the two numbers of an environment variable, or None. :raises ConfigurationError: if it has others."""
    text = os.environ.get(variable, '')
    if not text:
        return None
    found = _FORM.match(text)
    if not found:
        raise ConfigurationError('{}: the environment variable {} must be {}, whole numbers of at most 9 and 4 digits, '
                                 'got {}'.format(name, variable, form, shown(text)))
    return found.group(1), int(found.group(2)) * 1e-3


def make_delay(name):
    """Return a function that waits now and then, for the node ``name``; None where none are asked for.

    :raises ConfigurationError: if the environment variable has another form.
    """
    found = _read(name, VARIABLE, 'SEED:MILLISECONDS')
    if found is None:
        return None
    chance = random.Random('{}:{}'.format(found[0], name))

    def delay():
        if chance.randrange(ONE_IN) == 0:
            sleep(chance.random() * found[1])
    return delay


def make_beginning(name):
    """Return a function for each turn of the node ``name``, which waits in the first ones; None if none is asked for.

    :raises ConfigurationError: if the environment variable has another form.
    """
    found = _read(name, FIRST_VARIABLE, 'COUNT:MILLISECONDS')
    if found is None:
        return None
    left = [int(found[0])]

    def begin():
        if left[0] > 0:
            left[0] -= 1
            sleep(found[1])
    return begin
