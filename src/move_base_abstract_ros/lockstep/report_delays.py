"""Random delays of a participant's reports, in wall time: what `verify` uses to show that they do not matter.

``MOVE_BASE_ABSTRACT_REPORT_DELAY`` is SEED:MILLISECONDS. One report in sixteen is then held back for a random part of
so many milliseconds; which ones, and for how long, follows from the seed and the node's name.
"""
import os
import random
import re
from time import sleep  # the wall's: the launcher replaces the name in the module

from move_base_abstract.errors import ConfigurationError
from move_base_abstract.shown import shown

VARIABLE = 'MOVE_BASE_ABSTRACT_REPORT_DELAY'
ONE_IN = 16
_FORM = re.compile(r'([0-9]{1,9}):([0-9]{1,4})\Z', re.ASCII)


def make_delay(name):
    """Return a function that waits now and then, for the node ``name``; None where none are asked for.

    :raises ConfigurationError: if the environment variable has another form.
    """
    text = os.environ.get(VARIABLE, '')
    if not text:
        return None
    found = _FORM.match(text)
    if not found:
        raise ConfigurationError('{}: the environment variable {} must be SEED:MILLISECONDS, whole numbers of at '
                                 'most 9 and 4 digits, got {}'.format(name, VARIABLE, shown(text)))
    chance = random.Random('{}:{}'.format(found.group(1), name))
    longest = int(found.group(2)) * 1e-3

    def delay():
        if chance.randrange(ONE_IN) == 0:
            sleep(chance.random() * longest)
    return delay
