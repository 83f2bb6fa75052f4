"""Watch the workers of a cluster: end those on this computer that are silent, so that others take their place.

The scheduler hears a worker several times a second. A worker that is stopped, or hangs, would keep its trial for ever.
A worker that was killed and does not come back in time is given up by Dask, which starts no other. Silence counts only
while this process itself is awake: after a computer has slept, no worker is at fault.
"""
from __future__ import annotations

import contextlib
import json
import math
import os
import signal
import time
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from move_base_abstract.common.errors import ConfigurationError, SimulatorError
from move_base_abstract.common.json_files import load_json_mapping
from move_base_abstract.common.shown import shown_text

FILE = 'workers.json'
LOST_S = 30.0  # wall; then Dask gives up a worker that does not come back, and we ask for another
_SILENT_S = 20.0  # wall; then a silent worker on this computer is ended
_NONE_S = 60.0  # wall; if no worker is heard for this time, the sweep ends
_ANSWER_S = 10.0  # wall; the time in which the scheduler must answer
_MOST_COUNTED_S = 2.0  # wall; of the time between two looks, at most this counts as silence
_TELL_S, _HEARD_S, _OLD_S = 2.0, 5.0, 60.0  # wall
_MOST_SHOWN = 1000
_TASKS = '/proc/{}/task'


class NoWorkerError(SimulatorError):
    """No worker has been heard for a while."""


class Worker(NamedTuple):
    """One worker, in a form for people."""

    name: str
    trials: Tuple[str, ...]  # its tasks by their first trials, '0007-abcdef and 15 more'; the first task runs
    silent_s: float  # wall


class Workers:
    """The workers of a Client.

    :param cluster: the cluster on this computer, or None if a running scheduler is used. :param wanted: the number of
        workers of that cluster. :param clock: returns wall time [s]. :param spool: a folder that the client and all
        workers see, or None.
    """

    def __init__(self, client: Any, cluster: Any, wanted: int, clock: Callable[[], float] = time.monotonic,
                 spool: Optional[str] = None) -> None:
        self._client = client
        self._cluster = cluster
        self._wanted = wanted
        self._clock = clock
        self._last_look: Optional[float] = None
        self._without_s = 0.0
        #: {address: (when the scheduler last heard the worker, for how long nothing new was heard [s])}
        self._silent: Dict[str, Tuple[Any, float]] = {}
        self._ended: Set[str] = set()
        self.known: Tuple[Worker, ...] = ()
        self.spool = spool

    def look(self) -> int:
        """Look at all workers: return the number of threads of those that are heard; ``known`` has all as Workers.

        :raises NoWorkerError: if none has been heard for a minute.
        """
        begin = self._clock()
        passed = min(_MOST_COUNTED_S, begin - self._last_look) if self._last_look is not None else 0.0
        known, processing = self._ask()
        self._last_look = self._clock()
        asked = min(self._last_look - begin, 2 * _ANSWER_S)
        self._silent = {address: self._heard(address, about, passed) for address, about in known.items()}
        self.known = tuple(Worker(self._name(address, about), tuple(map(_trials_of, processing.get(
            address, ()))), round(self._silent[address][1], 1)) for address, about in sorted(known.items()))
        heard = [address for address in known if self._silent[address][1] < _SILENT_S]
        self._without_s = 0.0 if heard else self._without_s + passed + asked
        if self._without_s >= _NONE_S:
            raise NoWorkerError(f'no worker has been heard for {_NONE_S:g} s ({len(known)} are known); complete '
                                'trials stay, and the same command goes on')
        if self._cluster is not None:
            self._replace([address for address in known if address not in heard], len(known))
        return sum(known[address].get('nthreads', 1) for address in heard)

    def _ask(self) -> Tuple[Dict[str, Any], Dict[str, Any]]:
        """Return ({address: what the scheduler knows of a worker}, {address: keys of its tasks})."""
        with contextlib.suppress(Exception):  # whatever it raises, no worker was heard
            known = self._client.sync(self._client.scheduler.identity, callback_timeout=_ANSWER_S)['workers']
            return known, self._client.sync(self._client.scheduler.processing, workers=None, callback_timeout=_ANSWER_S)
        return {}, {}

    def _heard(self, address: str, about: Dict[str, Any], passed: float) -> Tuple[Any, float]:
        last, silent = self._silent.get(address, (None, 0.0))
        return (last, silent + passed) if about.get('last_seen') == last else (about.get('last_seen'), 0.0)

    def _name(self, address: str, about: Dict[str, Any]) -> str:
        pid = self._pid(address)
        return f'{about.get("name", "")} (process {pid})' if pid else f'{about.get("name", "")} ({address})'

    def _pid(self, address: str) -> Optional[int]:
        nannies = list(self._cluster.workers.values()) if self._cluster is not None else ()
        return next((one.pid for one in nannies if getattr(one, 'worker_address', None) == address), None)

    def _replace(self, silent: List[str], count: int) -> None:
        """End silent workers on this computer. Dask starts others in their place; if it does not, ask it to."""
        for address in silent:
            pid = self._pid(address)
            if pid and address not in self._ended:
                self._ended.add(address)
                _end(pid)
        if count < self._wanted:
            with contextlib.suppress(Exception):
                self._cluster.scale(self._wanted)


