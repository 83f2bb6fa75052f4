"""One seeded generator for each purpose and robot, so that a new robot, or a new draw, changes no other draws."""
from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np


class Purpose(IntEnum):
    """The purposes of draws. Never change a number, because trials are repeatable only with the same numbers."""

    START = 0
    RANDOM_TASKS = 1
    DWELL = 2
    FIELD = 3
    BOOTSTRAP = 4


def generator(seed: int, purpose: Purpose, robot: int = 0) -> Any:
    """Return a numpy Generator that depends only on a seed (whole number >= 0), a Purpose and a robot's index."""
    return np.random.default_rng([seed, int(purpose), robot])
