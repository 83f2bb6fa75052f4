"""The rows of robots and orders, which are the same in the trace of the plain Python fleet and in a run's event log."""
from __future__ import annotations

from typing import Any, Callable, Iterable, Iterator, List, NamedTuple, Tuple


class RowKind(NamedTuple):
    """A kind of rows: its ``values`` and ``words``, which say when it comes, as the page has them.

    ``of``: 'robots'; 'motion' if the rows come only with the parameter ``log_motion``; 'orders' if a dispatcher writes
    them.
    """

    kind: str
    values: str
    words: str
    of: str = 'robots'


#: all kinds; positions are in m and yaws in rad, in the global frame
ROW_KINDS = (
    RowKind('goal',
            'goal id',
            'the robot takes in a goal. The row comes before all others that follow from the goal: before `ended` of '
            'the goal that it replaces, and before `ended` of a goal that is recalled or aborted at once. A '
            '[silent](failures.md) robot takes in the goals that came meanwhile when it answers again. A goal whose id '
            'the robot knows already is no new goal'),
    RowKind('departed', 'x, y, yaw of the goal', 'the robot departs for its goal'),
    RowKind('route', 'x, y, x, y, ...', 'after `departed`: the corners of the way, if it has any'),
    RowKind('stands', 'x, y, yaw', 'the robot has arrived, was stopped, or was placed there'),
    RowKind('ended', 'goal id, state, text', 'a goal has ended'),
    RowKind('held',
            'reason, ...',
            'all reasons for which the robot is held, whenever they change. It stands with its goal ACTIVE, and '
            'then goes on from rest, by a way that is planned again'),
    RowKind('released', '', 'nothing holds the robot any more'),
    RowKind('priority', 'number', 'the robot has this [priority](zones.md#priorities) from now on'),
    RowKind('places', 'area, capacity', 'before the first `entered` of an area that has room for so many robots only'),
    RowKind('entered', 'area', 'the robot got a place in a [zone](zones.md) or on a lane'),
    RowKind('left', 'area', 'it gave that place back'),
    RowKind('deadlock', 'robot, area, ...', 'the robot closed a circle of waiting'),
    RowKind('gave_way', 'area, ...', 'the robot drives back out of these areas, to resolve such a circle'),
    RowKind('zone_limit', 'zone, max_speed (0: none)', 'a zone has another limit; the row has the first robot by name'),
    RowKind('paced', 'zone, max_speed', 'the robot goes on by that limit'),
    RowKind('failed', 'kind, cause', 'the robot has [failed](failures.md)'),
    RowKind('repaired', '', 'it is repaired'),
    RowKind('lapse_began',
            'kind, cause; for a jump also x, y, yaw',
            'the robot reports a [wrong pose](failures.md#on-purpose), by so much, or none'),
    RowKind('lapse_ended', 'kind, cause', 'it no longer does'),
    RowKind('battery',
            'state of charge, what',
            'the charge has passed a [threshold](battery.md#thresholds-and-empty), or was set'),
    RowKind('charging_began', 'zone', 'a charger begins to charge the robot'),
    RowKind('charging_ended', 'zone', 'it no longer does'),
    RowKind('waiting_began', 'goal id, place', 'a [task](tasks.md) waits for room'),
    RowKind('waiting_ended', 'goal id, place', 'it no longer does'),
    RowKind('works_at', 'goal id, place, capacity', 'before `task_began`: a task has got room there'),
    RowKind('task_began', 'goal id, duration [ns]', 'work on a task begins'),
    RowKind('task_ended', 'goal id, state, text', 'a task has ended'),
    RowKind('meets', 'radius [m]', 'the robot takes part in [encounters](encounters.md)'),
    RowKind('encounter',
            'robot, kind, nearest distance [m], time for which it stands [s]',
            'the robot meets another one'),
    RowKind('recorded',
            "'length', low, high [m], 'start_turn', low, high [rad], perhaps 'clearance', low, high [m]",
            'the legs to which its [calibration](calibrate.md#goals-outside-of-what-was-recorded) was fitted, '
            'when the robot is made'),
    RowKind('beyond', 'name, value, ...', 'before `departed`: the goal lies outside of that'),
    RowKind('motion',
            'x, y, yaw of the robot, max_speed, acceleration, turn_rate (0: no limit), xy_goal_tolerance, '
            'yaw_goal_tolerance',
            'the limits from the next leg on: when the robot is made, and when they change', 'motion'),
    RowKind('phases',
            'start_turn_linear [s/rad], start_turn_square [s/rad^2], braking_gain [1/s], braking_offset [m], '
            'turning_speed [rad/s], turning_gain [1/s], turning_offset [rad], bow_length [m]',
            'how a [calibrated](calibration_law.md) robot begins and ends its legs', 'motion'),
    RowKind('manner',
            'rest at first [ns], travel after it [ns], way backwards at first [m] and its speed [m/s], time of '
            'spinning before the last turn [s] and its speed [rad/s]',
            'after `departed`: a leg at its own pace', 'motion'),
    RowKind('charge',
            'state of charge, energy of a full battery [J], `used`, `charged` or `set`',
            'the charge, and what has changed it', 'motion'),
    RowKind('order_arrived',
            'order, priority, deadline [ns, an instant; 0: none], then for each stop: place (or empty), x, y [m],'
            ' action',
            'of `/dispatcher`: an order has come', 'orders'),
    RowKind('order_refused', 'order, what is wrong with it', 'of `/dispatcher`: it cannot be done', 'orders'),
    RowKind('policy_failed',
            'what is wrong',
            'of `/dispatcher`: the policy failed, or chose what cannot be done; no robot got an order then', 'orders'),
    RowKind('order_assigned',
            'order, how many times it has been given so far (1: the first time)',
            'the robot has got the order', 'orders'),
    RowKind('order_stop',
            'order, number of the stop (from 1 on), `drives`, `works` or `done`',
            'how far the robot is at a stop', 'orders'),
    RowKind('order_returned', 'order, why, number of the stop that comes next', 'the order came back', 'orders'),
    RowKind('order_done',
            'order, `done`, `late` or `failed`, ns since its arrival; with a deadline also the ns after it '
            '(negative: before it)',
            'the order is done or given up', 'orders'),
    RowKind('charge_assigned', 'charger, `low` or `idle`', 'the robot is sent to charge', 'orders'),
    RowKind('charge_awaited', '`low`', 'all chargers are taken', 'orders'),
    RowKind('charge_over', 'charger', 'the robot leaves the charger', 'orders'),
)
#: the kinds of rows that robots write
KINDS = tuple(row.kind for row in ROW_KINDS if row.of != 'orders')


