"""How a participant lets itself be debugged, if the run's environment names the socket of the program `debug`."""
from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any, Dict, Optional

from move_base_abstract.lockstep import wire

from .link import Link
from .node_debugger import NodeDebugger

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

_MEASURES = '{} charges the time that it measures (lockstep_charge: measured), and a breakpoint makes it slower: it ' \
            'is not debugged; allowed: none, fixed:SECONDS, replay:FILE'


class Attached:
    """The debugger of this process, between the program and the link."""

    def __init__(self, link: Link, name: str, path: str) -> None:
        self._link, self._name, self._path = link, name, path
        self._participant: Optional[Participant] = None
        self._is_refused = False
        self.debugger = NodeDebugger(link, self._looks, self._describe)
        self._tell_there()
        for message in link.messages():  # what is wanted from the first line on
            if message.get('is') == 'begin':
                break
            self._handle(message)
        link.follow(self._hear)

    def follow(self, participant: Optional[Participant]) -> None:
        """Follow the threads of a program that takes part from now on."""
        if participant is None:
            return
        self._participant, self._name = participant, participant.members.own_name
        self._tell_there()
        if not participant.charge.is_repeatable:
            self._is_refused = True
            if self.debugger.is_wanted:
                self._handle({'is': 'places'})
        participant.scheduler.turn_begins = self.debugger.turn_begins

    def _tell_there(self) -> None:
        self._link.send('there', node=self._name, path=os.path.realpath(self._path), pid=os.getpid(), is_python=True,
                        words=[])

    def _hear(self, message: Dict[str, Any]) -> None:
        self.debugger.soon(lambda: self._handle(message))
        self._link.send('heard', number=message.get('number', 0))

    def _handle(self, message: Dict[str, Any]) -> None:
        word = message.get('is')
        if word == 'left' or self._is_refused:
            self.debugger.detach()
            if word != 'left':
                self._link.send('refused', text=_MEASURES.format(self._name))
        elif word == 'places':
            self.debugger.set_places([(str(file), int(line)) for file, line in message['places']])
        elif word == 'stop':
            self.debugger.stop_at_next_line()

    def _looks(self, is_there: bool) -> None:
        if self._participant is not None:
            self._participant.is_looked_at = is_there
            self._participant.connection.try_to_send(wire.looked(is_there))

    def _describe(self) -> Dict[str, Any]:
        now_ns = 0 if self._participant is None else self._participant.now_ns
        return {'node': self._name, 'time_ns': now_ns}


def attach(socket_path: str, name: str, path: str) -> Optional[Attached]:
    """Return the debugger that the program `debug` uses by its socket, or None if it does not listen any more."""
    try:
        return Attached(Link(socket_path), name, path)
    except OSError as error:
        print('lockstep: {} is run without a debugger: nobody listens at {} ({})'.format(
            name or path, socket_path, error), file=sys.stderr, flush=True)
        return None
