"""pdb for a program that takes part: its prompt is a link, it knows threads that take turns, and hides our own frames.

Only threads that reach a breakpoint, or that somebody steps through, are traced, and of their functions only those with
a breakpoint. The rest of the program runs as it always does.
"""
from __future__ import annotations

import contextlib
import dis
import os
import pdb
import sys
import threading
import types
from collections import deque
from functools import lru_cache
from threading import get_ident
from typing import Any, Callable, Deque, Dict, Iterator, List, Optional, Sequence, Tuple

from move_base_abstract.lockstep import stable_hash
from move_base_abstract.lockstep.evaluated import may_change
from move_base_abstract.lockstep.instrument import LOOK

from ..code.own_code import OWN, is_library
from .link import Link

Place = Tuple[str, int]
_LAUNCHER = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), 'program.py')
_EVALUATING = ('p', 'pp', 'display', 'whatis', 'source')
_WITH_CONDITION = {'b': ',', 'break': ',', 'tbreak': ',', 'condition': ' '}  # what comes before it
_NOT_HERE = 'not in a run: its processes have no terminal. Statements are run as they are typed, after a !'
_COPIES_LOCALS = sys.version_info < (3, 13)  # a frame that was looked at keeps what its variables had then


class NodeDebugger(pdb.Pdb):
    """The debugger of this process.

    ``looks(is_there)`` is called when somebody begins and ends to look, ``describe()`` returns what is told of a stop.
    """

    def __init__(self, link: Link, looks: Callable[[bool], None], describe: Callable[[], Dict[str, Any]]) -> None:
        self._link, self._looks, self._describe = link, looks, describe
        self._news: Deque[Callable[[], None]] = deque()  # of the link's thread; a thread with the turn takes them in
        self._places: List[Place] = []
        self._bound: Dict[str, List[int]] = {}  # {real path: lines of places that were set there}
        self._is_line_wanted = False  # the next line of the program's own code is a stop
        self._thread = 0  # the one that is stepped through
        self._shows_all, self._is_touched = False, False
        self._followed: Dict[int, Tuple[types.CodeType, bool]] = {}
        self._version, self._of_thread = 0, threading.local()
        self._alone = threading._allocate_lock()  # type: ignore[attr-defined]
        with _without_readline():
            super().__init__(stdin=link, stdout=link, nosigint=True, readrc=False)  # type: ignore[arg-type]
        self.botframe: Any = sys._getframe()  # stands for none: a step would stop everywhere
        self._go()

    # --- what others ask for ----------------------------------------------------------------------------------------

    def soon(self, action: Callable[[], None]) -> None:
        """Have ``action()`` called when a thread gets the turn next, or goes on from a prompt. For any thread."""
        self._news.append(action)

    def set_places(self, places: Sequence[Place]) -> None:
        """Have these breakpoints, (end of a path, line), and no others. Threads get them with their next turns."""
        if list(places) == self._places:
            return
        self._places = list(places)
        self._bound.clear()
        self.clear_all_breaks()
        self._changed()

    def stop_at_next_line(self) -> None:
        """Stop at the next line of the program's own code, in any of its threads."""
        self._is_line_wanted = True
        self._changed()

    def detach(self) -> None:
        """Stop nowhere any more."""
        self._is_line_wanted = False
        self._places = []
        self.clear_all_breaks()
        self._changed()
        self._go()

    def turn_begins(self) -> None:
        """Trace the calling thread as it is wanted now; it has just been given the turn."""
        self._take_news()
        if getattr(self._of_thread, 'version', 0) != self._version:
            self.trace_thread(sys._getframe(1))

    def _take_news(self) -> None:
        while self._news:
            self._news.popleft()()

    def trace_thread(self, frame: Any) -> None:
        """Trace the calling thread, from ``frame`` outwards, if there is anything to stop at."""
        self._of_thread.version = self._version
        is_traced = self.is_wanted
        while frame is not None:
            is_followed = is_traced and self._is_followed(frame)
            if is_followed or frame.f_trace is not None:
                frame.f_trace = self.trace_dispatch if is_followed else None
            frame = frame.f_back
        sys.settrace(self.trace_dispatch if is_traced else None)

    def _changed(self) -> None:
        self._followed.clear()
        self._version += 1

    # --- which lines are stops --------------------------------------------------------------------------------------

    @property
    def is_wanted(self) -> bool:
        """Whether there is anything to stop at."""
        return bool(self._places or self.breaks or self._is_line_wanted or self._is_stepping)

    @property
    def _is_stepping(self) -> bool:
        return self.stopframe is not self.botframe

    def trace_dispatch(self, frame: Any, event: str, arg: Any) -> Any:
        """Be the trace function of frames that are followed; of others none."""
        if event == 'call' and not self._is_followed(frame):
            return None
        if event == 'call' and self._is_line_wanted or event == 'line' and LOOK in frame.f_code.co_names and (
                frame.f_lasti in _lines_of_looks(frame.f_code)):
            return self.trace_dispatch
        return super().trace_dispatch(frame, event, arg)

    def _is_followed(self, frame: Any) -> bool:
        if self._is_line_wanted and _is_own(frame):
            return True
        if self._is_stepping and self._thread == get_ident() and (
                frame is self.stopframe or frame is self.returnframe or self.stopframe is None and _is_open(frame)):
            return True
        return self.break_anywhere(frame)

    def break_anywhere(self, frame: Any) -> bool:
        """Return whether there is a breakpoint in the code of a frame."""
        code = frame.f_code
        known = self._followed.get(id(code))
        if known is None:
            known = self._followed[id(code)] = code, self._has_place(code)
        return known[1]

    def _has_place(self, code: types.CodeType) -> bool:
        path = self.canonic(code.co_filename)
        if path not in self._bound:
            self._bound[path] = [line for end, line in self._places if path == end or path.endswith(os.sep + end)]
            for line in self._bound[path]:
                refused = self.set_break(path, line)
                self._link.send('note', text=refused or '{}:{} is there'.format(path, line))
        lines = self.breaks.get(path) or []
        return bool(lines) and (code.co_firstlineno in lines or any(
            line in lines for _offset, line in dis.findlinestarts(code)))

    def canonic(self, filename: str) -> str:
        """Return a file's real path: a relay script of a devel space compiles the real file by another one."""
        return filename if filename.startswith('<') else _real_path(filename)

    def break_here(self, frame: Any) -> bool:
        """Return whether there is a breakpoint, whose condition holds, at the line of a frame."""
        with stable_hash.only_looked_at():
            return bool(super().break_here(frame))

    def stop_here(self, frame: Any) -> bool:
        """Return whether a step ends in a frame: steps are in one thread, and do not enter what is ours."""
        if self._is_line_wanted:
            return _is_own(frame)
        return self._thread == get_ident() and _is_open(frame) and bool(super().stop_here(frame))

    def _go(self) -> None:
        self._set_stopinfo(self.botframe, None, -1)  # type: ignore[attr-defined]

    def set_continue(self) -> None:
        """Go on to the next breakpoint. Other threads may have some, so this one is traced on."""
        self._go()

    # --- the prompt -------------------------------------------------------------------------------------------------

    def interaction(self, frame: Any, *trace: Any) -> None:
        """Show where the program stands, and do what is typed, until it goes on."""
        with self._alone:
            self._is_line_wanted, self._thread = False, get_ident()
            self._looks(True)
            self._link.send('stopped', file=self.canonic(frame.f_code.co_filename), line=frame.f_lineno,
                            function=frame.f_code.co_name, thread=threading.current_thread().name, **self._describe())
            try:
                super().interaction(frame, *trace)
            finally:
                if self.frame_returning is frame is self.stopframe:
                    self._set_stopinfo(None, None)  # type: ignore[attr-defined]
                _forget_locals(frame)
                self._take_news()
                self._changed()
                self.trace_thread(frame)
                frame.f_trace = self.trace_dispatch if sys.gettrace() else None
                self._link.send('going')
                self._looks(False)

    def get_stack(self, f: Any, t: Any) -> Any:
        """Return the frames of the program, without ours, unless all are asked for."""
        stack, at = super().get_stack(f, t)
        here = stack[at] if stack else None
        if not self._shows_all:
            files = [one[0].f_code.co_filename for one in stack]
            first = max((number + 1 for number, file in enumerate(files) if file == _LAUNCHER), default=0)
            stack = [one for one in stack[first:] if one is here or not _is_ours(one[0])]
            while stack[0] is not here and stack[0][0].f_code.co_filename == threading.__file__:
                del stack[0]  # Python's start of a thread
        return stack, stack.index(here) if here in stack else at

    def do_frames(self, arg: str) -> None:
        """Show all frames of the stack (frames all), also those of lockstep, or only the program's (frames own)."""
        if arg not in ('all', 'own'):
            self.message('frames: got {!r}; allowed: all, own'.format(arg))
            return
        self._shows_all = arg == 'all'
        frame = self.curframe
        self.stack, self.curindex = self.get_stack(self.stack[-1][0], None)
        at = [number for number, one in enumerate(self.stack) if one[0] is frame]
        self.curindex = at[0] if at else self.curindex
        self.curframe = self.stack[self.curindex][0]

    def onecmd(self, line: str) -> Any:
        """Do a command. What only looks gives no numbers to objects; anything else marks the run."""
        command, argument, line = self.parseline(line)
        argument = argument or ''
        text = line if command is None or command == '' or not hasattr(self, 'do_' + command) else (
            argument if command in _EVALUATING else '')
        if line and line.startswith('!'):
            text = line[1:]
        if command in _WITH_CONDITION:
            text = argument.partition(_WITH_CONDITION[command])[2]
        changes = command in ('jump', 'j') or bool(text) and may_change(text)
        if changes and not self._is_touched:
            self._is_touched = True
            self._link.send('touched', text='{!r} was typed at a prompt: from here on the run may be another '
                            'one'.format(line.strip()))
        if changes:
            return super().onecmd(line)
        with stable_hash.only_looked_at():
            return super().onecmd(line)

    def do_clear(self, arg: str) -> Any:
        """Take breakpoints away (FILE:LINE, or numbers); without a name all of this node, without asking."""
        if arg:
            return super().do_clear(arg)
        self.clear_all_breaks()
        return None

    do_cl = do_clear

    def do_quit(self, _arg: str) -> bool:
        """Leave this prompt, and stop nowhere in this node any more. The program goes on."""
        self.detach()
        self._link.send('left')
        return True

    do_q = do_exit = do_quit  # type: ignore[assignment]

    def do_EOF(self, arg: str) -> bool:  # noqa: N802 - cmd's name
        """Handle the end of the commands as quit."""
        return self.do_quit(arg)

    def _refuse(self, _arg: str) -> None:
        self.error(_NOT_HERE)

    do_run = do_restart = do_debug = do_interact = _refuse  # type: ignore[assignment]


