"""The connection of a participant to the program `debug`, over a Unix socket in the run's own folder.

Both sides send lines of JSON, objects with a word under the name ``is``. While a thread of the program stands at a
prompt, it waits here: for the machine, not in the run. So none of it gives a turn away, or counts as the program's.
"""
from __future__ import annotations

import _queue
import contextlib
import fcntl
import json
import os
import socket
import sys
import threading
from typing import Any, Callable, Dict, Iterator, Optional, Sequence

# The words from the participant: there (node, path, pid, is_python, words), stopped (file, line, thread, time_ns),
# prompt, text (text), going, touched (text), refused (text), note (text), left, heard (number: up to which all is here)
# To the participant, with a number: places ([[file, line], ...]), stop, begin after those that are there at the start;
# without one: line (text, None at the end of commands)
_START_S = 20.0  # wall
_NUMBER = 400  # the descriptor's number is not one of those that the program's own files get
_BYTES = 1 << 16


class Link:
    """The participant's end. Any thread may send."""

    def __init__(self, path: str) -> None:
        """:raises OSError: if nobody listens there."""
        self._socket = _connected(path)
        self._rest = b''
        self._lock = threading._allocate_lock()  # type: ignore[attr-defined]
        self._lines: Any = _queue.SimpleQueue()
        self.is_open = True
        os.register_at_fork(after_in_child=self._forget)

    def follow(self, handle: Callable[[Dict[str, Any]], None]) -> None:
        """Hand all that comes from now on, but lines for a prompt, to ``handle``, in a thread of its own."""
        threading.Thread.start(threading.Thread(target=self._listen, args=(handle,), daemon=True,
                                                name='lockstep_debugger'))

    def _listen(self, handle: Callable[[Dict[str, Any]], None]) -> None:
        for message in self.messages():
            if message.get('is') == 'line':
                self._lines.put(message.get('text'))
            else:
                handle(message)
        self.is_open = False
        self._lines.put(None)
        handle({'is': 'left'})

    def messages(self) -> Iterator[Dict[str, Any]]:
        """Yield what comes, until the other end is closed."""
        while True:
            line, is_whole, rest = self._rest.partition(b'\n')
            if is_whole:
                self._rest = rest
                yield json.loads(line)
                continue
            try:
                more = self._socket.recv(_BYTES)
            except OSError:
                more = b''
            if not more:
                return
            self._rest += more

    def send(self, word: str, **values: Any) -> None:
        """Send a message; do nothing if the other end is closed."""
        line = json.dumps({'is': word, **values}).encode() + b'\n'
        with self._lock:
            if self.is_open:
                with contextlib.suppress(OSError):
                    self._socket.sendall(line)

    def _forget(self) -> None:
        self.is_open = False
        sys.settrace(None)
        self._socket.close()

    # --- what pdb takes for its terminal ----------------------------------------------------------------------------

    def write(self, text: str) -> int:
        """Show a text."""
        self.send('text', text=text)
        return len(text)

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def readline(self) -> str:
        """Return the next line for the prompt; '' if there is none any more."""
        if not self.is_open:
            return ''
        self.send('prompt')
        text: Optional[str] = self._lines.get()
        return '' if text is None else text.rstrip('\n') + '\n'


def tell_of_binary(path: str, name: str, program: str, words: Sequence[str]) -> None:
    """Tell the program `debug` of a binary that this process is about to become, so that gdb finds it."""
    with contextlib.suppress(OSError):
        Link(path).send('there', node=name, path=os.path.realpath(program), pid=os.getpid(), is_python=False,
                        words=list(words))


def _connected(path: str) -> socket.socket:
    first = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    first.settimeout(_START_S)
    first.connect(path)
    first.settimeout(None)
    try:
        number = fcntl.fcntl(first.fileno(), fcntl.F_DUPFD_CLOEXEC, _NUMBER)
    except OSError:  # the limit is lower
        return first
    first.close()
    return socket.socket(fileno=number)
