"""The commands of the prompt that look into a node: pdb and breakpoints, gdb."""
from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, Optional, Sequence, Tuple

from move_base_abstract.common.shown import shown

from .node_sessions import News, Node, Place
from .stop_words import absolute
from .stops import Refused

if TYPE_CHECKING:
    from .session import Session

_ATTACHED_S, _LOOK_S = 60.0, 0.05  # wall
_NOTE = 'gdb_is_there'
_SCOPE = '/proc/sys/kernel/yama/ptrace_scope'


class NodeCommands:
    """A part of the prompt, which has ``session``, ``tell`` (an answer) and ``read_line`` (what is typed next)."""

    session: Session
    tell: Callable[[Sequence[str], Dict[str, Any]], None]
    read_line: Callable[[str], Optional[str]]

    @property
    def is_interactive(self) -> bool:
        """Whether somebody types the commands."""
        raise NotImplementedError

    def do_break(self, words: str) -> None:
        """`break [FILE:LINE [NODE]]`: stop in pdb when a Python node comes to this line; alone: list the breakpoints.

        FILE is a path, or its end (planner.py, my_package/planner.py). Without NODE all nodes stop there.
        """
        nodes = self.session.run.nodes
        if words.strip():
            place = _place(words)
            if place not in nodes.places:
                nodes.set_places([*nodes.places, place])
        self._tell_places()

    def do_clear(self, words: str) -> None:
        """`clear [FILE:LINE [NODE]]`: take a breakpoint away; alone: take all away."""
        nodes = self.session.run.nodes
        wanted = [_place(words)] if words.strip() else list(nodes.places)
        for place in wanted:
            if place not in nodes.places:
                raise Refused('there is no breakpoint {}; break lists them'.format(_words_of(place)))
        nodes.set_places([one for one in nodes.places if one not in wanted])
        self._tell_places()

    def _tell_places(self) -> None:
        places = self.session.run.nodes.places
        self.tell([_words_of(place) for place in places] or ['there are no breakpoints'],
                  {'breakpoints': [list(place) for place in places]})

    def do_pdb(self, words: str) -> None:
        """`pdb NODE`: stop in pdb at the next line of a Python node's own code, when the run goes on.

        In pdb, `continue` lets the run go on, `quit` takes pdb out of the node, `frames all` shows lockstep's own
        frames, too. What is typed may change the run: then back throws it away.
        """
        name = self._node(words, 'pdb', is_python=True)
        self.session.run.nodes.stop_in(name)
        self.tell(['{} stops at the next line of its program, when the run goes on'.format(name)], {'node': name})

    def do_gdb(self, words: str) -> None:
        """`gdb NODE`: attach gdb to a C++ node. The run goes on as gdb lets the node go on, and stops when gdb ends."""
        name = self._node(words, 'gdb', is_python=False)
        _check_gdb()
        run, node = self.session.run, self.session.run.nodes.nodes[name]
        run.touched = 'gdb was in {}'.format(name)
        note = os.path.join(run.folder, _NOTE)
        gdb = subprocess.Popen(
            ['gdb', '-q', '-p', str(node.pid), '-ex', 'handle SIGSTOP nostop noprint', '-ex', 'shell : > ' + note],
            stdin=None if self.is_interactive else subprocess.PIPE, stdout=None if self.is_interactive else 2,
            text=True)
        try:
            with _for_gdb():
                _await_note(gdb, note)
                run.looks(name, True)
                self._type_for(gdb)
                run.go_while(lambda: gdb.poll() is None)
        finally:
            gdb.wait()
            with suppress(Refused):  # the run is over
                run.looks(name, False)
        self.tell(['gdb has ended (exit code {})'.format(gdb.returncode)], {'node': name, 'code': gdb.returncode})

    def _type_for(self, gdb: subprocess.Popen[str]) -> None:
        """Hand lines of a file or pipe to gdb, up to its quit."""
        while gdb.stdin is not None:
            line = self.read_line('')
            gdb.stdin.write('quit\n' if line is None else line.strip() + '\n')
            if line is None or line.strip() == 'quit':
                gdb.stdin.close()
                return

    # --- what nodes tell --------------------------------------------------------------------------------------------

    def meet(self, news: Sequence[News]) -> None:
        """Show what nodes have told; talk with those that stand at a prompt, until they go on."""
        for one in news:
            if one.kind == 'touched':
                self.session.run.touched = one.text
            if one.kind != 'gone':
                self.tell([one.text], {'node': one.node, one.kind: one.text})
            if one.kind == 'stopped':
                self._talk(one.node)

    def _talk(self, node: str) -> None:
        def show(text: str) -> None:
            if text:
                self.tell(text.splitlines(), {'node': node, 'text': text})
        self.session.run.nodes.talk(node, self.read_line, show)

    # --- names ------------------------------------------------------------------------------------------------------

    def _node(self, words: str, command: str, is_python: bool) -> str:
        """Return the name of a node of this kind. :raises Refused: if there is none, or it is of another kind."""
        known = self.session.run.nodes.nodes
        name = absolute(words)
        allowed = sorted(one for one, node in known.items() if node.is_python == is_python)
        if name in allowed:
            _refuse_nodelet(name, known[name])
            return name
        if name in known:
            raise Refused('{} is a {}; use {}'.format(name, *(
                ('C++ program', 'gdb') if is_python else ('Python program', 'pdb or break'))))
        raise Refused('{} takes the name of a node that runs, and is of an unmodified {} program; got {}; allowed: {}'
                      .format(command, 'Python' if is_python else 'C++', shown(words), ', '.join(allowed) or 'none'))