def key_of(number: int, names: Sequence[str]) -> str:
    """Return the key of a task of Dask that runs trials.

    All keys begin with the same word, because Dask keeps some memory for each first word.
    """
    return f'trials-{os.getpid()}-{number}-{len(names) - 1}-{names[0]}'


def _trials_of(key: object) -> str:
    """Return the trials of a task by its key, in words for people: '0007-abcdef and 15 more'."""
    words = str(key).split('-', 4)
    if len(words) < 5:
        return str(key)  # a task of another program
    return words[4] if words[3] == '0' else f'{words[4]} and {words[3]} more'


@contextlib.contextmanager
def workers_file(folder: Any) -> Iterator[Callable[..., None]]:
    """Give a function that writes Workers into an OutputFolder, but not too often. `experiment status` reads them.

    At the end an empty list is written.
    """
    last = [-math.inf]

    def tell(told: Sequence[Worker], is_due: bool = False) -> None:
        if is_due or time.monotonic() - last[0] > _TELL_S:
            last[0] = time.monotonic()
            folder.write(FILE, (json.dumps({'format': 1, 'told_at': time.time(), 'workers': [
                one._asdict() for one in told]}) + '\n').encode())
    try:
        yield tell
    finally:
        tell((), True)


def lines(folder: str, now: float) -> Iterator[str]:
    """Yield lines about the workers of a running experiment: a headline, then one for each. now: of time.time() [s].

    :raises ConfigurationError: if the file cannot be understood.
    """
    path = os.path.join(folder, FILE)
    try:
        about = load_json_mapping(path)
    except FileNotFoundError:
        return
    told_at, found = about.get('told_at'), about.get('workers')
    if not isinstance(told_at, (int, float)) or not isinstance(found, list) or not abs(told_at) < 1e15:
        raise ConfigurationError(f'{path}: must hold told_at and workers')
    age = max(0.0, now - told_at)
    if found:
        yield f'{len(found)} workers, as told {age:.0f} s ago' + (
            '; nothing was reported since: the run was killed, or stands still' if age > _OLD_S else '') + ':'
    for one in [one for one in found[:_MOST_SHOWN] if isinstance(one, dict)]:
        trials, silent = one.get('trials'), one.get('silent_s')
        trials = [shown_text(each) for each in trials] if isinstance(trials, list) else []
        is_silent = isinstance(silent, (int, float)) and silent > _HEARD_S
        yield (f"  {shown_text(one.get('name'))}: " + (f"{', '.join(trials[:3])}" if trials else 'waits for a trial')
               + (f'; not heard for {silent:.0f} s' if is_silent else ''))


def _end(pid: int) -> None:
    """Kill a process. Let its children go on if they are stopped, too, so that they notice its end."""
    children: List[int] = []
    with contextlib.suppress(OSError):
        for task in os.listdir(_TASKS.format(pid)):
            with open(f'{_TASKS.format(pid)}/{task}/children') as stream:
                children += [int(word) for word in stream.read().split()]
    with contextlib.suppress(OSError):
        os.kill(pid, signal.SIGKILL)
    for child in children:
        with contextlib.suppress(OSError):
            os.kill(child, signal.SIGCONT)
