"""The nodes of a debugged run as `debug` sees them: each connects when it starts, gets breakpoints, and talks of stops.

A thread of its own answers, so that a node never waits for `debug`, whatever that waits for.
"""
from __future__ import annotations

import contextlib
import json
import os
import queue
import socket
import threading
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from move_base_abstract.common.units import exact_seconds

from ..lockstep.debugging import VARIABLE

#: (file, line, name of a node or '' for all); file: a path, or its end
Place = Tuple[str, int, str]
_NAME = 'nodes'
#: words of a node that are news for the user, beside the text of a stop
_TOLD = ('touched', 'refused', 'note')
_BELL = b'.'
_HEARD_S = 10.0  # wall
_ALL = 2 ** 53


class News(NamedTuple):
    """What a node has told: ``kind`` is 'stopped', 'touched', 'refused', 'note' or 'gone'; ``text`` is for the user."""

    node: str
    kind: str
    text: str


class Node:
    """A participant's process: its node's name ('' if it is not known yet), the path of its program, its process id."""

    def __init__(self, connection: socket.socket) -> None:
        self.name, self.path, self.pid, self.is_python = '', '', 0, True
        self.words: List[str] = []  # arguments of its program
        self.places: List[Any] = []  # that it has been sent
        self.has_left = False  # somebody has quit pdb in it
        self.talk: Any = queue.Queue()
        self._connection = connection
        self._lock = threading.Lock()
        self._sent, self._heard = 0, 0  # numbers of messages
        self._news = threading.Condition()

    def send(self, word: str, **values: Any) -> None:
        """Send a message; do nothing if the process has ended."""
        with self._lock, contextlib.suppress(OSError):
            self._sent += word != 'line'  # which has an answer of its own
            self._connection.sendall(json.dumps({'is': word, 'number': self._sent, **values}).encode() + b'\n')

    def heard(self, number: int) -> None:
        """Note that the process has got the messages up to this one."""
        with self._news:
            self._heard = number
            self._news.notify_all()

    def await_heard(self) -> None:
        """Wait until the process has got all messages, so that they count when it gets the turn next."""
        with self._news:
            self._news.wait_for(lambda: self._heard >= self._sent, _HEARD_S)

    def messages(self) -> Iterator[Dict[str, Any]]:
        """Yield what it sends, until it ends."""
        with contextlib.suppress(OSError), self._connection.makefile('rb') as stream:
            for line in stream:
                yield json.loads(line)

    def close(self) -> None:
        """Let it go on without a debugger."""
        with contextlib.suppress(OSError):
            self._connection.shutdown(socket.SHUT_RDWR)


class NodeSessions:
    """The debugged nodes of one run. ``folder``: the run's own, which only this user reads; ``places``: breakpoints."""

    def __init__(self, folder: str, places: Sequence[Place] = ()) -> None:
        self.places = list(places)
        self._awaited: List[str] = []  # names of nodes that stop at their first line when they start
        self._path = os.path.join(folder, _NAME)
        self._nodes: List[Node] = []
        self._news: Any = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._reading, self._writing = os.pipe()
        for end in (self._reading, self._writing):
            os.set_blocking(end, False)
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(self._path)
        self._listener.listen(socket.SOMAXCONN)
        threading.Thread(target=self._accept, name='debugged_nodes', daemon=True).start()

    @property
    def environment(self) -> Dict[str, str]:
        """The environment variables that the run needs."""
        return {VARIABLE: self._path}

    def fileno(self) -> int:
        """Return a descriptor that is readable when there is news."""
        return self._reading

    def news(self) -> List[News]:
        """Return what nodes have told since the last call."""
        with contextlib.suppress(BlockingIOError):
            os.read(self._reading, 4096)
        found = []
        with contextlib.suppress(queue.Empty):
            while True:
                found.append(self._news.get_nowait())
        return found

    @property
    def nodes(self) -> Dict[str, Node]:
        """The processes of all nodes whose names are known."""
        with self._lock:
            return {node.name: node for node in self._nodes if node.name}

    # --- breakpoints ------------------------------------------------------------------------------------------------

    def set_places(self, places: Sequence[Place]) -> None:
        """Have these breakpoints. Nodes get them with their next turns, others when they start."""
        with self._lock:
            self.places = list(places)
            told = [node for node in self._nodes if self._send_places(node)]
        for node in told:
            node.await_heard()

    def stop_in(self, name: str) -> None:
        """Have a node stop at the next line of its own code; if it is not there yet, at its first one."""
        node = self.nodes.get(name)
        if node is None:
            self._awaited.append(name)
            return
        with self._lock:
            node.has_left, node.places = False, []
            self._send_places(node)
            node.send('stop')
        node.await_heard()

    def _send_places(self, node: Node) -> bool:
        places = [[file, line] for file, line, of in self.places if of in ('', node.name)]
        if places == node.places or node.has_left or not node.is_python:
            return False
        node.places = places
        node.send('places', places=places)
        return True

    def talk(self, name: str, read_line: Callable[[str], Optional[str]], write: Callable[[str], object]) -> None:
        """Forward the prompt of a node that has stopped, until it goes on.

        ``read_line(prompt)`` returns a line, or None if no more will come; ``write(text)`` shows whole lines.
        """
        node, said = self.nodes.get(name), ''
        while node is not None:
            message = node.talk.get()
            word = message['is']
            if word == 'text':
                lines, is_line, said = (said + message['text']).rpartition('\n')
                write(lines + is_line)
            elif word == 'prompt':
                node.send('line', text=read_line(said))
                said = ''
            elif word in ('going', 'gone'):
                write(said)
                return

    def close(self) -> None:
        """Let all nodes go on without a debugger, and take no more."""
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        with self._lock:
            for node in self._nodes:
                node.close()
        with contextlib.suppress(OSError):
            os.unlink(self._path)

    # --- the thread that answers ------------------------------------------------------------------------------------

    def _accept(self) -> None:
        while True:
            try:
                connection, _address = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._listen, args=(Node(connection),), name='debugged_node', daemon=True).start()

    def _listen(self, node: Node) -> None:
        for message in node.messages():
            word = message['is']
            if word == 'there':
                self._there(node, message)
            elif word in _TOLD:
                self._tell(node, word, message['text'])
            elif word == 'left':
                node.has_left = True
            elif word == 'heard':
                node.heard(message['number'])
            else:
                if word == 'stopped':
                    self._tell(node, word, '{} stands at {}:{} in {}, at {} s'.format(
                        node.name or node.path, message['file'], message['line'], message['thread'],
                        exact_seconds(message['time_ns'])))
                node.talk.put(message)
        node.heard(_ALL)
        if not node.is_python:
            return  # it has become another program, which does not listen
        with self._lock:
            if node in self._nodes:
                self._nodes.remove(node)
        node.talk.put({'is': 'gone'})
        self._tell(node, 'gone', '{} has ended'.format(node.name or node.path))

    def _there(self, node: Node, message: Dict[str, Any]) -> None:
        with self._lock:
            node.name, node.path, node.pid = message['node'], message['path'], message['pid']
            node.is_python, node.words = message['is_python'], message['words']
            self._send_places(node)
            if node.name in self._awaited:
                self._awaited.remove(node.name)
                node.send('stop')
            if node not in self._nodes:
                self._nodes.append(node)
                node.send('begin')

    def _tell(self, node: Node, kind: str, text: str) -> None:
        self._news.put(News(node.name, kind, text))
        with contextlib.suppress(BlockingIOError):  # it is readable already
            os.write(self._writing, _BELL)
