"""What a debugging session says: each answer as lines for people, and as plain values for programs."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterator, List, NamedTuple, Sequence

from move_base_abstract.common.shown import printable
from move_base_abstract.common.units import exact_seconds
from move_base_abstract.runs.states import NAMES

from . import state_words

if TYPE_CHECKING:
    from move_base_abstract.runs.robot_story import Robot
    from move_base_abstract.runs.trace import TraceEntry

    from .debugged_run import DebuggedRun

_S = 1e-9
_MOST_BYTES = 64  # of a message whose type is not here


class Answer(NamedTuple):
    """The lines for people, and the values for programs."""

    lines: List[str]
    data: Dict[str, Any]


def row_line(number: int, row: TraceEntry) -> str:
    """Return a row of the log as a line for people."""
    return 'row {}: {} s: {} {} {}'.format(number, exact_seconds(row.time_ns), row.robot, row.kind, list(row.values))


def rows(run: DebuggedRun, first: int) -> Answer:
    """Return the rows of the log from the one with the number ``first`` on; the first row has the number 1."""
    found = run.log.entries(first - 1, len(run.log.lines))
    return Answer([row_line(number, row) for number, row in enumerate(found, first)],
                  {'first_row': first, 'rows': [list(row) for row in found]})


def place(run: DebuggedRun, rows_before: int, shown: int) -> Answer:
    """Return where a run stands, why, and the last ``shown`` rows of those that are new since ``rows_before``."""
    state, count = run.state, len(run.log.lines)
    first = max(rows_before, count - shown) + 1
    new = rows(run, first)
    lines = ['... {} more rows'.format(first - 1 - rows_before)] if first - 1 > rows_before else []
    lines += new.lines
    how = 'the run is over' if run.is_over else state.reason or state.phase
    lines.append('at {} s, {} rows, round {}: {}'.format(exact_seconds(run.now_ns), count, state.rounds, how))
    return Answer(lines, {'time_ns': run.now_ns, 'rows_so_far': count, 'round': state.rounds,
                          'phase': 'ended' if run.is_over else state.phase, 'reason': state.reason,
                          'stop_row': state.stop_row, 'new_rows': new.data['rows']})


def robots(run: DebuggedRun) -> Answer:
    """Return what the log so far tells of each robot."""
    story = run.log.story()
    told = [_robot(story.doing(robot), robot) for robot in story.robots.values()]
    lines = ['{name}: {doing}{where}{charge}; {goals} goals reached, {missed} missed'.format(
        **one, where='' if one['at'] is None else ', last stood at ({:.3f}, {:.3f})'.format(*one['at']),
        charge='' if one['charge_level'] is None else ', charge {:.0%}'.format(one['charge_level'])) for one in told]
    return Answer(lines or ['no row of the log is of a robot so far'], {'robots': told})


def _robot(doing: str, robot: Robot) -> Dict[str, Any]:
    return {'name': robot.name, 'state': NAMES[robot.state], 'doing': doing, 'at': robot.at and list(robot.at),
            'charge_level': robot.charge, 'goals': robot.goals, 'missed': robot.goals_missed}


def goals(run: DebuggedRun) -> Answer:
    """Return the goals and tasks that are open, by the log so far."""
    told = []
    for robot in run.log.story().robots.values():
        for what, name, _, since_ns in robot.open:
            if what in ('goal', 'task'):
                target = run.log.targets.get(robot.name) if what == 'goal' else None
                told.append({'robot': robot.name, 'what': what, 'id': name, 'since_ns': since_ns,
                             'target': target and list(target)})
    lines = ['{robot}: {what} {id}, since {since} s{to}'.format(
        **one, since=exact_seconds(one['since_ns']),
        to=' to ({:.3f}, {:.3f}), yaw {:.3f}'.format(*one['target']) if one['target'] else '') for one in told]
    return Answer(lines or ['the log has no open goal of a robot so far'], {'goals': told})


def where(run: DebuggedRun) -> Answer:
    """Return what each participant waits for."""
    state = run.state
    lines = ['{} s, microstep {}: {}'.format(exact_seconds(run.now_ns), state.microstep, state.reason or state.phase)]
    lines += ['{}: {}'.format(one.name, '; '.join(_waits(one))) for one in state.participants]
    lines += ['{} owes {}, for {:.1f} s of wall time{}'.format(one.name, one.owes, one.since, ', ' * bool(
        one.where) + one.where) for one in state.waiting_for]
    return Answer([printable(line) for line in lines], {'state': state_words.as_data(state)})


def _waits(one: Any) -> Iterator[str]:
    """Yield what a Participant waits for, in words."""
    if one.working:
        yield 'works'
    if one.mail:
        yield '{} messages are under way to it'.format(one.mail)
    yield 'wakes up only for a message' if one.never else 'wakes up at {} s'.format(exact_seconds(one.next.to_nsec()))
    if one.open:
        yield '{} threads wait without end'.format(one.open)
    if one.waits_for:
        yield one.waits_for


def messages(kept: Sequence[Any]) -> Answer:
    """Return kept messages (KeptMessage) as lines."""
    told = [{'time_ns': one.time.to_nsec(), 'kind': one.kind, 'topic': one.topic, 'type': one.type,
             'sender': one.sender, 'receivers': list(one.receivers), 'bytes': len(one.bytes)} for one in kept]
    lines = ['{at} s: {kind} {topic} ({type}) from {sender} to {to}, {bytes} bytes'.format(
        **one, at=exact_seconds(one['time_ns']), to=', '.join(one['receivers'])) for one in told]
    return Answer([printable(line) for line in lines] or ['no message so far'], {'messages': told})


def echo(kept: Any) -> Answer:
    """Return a kept message (KeptMessage) with its content."""
    content = _decoded(kept)
    told = messages([kept])
    text = '{} bytes: {}'.format(len(kept.bytes), bytes(kept.bytes)[:_MOST_BYTES].hex()) if content is None else (
        str(content))
    return Answer([told.lines[0], *map(printable, text.splitlines())],
                  {**told.data['messages'][0], 'content': text if content is None else state_words.as_data(content)})


def _decoded(kept: Any) -> Any:
    """Return the message of a KeptMessage, or None if its type, or this version of it, is not here."""
    from roslib.message import get_message_class, get_service_class
    if kept.kind == 'message':
        kind = get_message_class(kept.type)
    else:
        service = get_service_class(kept.type)
        kind = service and (service._request_class if kept.kind == 'call' else service._response_class)
    md5sum = None if kind is None else kind._md5sum if kept.kind == 'message' else service._md5sum
    if kind is None or md5sum != kept.md5sum:
        return None
    try:
        return kind().deserialize(bytes(kept.bytes))
    except Exception:  # bytes of another kind, whatever the library says of them
        return None
