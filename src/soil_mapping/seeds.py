"""One seeded generator per purpose and robot: adding a robot, or a draw for one purpose, moves nothing else."""

from enum import IntEnum

import numpy as np


class Purpose(IntEnum):
    """What chance decides. The numbers are part of what makes a trial repeatable: never change one."""

    START = 0
    RANDOM_TASKS = 1
    DWELL = 2
    FIELD = 3
    BOOTSTRAP = 4


def generator(seed, purpose, robot=0):
    """Return a numpy Generator made of a seed (whole number >= 0), a Purpose and a robot's index alone."""
    return np.random.default_rng([seed, int(purpose), robot])
