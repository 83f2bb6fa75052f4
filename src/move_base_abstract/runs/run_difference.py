"""The first difference of two runs, shown so that its cause can be found.

Two event logs with messages in them (the time master's ``log_messages``) are equal up to an event. Of that event, both
versions are shown, with its instant and its senders. For each sender, the last messages that it got are shown, too;
they are the same in both runs.
"""
from __future__ import annotations

import collections
import itertools
from typing import TYPE_CHECKING, Deque, Dict, Iterator, List, NamedTuple, Optional, Tuple

from . import event_log
from .event_log import EventLog

if TYPE_CHECKING:
    from .event_log import Event

LAST = 10  # the number of messages shown that a node has got
MESSAGES = ('message', 'call', 'response')  # the kinds of events that are sent between participants
_MOST_OF_AN_INSTANT = 10000  # the number of events compared after the first difference
_STATUS = {'response': 1}  # the number of values between the receivers and the length


class Comparison(NamedTuple):
    """The result of :func:`compare`. ``difference`` is None if the events are equal."""

    events: int  # the number of events before the difference, without messages
    messages: int  # the number of messages before the difference
    difference: Optional['Difference']
    bags: Optional[event_log.BagDifference] = None  # only compared if the events are equal
    alone: Tuple[str, ...] = ()  # the nodes of whose bags only one log has digests

    @property
    def identical(self) -> bool:
        """Whether nothing that was compared differs."""
        return self.difference is None and self.bags is None


class Difference(NamedTuple):
    """The first difference of two logs."""

    time_ns: int
    place: int  # its number among the events of this instant, from 1 on
    first: Optional[Event]  # None: that run's log has ended
    second: Optional[Event]
    told: Dict[str, List[Event]]  # {node: the last LAST messages that it got, the newest last}
    number: int = 0  # if it is a message, its number among the messages of either log, from 1 on
    is_reordered: bool = False  # both events are in both logs at this instant, in another order


def compare(first_path: str, second_path: str, with_messages: bool = True) -> Comparison:
    """Compare two event logs, and the digests of the bags that their end records have.

    Without messages only events that participants wrote themselves are compared. Bags are not compared then, because
    they contain the names of senders.

    :raises EventLogError: if a log cannot be read.
    """
    with event_log.opened(first_path) as first, event_log.opened(second_path) as second:
        found = _compare(_events(first, with_messages), _events(second, with_messages))
    if found.difference is not None or not with_messages:
        return found
    bags, alone = event_log.compare_bags(first, second)
    return found._replace(bags=bags, alone=tuple(alone))


def _events(log: EventLog, with_messages: bool) -> Iterator[Event]:
    return (event for event in log if with_messages or event.kind not in MESSAGES)


def _compare(first: Iterator[Event], second: Iterator[Event]) -> Comparison:
    counts = [0, 0]
    told: Dict[str, Deque[Event]] = collections.defaultdict(lambda: collections.deque(maxlen=LAST))
    instant: Optional[int] = None
    place = 0
    for mine in first:
        its = next(second, None)
        instant, place = (instant, place + 1) if mine.time_ns == instant else (mine.time_ns, 1)
        if its is None or its.compared != mine.compared:
            rests = [_rest(instant, events) for events in (first, second)]
            return Comparison(counts[0], counts[1], _difference(place, mine, its, told)._replace(
                number=counts[1] + 1, is_reordered=its is not None and mine.compared in rests[1]
                and its.compared in rests[0]))
        counts[mine.kind in MESSAGES] += 1
        for node in receivers(mine):
            told[node].append(mine)
    its = next(second, None)
    if its is None:
        return Comparison(counts[0], counts[1], None)
    return Comparison(counts[0], counts[1], _difference(place + 1 if its.time_ns == instant else 1, None, its, told))


def _rest(instant: Optional[int], events: Iterator[Event]) -> List[Tuple[int, str, str, str]]:
    """Return the compared values of the next events of this instant, at most 10000 of them."""
    same = itertools.takewhile(lambda event: event.time_ns == instant, events)
    return [event.compared for event in itertools.islice(same, _MOST_OF_AN_INSTANT)]


def _difference(place: int, mine: Optional[Event], its: Optional[Event], told: Dict[str, Deque[Event]]) -> Difference:
    nodes: List[str] = []
    for event in (mine, its):
        nodes += [node for node in ([sender(event)] if event else []) if node and node not in nodes]
    times = [event.time_ns for event in (mine, its) if event]
    return Difference(min(times), place, mine, its, {node: list(told[node]) for node in nodes if node in told})


def sender(event: Event) -> str:
    """Return the node that sent a message, call or response; for any other event, the name in its column ``robot``."""
    values: List[str] = event.row.values  # texts, except for the numbers at its end
    return values[0] if event.kind in MESSAGES and values else event.robot


def receivers(event: Event) -> List[str]:
    """Return the nodes that got a message, call or response; [] for any other event."""
    if event.kind not in MESSAGES:
        return []
    values: List[str] = event.row.values
    return values[1:len(values) - 2 - _STATUS.get(event.kind, 0)]


def told_pair(first: Optional[Event], second: Optional[Event]) -> str:
    """Return two events that differ as one line for people to read; None: that log has no more events."""
    return ' / '.join(told_lines(event) if event else 'no more events' for event in (first, second))


def told_lines(event: Event) -> str:
    """Return an event as a line for people to read."""
    at = '{:.9f} s'.format(event.time_ns * 1e-9)
    if event.kind not in MESSAGES:
        return "{}: {} '{}' {}".format(at, event.robot, event.kind, event.values)
    values = event.row.values
    return '{}: {} {} from {} to {}, {} bytes, hash {}'.format(
        at, event.kind, event.robot, values[0] or 'nobody', ', '.join(receivers(event)) or 'nobody', *values[-2:])