@contextlib.contextmanager
def _without_readline() -> Iterator[None]:
    """Import no readline inside: it would prepare a terminal of the program's."""
    is_there = 'readline' in sys.modules
    if not is_there:
        sys.modules['readline'] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        if not is_there:
            del sys.modules['readline']


@lru_cache(maxsize=None)
def _real_path(filename: str) -> str:
    return os.path.realpath(filename)


@lru_cache(maxsize=4096)
def _lines_of_looks(code: types.CodeType) -> Tuple[int, ...]:
    """Return the places in a code at which a line begins that is only an added call of a loop: no line of the file."""
    found, begin = [], None
    for step in dis.get_instructions(code):
        begin = step.offset if begin is None else begin
        if step.argval == LOOK:
            found.append(begin)
        begin = begin if step.opname in ('PUSH_NULL', 'EXTENDED_ARG') else None
    return tuple(found)


def _is_ours(frame: Any) -> bool:
    return bool(frame.f_code.co_filename.startswith((*OWN, '<frozen')))


def _is_own(frame: Any) -> bool:
    """Return whether a frame is of a file of the program's own, and not of a text that a library has compiled."""
    filename = frame.f_code.co_filename
    return not (filename.startswith('<') or is_library(filename))


def _is_open(frame: Optional[Any]) -> bool:
    """Return whether a step may enter a frame: one of the program, or one of a library that it has called itself."""
    while frame is not None:
        if _is_own(frame):
            return True
        if _is_ours(frame):
            return False
        frame = frame.f_back
    return False


def _forget_locals(frame: Any) -> None:
    """Let frames that were looked at, and wait, keep nothing alive by that."""
    outer = frame.f_back if _COPIES_LOCALS else None
    while outer is not None:
        if outer.f_code.co_flags & 1 and outer.f_trace is None:  # CO_OPTIMIZED: a copy
            outer.f_locals.clear()
        outer = outer.f_back
