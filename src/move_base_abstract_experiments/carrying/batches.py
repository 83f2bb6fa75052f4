"""Batches: several short trials in one task of Dask, because a task costs client, scheduler and worker milliseconds.

A batch holds as many trials as take about BATCH_S together, by the durations of recent ones. Each trial fails, reaches
its limits and runs again by itself. Trials that a worker has not begun after LONGEST_S go back, so that none waits
behind long ones.
"""
from __future__ import annotations

import math
import pickle
import time
from typing import Any, List, NamedTuple, Optional, Tuple

from . import jobs, spool

BATCH_S = 1.0  # wall; the wanted duration of a batch
LONGEST_S = 3.0  # wall; then a worker begins no more trials of a batch
MOST = 250  # trials in a batch
_MOST_BYTES = 16 << 20  # of outputs; without a spool they go back in one message
_SHARES = 4  # each thread of a worker has at least so many batches left, so that all threads end at about the same time
_LATELY = 200  # trials; the durations of about so many count


class Answer(NamedTuple):
    """The outcome of a trial. ``outputs``: bytes, or None if they are in the spool or there is a ``problem``."""

    worker: str
    outputs: Optional[bytes]
    problem: Optional[str]
    is_lost: bool = False  # whether its worker died while it ran


class Sizes:
    """The sizes of batches, from the durations of recent trials."""

    def __init__(self) -> None:
        self._count = 0.0
        self._seconds = 0.0

    def learn(self, count: int, seconds: float) -> None:
        """Take note that ``count`` trials have taken ``seconds`` together [s, wall]."""
        if self._count > _LATELY:
            self._count, self._seconds = self._count / 2.0, self._seconds / 2.0
        self._count += count
        self._seconds += seconds

    def size(self, left: int, threads: int) -> int:
        """Return the size of the next batch. left: the number of trials still to run; threads: those of all workers."""
        if not self._count:
            return 1
        fit = BATCH_S * self._count / max(self._seconds, 1e-6)
        return max(1, min(MOST, int(min(fit, MOST)), math.ceil(left / (_SHARES * max(1, threads)))))


def carry_out(batch: bytes, path: Optional[str]) -> Tuple[float, int, List[Tuple[Any, ...]]]:
    """Run a batch on this worker; return (wall s, the number of trials that ran, [Answer as a tuple]).

    batch: a pickled list of Jobs, which holds only once what they share. path: the path of the batch's notes in the
    spool, or None. There is an answer for each trial that was begun, in their order. The others go back.
    """
    notes = spool.Notes(path) if path else None
    begun, ends = notes.begun() if notes else None, jobs.ends()
    answers: List[Answer] = []
    begin, size, ran = time.monotonic(), 0, 0
    for number, job in enumerate(pickle.loads(batch)):
        if notes and notes.has(number):  # a worker that has died since has run it
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
