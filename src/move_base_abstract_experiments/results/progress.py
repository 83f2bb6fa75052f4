"""The progress of a sweep: one changing line on a terminal, otherwise a plain line every few seconds."""
from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, TextIO

from ..records import Result
from .tables import Errors

if TYPE_CHECKING:
    from ..carrying.cluster import Runner

_EVERY_S = 5.0  # wall; between lines without a terminal
_OFTEN_S = 0.5  # wall; between lines on a terminal


class Progress:
    """Counts the trials that have ended, and prints the progress, and each error with the first trial that has it.

    ``stream``: where it prints; ``total``: the number of trials; ``complete``: the number that were complete before.
    """

    def __init__(self, stream: TextIO, total: int, complete: int) -> None:
        self._stream = stream
        self._total = total
        self._done = complete
        self._new = 0
        self._failed = 0
        self._errors = Errors()
        self._begin = time.monotonic()
        self._last = self._begin
        self._is_terminal = stream.isatty()
        if complete:
            print(f'experiment: {complete} of {total} trials are complete already', file=stream, flush=True)

    def begin(self, client: Any, has_dashboard: bool) -> None:
        """Print where the workers are, and start to measure. has_dashboard: whether Dask serves its page about them."""
        address = client.scheduler_info().get('address', '')
        has_dashboard = has_dashboard and client.scheduler_info().get('services')
        link = getattr(client, 'dashboard_link', '') if has_dashboard else ''
        print(f'experiment: Dask scheduler {address}' + (f', dashboard {link}' if link else ''), file=self._stream,
              flush=True)
        self._begin = time.monotonic()

    def count(self, result: Result) -> None:
        """Count a trial that has ended."""
        self._done += 1
        self._new += 1
        self._failed += not result.is_complete
        if self._errors.take(result):
            print(f'\r{"":<78}\r' * self._is_terminal + f'experiment: {self._errors.lines(self._new)[-1]}',
                  file=self._stream, flush=True)
        if self._done == self._total:
            self._say(0)
            if self._is_terminal:
                print(file=self._stream, flush=True)

    def look(self, runner: Runner) -> None:
        """Print the progress, if it is time for it."""
        if time.monotonic() - self._last > (_OFTEN_S if self._is_terminal else _EVERY_S):
            self._say(runner.workers)

    def _say(self, workers: int) -> None:
        self._last = time.monotonic()
        seconds = max(1e-3, self._last - self._begin)
        rate = self._new / seconds
        left = (self._total - self._done) / rate if rate else 0.0
        text = (f'{self._done} of {self._total} trials, {rate:.2f}/s'
                + (f', about {_duration(left)} left' if rate and self._done < self._total else '')
                + (f', {workers} workers' if workers else '') + (f', {self._failed} failed' if self._failed else ''))
        if self._is_terminal:
            print(f'\r{text:<78}', end='', file=self._stream, flush=True)
        else:
            print(text, file=self._stream, flush=True)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f'{hours} h {minutes} min' if hours else f'{minutes} min {rest} s' if minutes else f'{rest} s'
