"""Random numbers, each of which follows only from the seed, a robot, the number of its goal and a purpose.

The generator works by a counter: Philox 4x64-10 (Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2,
3. SC 2011) gives the same bits for the same key and counter, whatever was drawn before. So the numbers of a robot
depend neither on other robots nor on how often anything else was drawn.
"""
from __future__ import annotations

import hashlib
from enum import IntEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SCALE = 2.0 ** -53
_HIGHEST = 1.0 - _SCALE


class Purpose(IntEnum):
    """The purpose of a draw. The results of a seed depend on these values, so they must never change."""

    FACTOR = 1
    FAILURE = 2
    FAILURE_PLACE = 3
    TAIL = 4
    TAIL_SECONDS = 5
    SPREAD = 6
    SMALL_DELAYS = 7
    FAILURE_HOURS = 8
    FAILURE_KM = 9
    FAILURE_GOALS = 10
    REPAIR = 11
    ENCOUNTER = 12
    ENCOUNTER_SECONDS = 13
    ENCOUNTER_SECONDS_OF_OTHER = 14
    STUCK = 15
    BUGGIFY = 16
    ATTEMPT = 17
    ARRIVAL = 41
    TASK_X = 42
    TASK_Y = 43
    TASK_DURATION = 44
    ORDER_STOP = 45
    SCAN = 61
    ODOMETRY = 62


class Chance:
    """The numbers of the robot ``robot_name`` in a run with ``seed`` (a whole number).

    The key is made of the first 16 bytes of the SHA-256 of 'SEED/ROBOT'. The counter is (place, goal number, purpose,
    0), and the first of each block of four numbers is used.
    """

    def __init__(self, seed: int, robot_name: str) -> None:
        from numpy.random import Philox  # numpy is imported only if something is drawn
        digest = hashlib.sha256('{}/{}'.format(seed, robot_name).encode()).digest()
        self._generator = Philox(key=[int.from_bytes(digest[at:at + 8], 'little') for at in (0, 8)])
        self._state = self._generator.state
        self._beyond = self._state['buffer_pos']  # the position at which no number of a block is left

    def uniform(self, goal_number: int, purpose: Purpose, place: int = 0) -> float:
        """Return the ``place``-th number of a goal for a purpose, uniformly distributed in (0, 1), without the ends."""
        state = self._state
        state['state']['counter'][:] = (place, goal_number, purpose, 0)
        state['buffer_pos'] = self._beyond
        self._generator.state = state
        # The highest possible number would be rounded to 1.
        return min(_HIGHEST, ((int(self._generator.random_raw()) >> 11) + 0.5) * _SCALE)

    def uniforms(self, number: int, purpose: Purpose, count: int) -> NDArray[Any]:
        """Return an array of ``count`` numbers for a purpose, uniformly distributed in [0, 1).

        ``number`` is in the place of the goal's number in :meth:`uniform`. All four numbers of each block are used,
        from place 0 on.
        """
        state = self._state
        state['state']['counter'][:] = (0, number, purpose, 0)
        state['buffer_pos'] = self._beyond
        self._generator.state = state
        return (self._generator.random_raw(count) >> 11) * _SCALE
