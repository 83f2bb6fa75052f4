"""Report a log file that cannot be written once, in a line, instead of by a traceback for each message."""
from __future__ import annotations

import sys
from typing import Any, Set

from move_base_abstract.common.shown import shown_text

from .replaced import replace

_told: Set[int] = set()


def survive_full_disk() -> None:
    """Make each log handler of the process report only its first error. Call this before rospy.init_node."""
    replace('logging.Handler.handleError', lambda _original: _handle_error)


def _handle_error(handler: Any, _record: Any) -> None:
    """Take the place of logging's own function, which prints a traceback. It is called inside an ``except``."""
    error = sys.exc_info()[1]
    if id(handler) in _told:
        return
    _told.add(id(handler))
    name = getattr(handler, 'baseFilename', None) or type(handler).__name__
    try:
        print('the log {} cannot be written: {}; the node goes on without it'.format(
            shown_text(name), getattr(error, 'strerror', None) or shown_text(str(error))), file=sys.stderr, flush=True)
    except OSError:
        pass  # the standard error output cannot be written either
