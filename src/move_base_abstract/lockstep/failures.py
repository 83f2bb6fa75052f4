"""How the event log says what went wrong in a program, for who writes it and for who judges a run by it."""
from __future__ import annotations

import re

UNCAUGHT = 'uncaught'  # kind of the events of exceptions that nobody catches
UNASKED, ASKED = 'unasked', 'asked'  # of those that wait for somebody who asks for a job's outcome, and has asked
_NUMBERED = re.compile(r'(Thread|Dummy)-[0-9]+')


def words_of(thread: object) -> str:
    """Return a thread in words: by its name, unless Python has numbered it, which another run may do otherwise."""
    name = getattr(thread, 'name', '')
    return 'thread {}'.format(name) if name and not _NUMBERED.match(name) else 'a thread'