class TraceEntry(NamedTuple):
    """Something that happened: when [ns], to which robot, its kind, and its values, as :data:`ROW_KINDS` says."""

    time_ns: int
    robot: str
    kind: str
    values: Any


#: the most frequent kinds of rows, with the numbers of their values
FLAT = {'goal': 4, 'departed': 6, 'stands': 6, 'ended': 6, 'entered': 4, 'left': 4}
_new = tuple.__new__  # makes a named tuple without the call of its constructor


class Rows:
    """Rows that nobody has read yet.

    The values of the kinds in FLAT follow one another in one list, without an object for each row: the objects that
    Python's garbage collector would visit again and again would become more and more.
    """

    def __init__(self) -> None:
        self._values: List[Any] = []
        #: takes a row of any kind
        self.take: Callable[[Tuple[Any, ...]], None] = self._values.append
        #: takes a row of a kind in FLAT
        self.take_flat: Callable[[Tuple[Any, ...]], None] = self._values.extend

    def read(self) -> List[TraceEntry]:
        """Return all rows as entries, and forget them."""
        values, entries, place = self._values, [], 0
        while place < len(values):
            row = values[place]
            if type(row) is tuple:
                place += 1
                time_ns, robot, kind, *rest = row
                entries.append(TraceEntry(time_ns, robot, kind, tuple(rest)))
            else:
                kind = values[place + 2]
                begin, place = place, place + FLAT[kind]
                entries.append(_new(TraceEntry, (row, values[begin + 1], kind, tuple(values[begin + 3:place]))))
        values.clear()
        return entries


def as_entries(rows: Iterable[Tuple[Any, ...]]) -> Iterator[TraceEntry]:
    """Yield the rows of events as :class:`TraceEntry` objects; they are made only when somebody reads them."""
    return (TraceEntry(row[0], row[1], row[2], row[3:]) for row in rows)
