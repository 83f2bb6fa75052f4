"""The prompt of a debugging session. Each method do_NAME is the command NAME, and its docstring is the help."""
from __future__ import annotations

import cmd
import contextlib
import json
import sys
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Sequence

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.kinds import similar
from move_base_abstract.common.shown import printable, shown

from . import answers, replay_page, state_words, stop_words
from .answers import Answer
from .node_commands import NodeCommands
from .session import Session
from .stops import ROUND, ROW, Refused, Stop

_SHOWN_ROWS = 5
_OVER = 'EOF'  # cmd's word for the end of the input


class Prompt(NodeCommands, cmd.Cmd):
    """Commands to a Session. ``is_json``: each answer is one JSON object on a line of its own."""

    doc_header = 'Commands; help COMMAND says more of one:'
    identchars = cmd.IDENTCHARS + '/'

    def __init__(self, session: Session, is_json: bool = False) -> None:
        super().__init__()
        self.session, self._is_json = session, is_json
        session.meet = self.meet
        self.has_refused = False  # whether a command could not be done
        self._command = 'start'
        self._lines: Optional[Iterator[str]] = None  # from where commands come, if nobody types them

    def start(self, instant: Optional[float] = None, row: Optional[int] = None) -> None:
        """Say where the run stands: at its start, or at an instant [s] or a row of the log, to which it goes."""
        if row is not None:
            self._move(lambda: self.session.go(Stop.at_row(row)))
        elif instant is not None and round(instant * 1e9) > self.session.run.now_ns:
            self._move(lambda: self.session.go_until(round(instant * 1e9)))
        else:
            nodes = self._nodes()
            place = answers.place(self.session.run, 0, 0)
            self.tell(['{} participants: {}'.format(len(nodes), ', '.join(nodes)), *place.lines,
                       'help lists the commands'], {'participants': nodes, **place.data})

    # --- the loop ----------------------------------------------------------------------------------------------------

    def ask(self) -> None:
        """Read commands from a terminal until quit or the end of the input. Ctrl-C gives the prompt again."""
        while True:
            try:
                self.cmdloop()
                return
            except KeyboardInterrupt:
                print()

    def obey(self, lines: Iterable[str]) -> None:
        """Do the commands of ``lines``, until one is quit; empty lines and those that begin with # do nothing."""
        self._lines = iter(lines)
        for line in self._lines:
            if line.strip() and not line.lstrip().startswith('#') and self.onecmd(line.strip()):
                return

    def read_line(self, prompt: str) -> Optional[str]:
        """Return the next line from where commands come, without its end; None: there is none."""
        if self._lines is not None:
            line = next(self._lines, None)
            return line if line is None else line.rstrip('\n')
        while True:
            try:
                return input(prompt)
            except KeyboardInterrupt:
                print()
            except EOFError:
                return None

    @property
    def is_interactive(self) -> bool:
        """Whether somebody types the commands."""
        return self._lines is None

    def preloop(self) -> None:
        """Show the prompt."""
        self._show_prompt()

    def postcmd(self, stop: bool, line: str) -> bool:
        """Show the prompt after a command."""
        self._show_prompt()
        return stop

    def _show_prompt(self) -> None:
        self.prompt = '(not started) '
        with contextlib.suppress(SimulatorError):
            self.session.run.refresh()
            self.prompt = '({:.3f} s) '.format(self.session.run.now_ns * 1e-9)

    def onecmd(self, line: str) -> bool:
        """Do one command; say why if it cannot be done. Return whether it was the last one."""
        self._command = line.split()[0] if line.split() else ''
        try:
            return bool(super().onecmd(line))
        except SimulatorError as error:
            self._refuse(str(error))
        return False

    def default(self, line: str) -> Any:
        """Refuse a word that is no command."""
        if line == _OVER:
            return True
        names = self._names()
        raise Refused('{} is no command; allowed: {}{}'.format(
            shown(self._command), ', '.join(names), similar(self._command, names)))

    def emptyline(self) -> bool:
        """Do nothing."""
        return False

    def _names(self) -> List[str]:
        return sorted(name[3:] for name in self.get_names() if name.startswith('do_'))

    # --- answers -----------------------------------------------------------------------------------------------------

    def tell(self, lines: Sequence[str], data: Dict[str, Any]) -> None:
        """Answer a command: lines for people, or one JSON object with ``data``."""
        said, self.session.said = self.session.said, []
        if self._is_json:
            print(json.dumps({'command': self._command, **data, **({'said': said} if said else {})}), flush=True)
        else:
            print('\n'.join(printable(line) for line in (*said, *lines)), flush=True)

    def _refuse(self, text: str) -> None:
        self.has_refused = True
        if self._is_json:
            self.tell([], {'error': text})
        else:
            self.tell(['{}: {}'.format(self._command, text)], {})

    def _give(self, answer: Answer) -> None:
        self.tell(answer.lines, answer.data)

    def tell_place(self, rows_before: int, shown_rows: int = _SHOWN_ROWS) -> None:
        """Answer with where the run stands."""
        self._give(answers.place(self.session.run, rows_before, shown_rows))

    def _move(self, move: Callable[[], Any]) -> None:
        """Go somewhere, and say where the run stands then."""
        run, before = self.session.run, len(self.session.run.log.lines)
        move()
        is_same = self.session.run is run
        count = len(self.session.run.log.lines)
        self.tell_place(before if is_same else max(0, count - 1))

    # --- commands: on and back ---------------------------------------------------------------------------------------

    def do_next(self, words: str) -> None:
        """`next`: go on to the next row of the log, and to the end of its round."""
        _none('next', words)
        self._move(lambda: self.session.go(Stop(ROW)))

    def do_round(self, words: str) -> None:
        """`round [N]`: go on for one round, or N: in a round each node that has something to do does it once."""
        count = stop_words.whole(words, 'round') if words else 1
        self._move(lambda: self.session.go(Stop(ROUND, times=count)))

    def do_run(self, words: str) -> None:
        """`run SECONDS`: go on for so many simulated seconds."""
        span_ns = stop_words.nanoseconds(words, 'run')
        if not span_ns:
            raise Refused('run takes more than 0 simulated seconds; got {}'.format(shown(words)))
        self._move(lambda: self.session.go_until(self.session.run.now_ns + span_ns))

    def do_until(self, words: str) -> None:
        """`until WHAT`: go on until something happens.

        WHAT is `result ROBOT` (a goal of the robot has ended), `message TOPIC` (a message on it, or a call of a
        service, was sent), `row KIND [ROBOT]` (the log has got a row of this kind), an instant (simulated s), `broken
        [PROPERTY]` (a row breaks a property, or this one: properties.md), `deadlock` (robots or nodes wait for each
        other), or `end` (of the run).
        """
        wanted = stop_words.until(words.split(), self.session.run.log.story().robots)
        if isinstance(wanted, Stop):
            self._move(lambda: self.session.go(wanted))
            return
        properties = wanted.properties
        before, found = len(self.session.run.log.lines), self.session.until_broken(properties)
        place = answers.place(self.session.run, min(before, len(self.session.run.log.lines) - 1), 1)
        self.tell(['broken: {}'.format(found.words()) if found else 'no row so far breaks one more property',
                   *place.lines], {'broken': found and found.told(), **place.data})

    def do_back(self, words: str) -> None:
        """`back [ROWS | TIMEs]`: go back by one row of the log, by so many, or by a time (back 2.5s).

        A new run of the same command goes to there, and is held to the rows that are known. What the nodes have done
        to files elsewhere stays.
        """
        wanted = stop_words.back(words.split())
        session = self.session
        if wanted.time_ns:
            self._move(lambda: session.to_instant(max(0, session.run.now_ns - wanted.time_ns)))
        else:
            self._move(lambda: session.back_rows(wanted.rows))

    def do_at(self, words: str) -> None:
        """`at INSTANT`: go to this instant (simulated s), on or back."""
        instant_ns = stop_words.nanoseconds(words, 'at')
        self._move(lambda: self.session.to_instant(instant_ns))

    # --- commands: look ----------------------------------------------------------------------------------------------

    def do_robots(self, words: str) -> None:
        """`robots`: what each robot does, by the log so far."""
        _none('robots', words)
        self._give(answers.robots(self.session.run))

    def do_goals(self, words: str) -> None:
        """`goals`: the goals and tasks of robots that are open, by the log so far."""
        _none('goals', words)
        self._give(answers.goals(self.session.run))

    def do_where(self, words: str) -> None:
        """`where`: what each participant waits for."""
        _none('where', words)
        self.session.run.refresh()
        self._give(answers.where(self.session.run))

    def do_why(self, words: str) -> None:
        """`why`: why time stands still, as the program `why` says it."""
        _none('why', words)
        self.session.run.refresh()
        state = self.session.run.state
        lines = [line for line in state_words.lines(state) if not line.startswith('next: ')]  # commands of a shell
        self.tell(lines, {'state': state_words.as_data(state)})

    def do_rows(self, words: str) -> None:
        """`rows [N]`: the last rows of the log: 5, or N."""
        count = stop_words.whole(words, 'rows') if words else _SHOWN_ROWS
        log = self.session.run.log
        self._give(answers.rows(self.session.run, max(1, len(log.lines) - count + 1)))

    def do_echo(self, words: str) -> None:
        """`echo TOPIC`: the latest message of a topic, or call of a service."""
        if len(words.split()) != 1:
            raise Refused('echo takes the name of a topic or a service; got {}'.format(shown(words)))
        kept = self.session.run.recent(stop_words.absolute(words), '', 1)
        if not kept:
            raise Refused('no participant has got a message of {} so far'.format(stop_words.absolute(words)))
        self._give(answers.echo(kept[-1]))

    def do_messages(self, words: str) -> None:
        """`messages [NODE | TOPIC] [N]`: the latest messages: of all topics, of one, or that a node has sent or got."""
        parts = words.split()
        count = stop_words.whole(parts.pop(), 'messages') if parts and parts[-1].isdecimal() else _SHOWN_ROWS
        if len(parts) > 1:
            raise Refused('messages takes [NODE | TOPIC] [N]; got {}'.format(shown(words)))
        name = stop_words.absolute(parts[0]) if parts else ''
        is_node = name in self._nodes()
        self._give(answers.messages(self.session.run.recent('' if is_node else name, name if is_node else '', count)))

    def do_replay(self, words: str) -> None:
        """`replay`: make the page of the run so far (replay.md), and open it at this instant if there is a screen."""
        _none('replay', words)
        run = self.session.run
        address = replay_page.open_page(run.log.path, run.folder, run.now_ns)
        self.tell([address], {'address': address})

    def do_quit(self, words: str) -> bool:
        """`quit`: end the run and all of its processes. The end of the input does the same."""
        _none('quit', words)
        return True

    def do_help(self, arg: str) -> None:
        """`help [COMMAND]`: the list of commands, or what is known of one."""
        if arg and arg not in self._names():
            raise Refused('{} is no command{}'.format(shown(arg), similar(arg, self._names())))
        texts = [getattr(self, 'do_' + name).__doc__ for name in ([arg] if arg else self._names())]
        lines = [line.strip().replace('`', '') for text in texts for line in (
            text.strip().splitlines() if arg else text.splitlines()[:1])]
        self.tell(lines, {'help': lines})

    # --- completion --------------------------------------------------------------------------------------------------

    def _nodes(self) -> List[str]:
        return [one.name for one in self.session.run.state.participants]

    def complete_until(self, text: str, line: str, _begin: int, _end: int) -> List[str]:
        """Return the words that may follow: what to wait for, then names of robots."""
        number = len(line[:_begin].split())
        known = stop_words.WORDS if number == 1 else list(self.session.run.log.story().robots)
        return [word for word in known if word.startswith(text)]

    def complete_messages(self, text: str, _line: str, _begin: int, _end: int) -> List[str]:
        """Return the names of nodes that begin like this."""
        return [name for name in self._nodes() if name.startswith(text)]

    def complete_help(self, *args: Any) -> List[str]:
        """Return the names of commands that begin like this."""
        return [name for name in self._names() if name.startswith(args[0])]


def _none(command: str, words: str) -> None:
    if words.strip():
        raise Refused('{} takes nothing; got {}'.format(command, shown(words.strip())))


def is_terminal() -> bool:
    """Return whether somebody types at the standard input."""
    return sys.stdin.isatty()
