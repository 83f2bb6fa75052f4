"""Say in plain lines what the time master's state is, and why simulated time moves or stands still."""
from __future__ import annotations

from typing import Any, Dict, Iterator, List, Sequence

import genpy

from move_base_abstract.common.shown import first_of

from ..process import code_places

HELP = ('what usually helps: a loop that waits for something waits in ROS time (rospy.sleep, rospy.Rate, '
        'ros::Duration::sleep); a wait for a file, a socket or another process holds up all nodes until it is over; '
        'a long computation only needs patience')
#: phase of a run in lockstep: a command that helps next; FILE is the launch file of the run
NEXT = {
    'waiting_for_participants': 'which node is waited for, and whether it takes part at all: rosrun move_base_abstract '
                                'lockstep_launch --list FILE',
    'paused': 'rosservice call {}/resume',
    'stopped': 'rosservice call {}/resume',
    'limited': 'a run as fast as possible: without --speed-limit',
    'idle': 'a run that ends here: lockstep_launch --end-when-idle FILE',
    'deadlock': 'which node waits for which, in the log: lockstep_launch --check --log-messages --event-log '
    'RUN.jsonl FILE',
    'zero_delay_loop': 'the messages that go round, in its log: lockstep_launch --log-messages --event-log RUN.jsonl '
                       'FILE',
    'ended': 'the run as a replay: rosrun move_base_abstract replay RUN.jsonl, its --event-log',
}
SHOWN = 10  # the number of nodes of a kind that are named

PHASES = {
    'waiting_for_participants': 'stands still: the run has not started',
    'running': 'moves',
    'waiting': 'stands still: a participant has not reported for a while',
    'limited': 'moves, held back by the speed limit',
    'paused': 'stands still: paused',
    'stopped': 'stands still: stopped, for somebody who looks at it',
    'idle': 'stands still: no participant wants to wake up (idle); a message from outside or a new participant '
    'wakes the run',
    'deadlock': 'stands still: deadlock',
    'zero_delay_loop': 'stands still: zero-delay loop',
    'ended': 'stands still: the run is over',
}


def as_data(message: Any) -> Dict[str, Any]:
    """Return a message as dicts, lists, numbers and texts; times in ns, under names that end in _ns."""
    data: Dict[str, Any] = {}
    for name in message.__slots__:
        value = getattr(message, name)
        data[name + '_ns' if isinstance(value, genpy.rostime.TVal) else name] = _plain(value)
    return data


def _plain(value: Any) -> Any:
    if isinstance(value, genpy.rostime.TVal):
        return value.to_nsec()
    if isinstance(value, (list, tuple, bytes)):
        return [_plain(one) for one in value]
    return as_data(value) if isinstance(value, genpy.Message) else value


def lines(state: Any, name: str = '/time_master') -> List[str]:
    """Return the lines that are printed for a TimeState. ``name``: that of the time master."""
    if state.mode != 'lockstep':
        return _scaled_lines(state)
    is_held = state.phase == 'paused' and state.reason  # for nodes that look on; nobody has called pause
    return [f'time {"stands still" if is_held else PHASES.get(state.phase, state.phase)}',
            f'at {_time(state.sim_time)}, microstep {state.microstep}; {state.rounds} rounds, {state.leaps} leaps, '
            f'{state.messages} messages so far; {state.achieved_factor:.4g} times real time lately, '
            f'cores of this computer: {state.cores}',
            *([f'equal events are in the order of {state.chaos}'] if state.chaos else []),
            *([state.reason] if state.reason else []), *([state.event_log_error] if state.event_log_error else []),
            *_gate_lines(state), *_waiting_lines(state),
            *_participant_lines(state), *_label_lines(state), *_next_lines(state, name)]


def _scaled_lines(state: Any) -> List[str]:
    moves = f'moves at {state.effective_factor:g} times real time' if state.effective_factor else 'stands still'
    if state.paused:
        moves = 'stands still: paused'
    elif state.holds and state.effective_factor < state.wanted_factor:
        moves += f', held back (asked for: {state.wanted_factor:g}, busy_factor: {state.busy_factor:g})'
    return [f'time {moves}',
            f'at {_time(state.sim_time)}; mode scaled: time follows the wall clock and waits for no node',
            *(f'held by {hold.holder}, for {hold.remaining:.1f} s more at most' for hold in state.holds),
            *([f'stops at {_time(state.run_until)}'] if state.run_until else []),
            *(f'{name} publishes /clock too' for name in state.other_clock_publishers), *state.degraded_because]


def _gate_lines(state: Any) -> Iterator[str]:
    if state.paused and state.phase not in ('paused', 'stopped'):
        yield 'paused: no leap after the present instant'
    if state.looked_at:
        yield f'somebody looks at {_some(state.looked_at)} in a debugger: limits of wall time stand while it works'
    if state.run_until:
        yield f'stops at {_time(state.run_until)}'
    if state.wanted_factor:
        yield f'at most {state.wanted_factor:g} times real time'


def _waiting_lines(state: Any) -> Iterator[str]:
    waiting = sorted(state.waiting_for, key=lambda one: -one.since)
    for one in waiting[:SHOWN]:
        yield f'{one.name} owes {one.owes}, for {one.since:.1f} s'
        if one.told:
            yield f'    it was told last: {one.told}'
        if one.where:
            yield f'    it is in {code_places.with_lines(one.where)}'
            yield f'    {HELP}'
    if len(waiting) > SHOWN:
        yield f'... and {len(waiting) - SHOWN} more'


def _participant_lines(state: Any) -> Iterator[str]:
    due = [one for one in state.participants if not one.never]
    if due:
        first = min(one.next for one in due)
        names = [one.name for one in due if one.next == first]
        yield f'next wake-up: {_time(first)}, of {_some(names)}'
    elif state.participants:
        yield 'next wake-up: none'
    stuck = [one for one in state.participants if one.waits_for or one.open]
    for one in stuck[:SHOWN]:
        threads = f'{one.open} thread{"s" if one.open > 1 else ""} waiting without end' if one.open else ''
        yield f'{one.name}: {"; ".join(part for part in (threads, one.waits_for) if part)}'
    if len(stuck) > SHOWN:
        yield f'... and {len(stuck) - SHOWN} more that wait'
    yield from (f'{one.name} tells {one.tells}' for one in state.participants[:SHOWN] if one.tells)
    yield f'participants: {_some([one.name for one in state.participants])}'
    if state.bystanders:
        yield f'not waited for (they use /clock and do not take part): {_some(state.bystanders)}'
    if state.other_clock_publishers:
        yield f'others that publish /clock (an error): {_some(state.other_clock_publishers)}'


def _label_lines(state: Any) -> Iterator[str]:
    yield from (f'not repeatable: {code_places.with_lines(why)}' for why in state.not_repeatable_because)
    yield from (f'degraded: {why}' for why in state.degraded_because)
    if state.repeatable:
        yield 'repeatable so far'


def _next_lines(state: Any, name: str) -> Iterator[str]:
    if state.phase in NEXT and not (state.phase == 'paused' and state.reason):
        yield 'next: ' + NEXT[state.phase].format(name.rstrip('/'))
    elif state.bystanders or state.not_repeatable_because:
        yield 'next: why a node only looks on: rosrun move_base_abstract lockstep_launch --list FILE'


def _some(names: Sequence[str]) -> str:
    return first_of(names, SHOWN) or 'none'


def _time(time: Any) -> str:
    return f'{time.secs}.{time.nsecs:09d} s'