def _place(words: str) -> Place:
    """Return the breakpoint FILE:LINE [NODE]. :raises Refused: if it is none, or its file is not there."""
    parts = words.split()
    file, _, line = parts[0].rpartition(':')
    if not 1 <= len(parts) <= 2 or not file or not line.isdecimal() or int(line) < 1:
        raise Refused('a breakpoint is FILE:LINE [NODE], such as planner.py:120 /planner; got {}'.format(shown(words)))
    path = os.path.realpath(file) if os.path.isabs(file) or os.path.isfile(file) else ''
    if path and not os.path.isfile(path):
        raise Refused('there is no file {}'.format(shown(path)))
    return path or os.path.normpath(file), int(line), absolute(parts[1]) if len(parts) == 2 else ''


def _words_of(place: Tuple[str, int, str]) -> str:
    return '{}:{} {}'.format(place[0], place[1], place[2] or 'in all nodes')


def _refuse_nodelet(name: str, node: Node) -> None:
    if os.path.basename(node.path) == 'nodelet' and node.words[:1] == ['load']:
        raise Refused('{} only loads a nodelet, whose code runs in its manager: gdb {}'.format(
            name, ' '.join(node.words[2:3]) or 'MANAGER'))


def _check_gdb() -> None:
    if shutil.which('gdb') is None:
        raise Refused('gdb is not here; it is of the package gdb (apt-get install gdb)')
    try:
        with open(_SCOPE) as stream:
            scope = int(stream.read())
    except (OSError, ValueError):
        return
    if scope > 1 and os.geteuid():
        raise Refused('this computer lets only root attach to processes ({} is {}; allowed: 0, 1): '
                      'sudo sysctl kernel.yama.ptrace_scope=1'.format(_SCOPE, scope))


@contextmanager
def _for_gdb() -> Iterator[None]:
    """Leave Ctrl-C to gdb inside, which has the terminal."""
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _await_note(gdb: subprocess.Popen[str], note: str) -> None:
    """Wait until gdb has stopped the node. :raises Refused: if it cannot."""
    deadline = time.monotonic() + _ATTACHED_S
    while not os.path.exists(note):
        if gdb.poll() is not None or time.monotonic() > deadline:
            gdb.kill()
            raise Refused('gdb has not attached. In a container the process needs the capability SYS_PTRACE: '
                          'docker run --cap-add=SYS_PTRACE')
        time.sleep(_LOOK_S)
    os.unlink(note)
