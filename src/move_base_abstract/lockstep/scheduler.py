"""The turns of a participant's threads: one application thread runs at a time, the next one follows in a stated order.

The application thread that runs has the *turn*. At a known wait it gives the turn away. If no thread can go on, the
round is over: the thread that waited last sends the report to the time master and reads the next grant. Within a grant,
messages come in the order of the grant, then the threads that they woke in the order in which they were woken, then the
event source, then sleepers in the order of their times (with equal times, the one that began to sleep first).

Messages are handled by worker threads that have nothing else on their stack. A worker that waits in the middle of a
callback is a thread like any other, and another worker takes over. So a callback may sleep or call services.

This module knows no ROS and no sockets. ``channel.exchange()`` reports, waits for the next grant and returns its
actions. Then ``channel.is_at_rest`` says whether no participant has anything left to do at this instant.
"""
from __future__ import annotations

import heapq
import sys
import threading
from collections import deque
from threading import get_ident
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

from .beside import Beside
from .loops import Looking, holds
from .open_waits import OWED
from .task import Task, TurnLost, _make_lock, is_current, release
from .wire import NEVER

_Thread_start = threading.Thread.start


class Scheduler(Looking, Beside):
    """Gives the turn to the threads of the process, one after another."""

    #: for all schedulers of the process: called in each application thread, with True when it begins, False at its end
    thread_changes: Optional[Callable[[bool], object]] = None
    #: called in each application thread when it has been given the turn, or has taken a grant in
    turn_begins: Optional[Callable[[], object]] = None

    def __init__(self, channel: Any) -> None:
        self._channel = channel
        self.now_ns = 0  # [ns], the instant of the present grant; the channel sets it
        self.shown_ns = [0]  # the same, for code that reads it in memory; the channel sets it, too
        self._source: Any = None
        self._is_source_busy = False
        self.is_closed = False
        self.turn_ident = 0
        self.beside = {}
        self._beside_lock = _make_lock()
        self._tasks: Dict[int, Task] = {}
        self._ready: Deque[Task] = deque()
        self._mail: Deque[Any] = deque()
        self._sleepers: List[Tuple[int, int, int, Task]] = []
        self._sequence = 0
        self._next_round: Deque[Any] = deque()
        self._resting: Deque[Any] = deque()
        self._conditions: List[Tuple[Callable[[], object], Task]] = []
        self._idle_workers: List[Task] = []
        self._open: List[Any] = []
        self._outside: Deque[Any] = deque()
        self._outside_lock = _make_lock()
        self._happened = 0

    def set_source(self, source: Any) -> None:
        """Set the event source that grants drive: ``source.next_due_ns()`` -> int or None, ``source.run(now_ns)``."""
        self._source = source

    # --- threads and their tasks ------------------------------------------------------------------------------------

    def is_mine(self) -> bool:
        """Return whether the calling thread has the turn; a thread that was let go waits for it first."""
        return (self.turn_ident == get_ident() or bool(self.beside) and self.comes_back()) and not self.is_closed

    def adopt_caller(self, name: str) -> None:
        """Make the calling thread the first one of the application, with the turn."""
        task = Task(name)
        self._enter(task)
        self.turn_ident = task.ident

    def _enter(self, task: Task) -> None:
        task.ident = get_ident()
        self._tasks[task.ident] = task
        if self.thread_changes is not None:
            self.thread_changes(True)

    def current(self) -> Any:
        """Return the task of the calling thread, or None."""
        return self._tasks.get(get_ident())

    # --- threads of the application ---------------------------------------------------------------------------------

    def spawn(self, name: str) -> Task:
        """Return a task for a thread that is about to start; it is ready, after those that are ready already."""
        task = Task(name)
        self._ready.append(task)
        return task

    def begin(self, task: Task) -> None:
        """Wait for the first turn; a new application thread calls this first."""
        self._enter(task)
        task.parking.acquire()
        if not self.is_closed:
            self._take_turn(task)

    def _take_turn(self, task: Task) -> None:
        self.turn_ident = task.ident
        if self.turn_begins is not None:
            self.turn_begins()

    def finish(self) -> None:
        """Pass the turn on; an application thread calls this last."""
        self.comes_back()
        task = self._tasks.pop(get_ident(), None)
        if task is None:
            return
        task.is_finished = True
        if self.thread_changes is not None:
            self.thread_changes(False)
        self._happened += 1
        if self.turn_ident == task.ident and not self.is_closed:
            self._resume_worker()

    # --- waiting ----------------------------------------------------------------------------------------------------

    def wait(self, wake_ns: int = NEVER, waits_for: str = '', kind: Optional[str] = OWED) -> bool:
        """Give the turn away until :meth:`wake` or ``wake_ns`` [ns]; return False if time was up.

        ``waits_for``: what the thread waits for, in words. ``kind``: the kind of a wait without end
        (:mod:`.open_waits`), which counts when nothing is left to happen; None: it does not count.

        :raises TurnLost: if the participant leaves lockstep meanwhile.
        """
        task = self._tasks[get_ident()]
        task.looks = task.turns = task.idle_turns = task.is_looking = 0
        self._happened += 1
        return self._wait(task, wake_ns, waits_for, kind)

    def _wait(self, task: Task, wake_ns: int, waits_for: str, kind: Optional[str]) -> bool:
        task.is_waiting = True
        task.timed_out = False
        task.wake_token += 1
        if wake_ns < NEVER:
            self._sequence += 1
            heapq.heappush(self._sleepers, (wake_ns, self._sequence, task.wake_token, task))
        task.waits_for = waits_for
        task.kind = kind if wake_ns >= NEVER else None
        is_open = task.kind is not None
        if is_open:
            self._open.append(task)
        try:
            self._run(task)
        finally:
            task.is_waiting = False
            task.kind = None
            if is_open:
                self._open.remove(task)
        return not task.timed_out

    def wait_until(self, condition: Callable[..., Any], wake_ns: int = NEVER, waits_for: str = '',
                   kind: str = OWED) -> bool:
        """Give the turn away until ``condition()`` holds or ``wake_ns`` [ns] has come; return whether it holds.

        The condition is checked whenever something has happened in this process.
        """
        task = self._tasks[get_ident()]
        while not condition():
            if wake_ns <= self.now_ns:
                return False
            entry = (condition, task)
            self._conditions.append(entry)
            try:
                self.wait(wake_ns, waits_for, kind)
            finally:
                self._conditions.remove(entry)
        return True

    def acts(self) -> bool:
        """Note that the calling thread does something that others may see; return whether it has the turn."""
        ident = get_ident()
        if self.turn_ident != ident and not (self.beside and self.comes_back()) or self.is_closed:
            return False
        task = self._tasks[ident]
        task.looks = task.turns = task.idle_turns = task.is_looking = 0
        return True

    def wait_round(self) -> None:
        """Give the turn away until the time master grants another round, which is asked for at this instant."""
        self._next_round.append(self.current())
        self.wait(kind=None)

    def rest(self) -> None:
        """Give the turn away until no participant has anything left to do at this instant."""
        self._resting.append(self.current())
        self.wait(kind=None)

    @property
    def is_resting(self) -> bool:
        """Whether a thread waits in :meth:`rest`."""
        return bool(self._resting)

    def wake(self, task: Task) -> None:
        """Make a waiting task ready; the caller has the turn."""
        if task.is_waiting:
            task.is_waiting = False
            self._ready.append(task)

    def from_outside(self, action: Callable[[], object]) -> None:
        """Have ``action()`` called by a worker in the next round; any thread may call this."""
        with self._outside_lock:
            self._outside.append(action)
        self._channel.knock()

    @property
    def has_outside(self) -> bool:
        """Whether an action of :meth:`from_outside` is still to be called; any thread may ask."""
        return bool(self._outside)

    @property
    def open_waits(self) -> List[Task]:
        """The tasks that wait without end and have a kind, see :meth:`wait`."""
        return self._open

    def next_ns(self) -> int:
        """Return the earliest instant [ns] at which a thread or the event source wants to go on, or NEVER."""
        return min(self.next_besides_source_ns(), self._source_due_ns())

    def next_besides_source_ns(self) -> int:
        """Return the earliest instant [ns] at which a thread wants to go on, without the event source, or NEVER."""
        if self._next_round:
            return self.now_ns
        sleepers = self._sleepers
        while sleepers and not is_current(sleepers[0]):
            heapq.heappop(sleepers)
        return sleepers[0][0] if sleepers else NEVER

    @property
    def is_source_alone(self) -> bool:
        """Whether nothing but the event source can have something to do by itself, and the source is at rest."""
        return not (self._is_source_busy or self._outside or self._next_round)

    # --- passing the turn -------------------------------------------------------------------------------------------

    def _run(self, task: Task) -> None:
        """Let others go on until the caller's ``task`` is ready and its turn has come."""
        while True:
            if self._mail:
                self._park(task, self._worker())
                return
            other = self._next_ready()
            if other is task:
                return
            if other is not None:
                self._park(task, other)
                return
            if not self._mail:
                self._begin_round()

    def _next_ready(self) -> Optional[Task]:
        """Return the next task that can go on at this instant; None if there is none, or if mail comes first."""
        if self._ready:
            return self._ready.popleft()
        for condition, task in self._conditions:
            if task.is_waiting and holds(condition):
                task.is_waiting = False
                return task
        if self._source_due_ns() <= self.now_ns:
            # A worker runs it: an event may have to wait, and the calling thread may be in the middle of a wait.
            self._mail.append(self._run_source)
            return None
        return self._next_sleeper()

    def _source_due_ns(self) -> int:
        due_ns = None if self._source is None or self._is_source_busy else self._source.next_due_ns()
        return NEVER if due_ns is None else due_ns

    def _run_source(self) -> None:
        self._is_source_busy = True
        try:
            self._source.run(self.now_ns)
        finally:
            self._is_source_busy = False

    def _next_sleeper(self) -> Optional[Task]:
        sleepers = self._sleepers
        while sleepers and (sleepers[0][0] <= self.now_ns or not is_current(sleepers[0])):
            entry = heapq.heappop(sleepers)
            if is_current(entry):
                entry[3].is_waiting = False
                entry[3].timed_out = True
                return entry[3]
        return None

    def _begin_round(self) -> None:
        """Report and take the next grant in, because no thread can go on."""
        if self.is_closed:
            raise TurnLost()
        self._mail.extend(self._channel.exchange())
        ready = [self._next_round, self._resting] if self._channel.is_at_rest else [self._next_round]
        for tasks in ready:
            while tasks:
                self.wake(tasks.popleft())
        if self._outside:
            with self._outside_lock:
                self._mail.extend(self._outside)
                self._outside.clear()
        if self.turn_begins is not None:
            self.turn_begins()

    def _park(self, task: Task, other: Task) -> None:
        """Give the turn to ``other`` and wait for it to come back."""
        if self.is_closed:
            release(other)
            raise TurnLost()  # close() releases each thread once, and may have released this one already
        self.turn_ident = other.ident
        release(other)
        task.parking.acquire()
        if self.is_closed:
            raise TurnLost()
        self._take_turn(task)

    def _worker(self) -> Task:
        """Return a worker that is free."""
        if self._idle_workers:
            return self._idle_workers.pop()
        task = Task('lockstep_worker', is_worker=True)
        thread = threading.Thread(target=self._work, args=(task,), name=task.name, daemon=True)
        self.start_thread(_Thread_start, thread)
        return task

    def start_thread(self, start: Callable[..., Any], thread: threading.Thread) -> None:
        """Call ``start(thread)``. Python itself waits meanwhile, which does not count as a wait of the application."""
        if not self.is_mine():
            start(thread)
            return
        mine, self.turn_ident = self.turn_ident, 0
        try:
            start(thread)
        finally:
            self.turn_ident = mine

    def _resume_worker(self) -> None:
        """Give the turn to a worker for good: the calling thread ends, or leaves the application."""
        worker = self._worker()
        self.turn_ident = worker.ident
        release(worker)

    def _work(self, task: Task) -> None:
        """Run a worker: handle messages while it has the turn, then pass the turn on."""
        task.parking.acquire()
        self._enter(task)
        try:
            while not self.is_closed:
                self._take_turn(task)
                self._work_on(task)
        except TurnLost:
            pass

    def _work_on(self, task: Task) -> None:
        mail = self._mail
        while not self.is_closed:
            while mail:
                self._happened += 1
                task.looks = task.turns = task.idle_turns = task.is_looking = 0
                _handle(mail.popleft())
            other = self._next_ready()
            if other is not None:
                self._idle_workers.append(task)
                self._park(task, other)
                return
            if mail:
                continue
            self._begin_round()

    def abandon(self) -> None:
        """Leave lockstep in a process that was forked, in which no other thread is left."""
        self.is_closed, self.turn_ident = True, 0

    def close(self) -> None:
        """Release all threads: from now on they run freely."""
        self.is_closed, self.turn_ident = True, 0
        for task in list(self._tasks.values()) + self._idle_workers + list(self._ready):
            release(task)


def _handle(action: Callable[[], object]) -> None:
    """Call an action of the mail; an error in it is shown, and the worker goes on with the next action."""
    try:
        action()
    except TurnLost:
        raise
    except BaseException:
        threading.excepthook(threading.ExceptHookArgs((*sys.exc_info(), threading.current_thread())))
