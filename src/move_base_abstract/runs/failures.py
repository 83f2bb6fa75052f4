"""The kinds of events for uncaught exceptions of a program, both for writing the event log and for judging a run."""
from __future__ import annotations

import re

UNCAUGHT = 'uncaught'  # the kind of events of uncaught exceptions
# A job has ended with an exception, and nobody has asked for its outcome yet (UNASKED), or somebody has (ASKED).
UNASKED, ASKED = 'unasked', 'asked'
#: what is said of an exception that may come of a subscription of the same instant
FIRST_USE = 'it {} to listen to {} at this instant, and messages take no time; with --lookahead 0.05 they do'
_NUMBERED = re.compile(r'(Thread|Dummy)-[0-9]+')


def words_of(thread: object) -> str:
    """Return a thread in words: with its name, unless Python has numbered it, which may differ from run to run."""
    name = getattr(thread, 'name', '')
    return 'thread {}'.format(name) if name and not _NUMBERED.match(name) else 'a thread'
