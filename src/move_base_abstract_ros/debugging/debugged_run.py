"""One run that is debugged: a `lockstep_launch` of its own, whose time stands where somebody looks at it."""
from __future__ import annotations

import contextlib
import math
import os
import select
import shutil
import signal
import subprocess
import time
from typing import Any, Callable, Dict, List, Sequence

import genpy

from move_base_abstract.srv import RecentMessages, SetLooking, StopWhen

from . import MASTER_NOTE
from .log_so_far import LogSoFar
from .master_link import LinkError, MasterLink
from .node_sessions import News, NodeSessions, Place
from .stops import NEVER, ROUND, ROW, STANDS, STOPPED, Refused, Stop

_LOOK_S = 0.01  # wall
_STATE_S = 0.2  # wall
_ASK_S = 0.05  # wall
_INTERRUPTED_S = 2.0  # wall; the time in which a round ends, unless a node computes
_END_S = 30.0  # wall
_NS = 10 ** 9


class DebuggedRun:
    """A run of `lockstep_launch` with ``words``. ``folder``: a new folder for this run alone; ``log``: its event log.

    ``program``: the words that begin lockstep_launch, or what takes its place; ``cwd``: its working folder;
    ``environment``: its variables; ``places``: breakpoints. ``meet`` is called with news of nodes that somebody debugs;
    it returns when they go on.
    """

    def __init__(self, program: Sequence[str], words: List[str], folder: str, cwd: str, environment: Dict[str, str],
                 log: str, places: Sequence[Place] = ()) -> None:
        os.mkdir(folder, 0o700)
        self.nodes = NodeSessions(folder, places)
        self.meet: Callable[[List[News]], object] = lambda _news: None
        self.folder, self.log = folder, LogSoFar(log)
        self.uri, self.touched = '', ''
        self._link: Any = None
        self._state: Any = None
        setpriv = shutil.which('setpriv')
        if setpriv is None:
            raise Refused('the program setpriv is not here; it is of the package util-linux')
        # It ends with us, in a session of its own: Ctrl-C at the prompt is not for it. Our answers stand alone on our
        # standard output.
        self._process = subprocess.Popen(
            [setpriv, '--pdeathsig', 'TERM', '--', *program, '--debugged', '--notes', folder, '--event-log', log,
             *words], stdin=subprocess.DEVNULL, stdout=2, cwd=cwd, env={**environment, **self.nodes.environment},
            start_new_session=True)

    @property
    def pid(self) -> int:
        """The process id of lockstep_launch."""
        return self._process.pid

    @property
    def state(self) -> Any:
        """The latest TimeState. :raises Refused: if time has not been there."""
        if self._state is None:
            raise Refused('the run has not come to its start; back 1 starts it again, and quit ends it')
        return self._state

    @property
    def is_over(self) -> bool:
        """Whether the run is over: its processes have ended, or are about to."""
        return self._process.poll() is not None or self._state is not None and self._state.phase == 'ended'

    @property
    def is_stopped(self) -> bool:
        """Whether nothing happens in the run until somebody asks for it."""
        return self._state is not None and (self.is_over or self._state.phase in (*STOPPED, *STANDS))

    @property
    def now_ns(self) -> int:
        """The present instant [ns]."""
        return int(self.state.sim_time.to_nsec())

    def await_start(self) -> bool:
        """Wait until all participants are there, and time stands at its start; return whether that is so."""
        note = os.path.join(self.folder, MASTER_NOTE)
        while not os.path.exists(note):
            if self.is_over:
                return False
            self._hear_nodes(_LOOK_S)
        with open(note) as stream:
            self.uri = stream.read()
        while self._link is None:
            if self.is_over:
                return False
            with contextlib.suppress(LinkError):  # it has not registered yet
                self._link = MasterLink(self.uri)
                continue
            self._hear_nodes(_LOOK_S)
        self._await(lambda state: state.phase in STOPPED)
        return self._state is not None and not self.is_over

    def go(self, stop: Stop) -> None:
        """Run until ``stop``, or until the run cannot go on.

        :raises Refused: if the run is over, or the time master refuses.
        """
        self.check_stopped()
        try:
            answer = self._link.call('stop_when', StopWhen, stop.what, stop.kind, stop.robot, stop.topic, stop.times,
                                     stop.row, genpy.Time(*divmod(stop.until_ns, _NS)))
        except LinkError as error:
            raise Refused(str(error)) from None
        self._await_stop(answer.stop, stop.until_ns)

    def interrupt(self) -> None:
        """Stop after the present round: somebody has lost patience. If a node computes, it may take a while."""
        if self._link is None or self.is_over:
            return
        try:
            answer = self._link.call('stop_when', StopWhen, ROUND, '', '', '', 1, 0, genpy.Time())
        except LinkError:
            return
        self._await_stop(answer.stop, 0, _INTERRUPTED_S)

    def refresh(self) -> None:
        """Take the latest state: a round may have ended since somebody lost patience."""
        if self._link is not None and not self.is_over:
            self._await(lambda _state: True, 0.0)

    def check_stopped(self) -> None:
        """Raise Refused, with what to do instead, unless the run can go on from where it stands."""
        self.refresh()
        if self.is_over:
            raise Refused('the run is over; allowed: back, at INSTANT, quit, and all that only looks')
        if not self.is_stopped:
            raise Refused('the round has not ended yet: where says which node is waited for; try again, or quit')

    def recent(self, topic: str, node: str, count: int) -> Any:
        """Return the latest messages of a topic, or of a node (KeptMessage). :raises Refused: if there are none."""
        if self.is_over:
            raise Refused('the run is over, and its messages with it; back or at T goes to where it was not')
        try:
            return self._link.call('recent', RecentMessages, topic, node, count).messages
        except LinkError as error:
            raise Refused(str(error)) from None

    def looks(self, node: str, is_looking: bool) -> None:
        """Tell the time master whether somebody looks at a node, which then has any time."""
        try:
            self._link.call('looking', SetLooking, node, is_looking)
        except LinkError as error:
            raise Refused(str(error)) from None

    def go_while(self, is_wanted: Callable[[], bool]) -> None:
        """Let the run go on while ``is_wanted()``, which is asked now and then, and stop after a round.

        :raises Refused: as go() does.
        """
        self.check_stopped()
        try:
            self._link.call('stop_when', StopWhen, ROW, '', '', '', 0, NEVER, genpy.Time())
        except LinkError as error:
            raise Refused(str(error)) from None
        while is_wanted() and not self.is_over:
            self._await(lambda state: state.phase in STANDS, _ASK_S)
        self.interrupt()

    def end(self) -> int:
        """End the run and all of its processes; return the exit code of lockstep_launch."""
        self.nodes.close()
        for number in (0 if self.is_over else signal.SIGINT, signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            self._process.send_signal(number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(_END_S)
        if self._link is not None:
            self._link.close()
        self.log.close()
        return self._process.returncode

    def await_end(self) -> int:
        """Wait for the end of a run that is over; return the exit code of lockstep_launch. Its log is whole then."""
        self._process.wait()
        self.log.read()
        return self._process.returncode

    def _hear_nodes(self, seconds: float, *others: Any) -> None:
        """Wait for news of nodes, or for ``others``, at most ``seconds`` [s, wall]; meet the nodes."""
        if self.nodes in select.select([self.nodes, *others], [], [], seconds)[0]:
            self.meet(self.nodes.news())

    def _await_stop(self, number: int, until_ns: int, seconds: float = math.inf) -> None:
        self._await(lambda state: state.stops >= number or state.phase in STANDS or (
            state.phase == 'paused' and 0 < until_ns <= state.sim_time.to_nsec()), seconds)

    def _await(self, is_there: Callable[[Any], bool], seconds: float = math.inf) -> None:
        """Wait for a state of this kind, or the end of the run, at most ``seconds`` [s, wall]."""
        deadline = time.monotonic() + seconds
        try:
            while True:
                self._hear_nodes(max(0.0, min(_STATE_S, deadline - time.monotonic())), self._link)
                if self._link.take():
                    self._state = self._link.state
                if self._state is not None and is_there(self._state) or time.monotonic() >= deadline or (
                        self._process.poll() is not None):
                    break
        except LinkError:  # the time master has ended, and so does the run
            if self._state is not None:
                self._state.phase = 'ended'
        if self.is_over:
            self.await_end()  # then the log is whole
        self.log.read()
