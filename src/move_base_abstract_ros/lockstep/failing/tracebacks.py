"""Tracebacks of a program do not show the frames of lockstep, unless the environment asks for all."""
from __future__ import annotations

import os
import traceback  # noqa: F401 - replaced by name
import types
from typing import Any, Callable, Optional, Set

import move_base_abstract.lockstep

from ...replacing.replaced import replace

#: the environment variable, and its value, with which all frames are shown
VARIABLE, ALL = 'MOVE_BASE_ABSTRACT_TRACEBACKS', 'all'
_FOLDER = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_OURS = (_FOLDER + os.sep, os.path.dirname(move_base_abstract.lockstep.__file__) + os.sep, '<frozen runpy')
_RUNPY = 'runpy.py'


def install() -> None:
    """Leave our frames out of the texts that Python's library makes of exceptions, from now on."""
    replace('traceback.TracebackException.__init__', _formatting)


def _formatting(init: Callable[..., None]) -> Callable[..., None]:
    def init_without_ours(self: Any, exc_type: Any, exc_value: Any, exc_traceback: Any, **kwds: Any) -> None:
        init(self, exc_type, exc_value, without_ours(exc_traceback), **kwds)
    return init_without_ours


def without_ours(trace: Optional[types.TracebackType]) -> Optional[types.TracebackType]:
    """Return a traceback without our frames; the same one if there are no others, or if all are asked for."""
    kept, at = [], trace
    while at is not None:
        filename = at.tb_frame.f_code.co_filename
        if not filename.startswith(_OURS) and os.path.basename(filename) != _RUNPY:
            kept.append(at)
        at = at.tb_next
    if os.environ.get(VARIABLE) == ALL or not kept:
        return trace
    found = None
    for one in reversed(kept):
        found = types.TracebackType(found, one.tb_frame, one.tb_lasti, one.tb_lineno)
    return found


def hide_ours(error: Optional[BaseException], seen: Optional[Set[int]] = None) -> None:
    """Take our frames out of an exception, and of those that have led to it, before Python itself shows it."""
    seen = set() if seen is None else seen
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        error.__traceback__ = without_ours(error.__traceback__)
        hide_ours(error.__cause__, seen)
        error = error.__context__
