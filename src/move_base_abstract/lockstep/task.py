"""A thread of a participant, as the scheduler sees it."""
import threading

# The machine's own locks: those that the application gets are made of waits in the scheduler.
_make_lock = threading._allocate_lock


class Task:
    """What one thread waits for, and how it is let go."""

    __slots__ = ('name', 'ident', 'parking', 'is_waiting', 'wake_token', 'timed_out', 'waits_for', 'is_open',
                 'is_finished', 'is_worker', 'looks')

    def __init__(self, name, is_worker=False):
        self.name = name
        self.ident = 0
        self.parking = _make_lock()
        self.parking.acquire()
        self.is_waiting = False
        self.wake_token = 0
        self.timed_out = False
        self.waits_for = ''
        self.is_open = False
        self.is_finished = False
        self.is_worker = is_worker
        self.looks = 0
