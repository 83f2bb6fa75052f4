"""Several short trials in one task of Dask, which costs several milliseconds of all who take part.

A batch holds as many trials as have taken about BATCH_S lately. Each trial stays one by itself: it fails, is limited
and runs again without the others. What a worker has not begun after LONGEST_S goes back: none waits behind long ones.
"""
from __future__ import annotations

import math
import pickle
import time
from typing import Any, List, NamedTuple, Optional, Tuple

from . import jobs, spool

BATCH_S = 1.0  # wall, of a batch
LONGEST_S = 3.0  # wall, after which a worker begins no more trials of a batch
MOST = 250  # trials
_MOST_BYTES = 16 << 20  # of outputs, which go back in one message where there is no spool
_SHARES = 4  # batches that each thread of a worker has left to run at least, so that all end at about the same time
_LATELY = 200  # trials


class Answer(NamedTuple):
    """What became of a trial. ``outputs``: bytes, or None if they are in the spool, or there is a ``problem``."""

    worker: str
    outputs: Optional[bytes]
    problem: Optional[str]
    is_lost: bool = False  # a worker has died while it ran


class Sizes:
    """How many trials go together, by how long trials have taken lately."""

    def __init__(self) -> None:
        self._count = 0.0
        self._seconds = 0.0

    def learn(self, count: int, seconds: float) -> None:
        """So many trials have taken so long together [s, wall]."""
        if self._count > _LATELY:
            self._count, self._seconds = self._count / 2.0, self._seconds / 2.0
        self._count += count
        self._seconds += seconds

    def size(self, left: int, threads: int) -> int:
        """Return how many of those that are left go into the next batch. threads: of workers."""
        if not self._count:
            return 1
        fit = BATCH_S * self._count / max(self._seconds, 1e-6)
        return max(1, min(MOST, int(min(fit, MOST)), math.ceil(left / (_SHARES * max(1, threads)))))


def carry_out(batch: bytes, path: Optional[str]) -> Tuple[float, int, List[Tuple[Any, ...]]]:
    """Run Jobs, a pickled list, on this worker; return (wall s, how many ran, [Answer as a tuple]).

    What all of them share travels once in a pickle. Answers are as many as trials were begun, one for each in turn; the
    others are given back. path: of the batch's notes in the spool, or None.
    """
    notes = spool.Notes(path) if path else None
    begun, ends = notes.begun() if notes else None, jobs.ends()
    answers: List[Answer] = []
    begin, size, ran = time.monotonic(), 0, 0
    for number, job in enumerate(pickle.loads(batch)):
        if notes and notes.has(number):  # by a worker that has died since
            answers.append(Answer('', None, None))
        elif begun == number:
            answers.append(Answer('', None, 'its worker died', True))
        elif jobs.ends() != ends or ran and time.monotonic() - begin > LONGEST_S or size > _MOST_BYTES:
            break
        else:
            if notes:
                notes.begin(number)
            answers.append(Answer(*jobs.carry_out(job, notes.place(number) if notes else None)))
            size += len(answers[-1].outputs or b'')
            ran += 1
    return time.monotonic() - begin, ran, [tuple(one) for one in answers]
