"""Say in plain lines why simulated time moves, or why it does not.

    rosrun move_base_abstract why [--json] [--timeout S] [--ns /time_master]

Asks the time master once, and prints its state: what each participant owes and since when, the next wake-up, the nodes
for which time does not wait, and the reasons why the run is not called repeatable.

Exit codes: 0 the time master has answered; 1 it has not; 2 wrong arguments.
"""

import argparse
import json
import sys

import genpy
import rosgraph
import rospy

from move_base_abstract.common.options import POSITIVE
from move_base_abstract.msg import TimeState
from move_base_abstract_ros.process import code_places, ros_master_watch
from move_base_abstract_ros.replacing import rospy_start

HELP = ('what usually helps: a loop that waits for something waits in ROS time (rospy.sleep, rospy.Rate, '
        'ros::Duration::sleep); a wait for a file, a socket or another process holds up all nodes until it is over; '
        'a long computation only needs patience')
#: phase of a run in lockstep: a command that helps next; FILE is the launch file of the run
NEXT = {
    'waiting_for_participants': 'which node is waited for, and whether it takes part at all: rosrun move_base_abstract '
                                'lockstep_launch --list FILE',
    'paused': 'rosservice call {}/resume',
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
    'idle': 'stands still: no participant wants to wake up (idle); a message from outside or a new participant '
    'wakes the run',
    'deadlock': 'stands still: deadlock',
    'zero_delay_loop': 'stands still: zero-delay loop',
    'ended': 'stands still: the run is over',
}


def main(words=None):
    """Ask, print the answer and exit with the code."""
    arguments = _parse(rospy.myargv()[1:] if words is None else words)
    topic = arguments.ns.rstrip('/') + '/state'
    try:
        state = _ask(topic, arguments.timeout)
    except (rospy.ROSException, OSError) as error:
        print(f'why: {error}', file=sys.stderr)
        sys.exit(1)
    if arguments.json:
        print(json.dumps(as_data(state), indent=2))
    else:
        print('\n'.join(map(shown, lines(state, arguments.ns))))


def _parse(words):
    parser = argparse.ArgumentParser(prog='why', description='Say why simulated time moves, or why it does not.',
                                     epilog='exit codes: 0 the time master has answered, 1 it has not')
    parser.add_argument('--json', action='store_true', help="the time master's whole state as one JSON object")
    parser.add_argument('--timeout', type=POSITIVE, default=5.0, metavar='S', help='time to wait for an answer [s, '
                        'wall] (default: %(default)g)')
    parser.add_argument('--ns', default='/time_master', metavar='NAME', help='name of the time master (default: '
                        '%(default)s)')
    return parser.parse_args(words)


def _ask(topic, timeout):
    """Return the time master's TimeState on ``topic``. ``timeout`` [s, wall].

    :raises rospy.ROSException: if there is no ROS master, or no TimeState comes in time.
    """
    uri = rosgraph.get_master_uri()
    if not ros_master_watch.is_answering(uri, 'why', timeout):
        raise rospy.ROSException(f'no ROS master at {uri} answers within {timeout:g} s; a run of lockstep_launch has '
                                 'one of its own, which its first lines name: ROS_MASTER_URI=http://127.0.0.1:PORT '
                                 'rosrun move_base_abstract why')
    # Without ROS time: otherwise this node would count as one that uses the clock.
    rospy_start.prepare()
    rospy.init_node('why', anonymous=True, disable_rostime=True, disable_signals=True)
    try:
        return rospy.wait_for_message(topic, TimeState, timeout)
    except rospy.ROSException as error:
        raise rospy.ROSException(f'no time master answers on {topic} within {timeout:g} s; is one running there?'
                                 ) from error
    finally:
        rospy.signal_shutdown('asked')


def shown(text):
    """Return a text in which characters that control a terminal or end the line are replaced by their codes."""
    return ''.join(c if c.isprintable() else c.encode('unicode_escape').decode() for c in text)


def as_data(message):
    """Return a message as dicts, lists, numbers and texts; times in ns, under names that end in _ns."""
    data = {}
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, genpy.Time):
            data[name + '_ns'] = value.to_nsec()
        elif isinstance(value, list):
            data[name] = [as_data(one) if isinstance(one, genpy.Message) else one for one in value]
        else:
            data[name] = value
    return data


def lines(state, name='/time_master'):
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


def _scaled_lines(state):
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


def _gate_lines(state):
    if state.paused and state.phase != 'paused':
        yield 'paused: no leap after the present instant'
    if state.run_until:
        yield f'stops at {_time(state.run_until)}'
    if state.wanted_factor:
        yield f'at most {state.wanted_factor:g} times real time'


def _waiting_lines(state):
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


def _participant_lines(state):
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


def _label_lines(state):
    yield from (f'not repeatable: {code_places.with_lines(why)}' for why in state.not_repeatable_because)
    yield from (f'degraded: {why}' for why in state.degraded_because)
    if state.repeatable:
        yield 'repeatable so far'


def _next_lines(state, name):
    if state.phase in NEXT and not (state.phase == 'paused' and state.reason):
        yield 'next: ' + NEXT[state.phase].format(name.rstrip('/'))
    elif state.bystanders or state.not_repeatable_because:
        yield 'next: why a node only looks on: rosrun move_base_abstract lockstep_launch --list FILE'


def _some(names):
    rest = f' and {len(names) - SHOWN} more' if len(names) > SHOWN else ''
    return ', '.join(names[:SHOWN]) + rest if names else 'none'


def _time(time):
    return f'{time.secs}.{time.nsecs:09d} s'
