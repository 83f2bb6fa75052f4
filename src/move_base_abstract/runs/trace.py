"""The rows of robots and orders, which are the same in the trace of the plain Python fleet and in a run's event log."""
from __future__ import annotations

from typing import Any, Callable, Iterable, Iterator, List, NamedTuple, Tuple

#: the kinds of rows of robots, see :class:`TraceEntry`
KINDS = ('departed', 'route', 'stands', 'ended', 'places', 'entered', 'left', 'deadlock', 'gave_way', 'zone_limit',
         'paced', 'priority', 'held', 'released', 'failed', 'repaired', 'battery', 'charging_began', 'charging_ended',
         'charge', 'motion', 'phases', 'manner', 'waiting_began', 'waiting_ended', 'works_at', 'task_began',
         'task_ended', 'meets', 'encounter', 'recorded', 'beyond', 'lapse_began', 'lapse_ended')
#: the kinds of rows of orders, and of robots that a dispatcher sends to charge, see :mod:`.orders.rows`
ORDER_KINDS = ('order_arrived', 'order_refused', 'policy_failed', 'order_assigned', 'order_stop', 'order_returned',
               'order_done', 'charge_assigned', 'charge_awaited', 'charge_over')


class TraceEntry(NamedTuple):
    """Something that happened: when [ns], to which robot, its kind, and its values.

    Positions are in m and yaws in rad, in the global frame. The kinds and their values:

    - ``departed`` (x, y, yaw of the goal); if the way has corners, ``route`` (x, y, x, y, ...) follows it;
    - ``stands`` (x, y, yaw);
    - ``ended`` (goal id, state, text);
    - ``entered`` (area) and ``left`` (area): the robot got a place in a zone or on a lane, or gave it back;
    - ``places`` (area, capacity): before the first ``entered`` of an area that has room for so many robots only;
    - ``deadlock`` (robot, area, ...): the robot closed a circle of waiting;
    - ``gave_way`` (area, ...): the robot drives back out of these areas to resolve such a circle;
    - ``zone_limit`` (zone, max_speed, 0: none): a zone has another limit; the row has the first robot by name;
    - ``paced`` (zone, max_speed): the robot goes on by that limit;
    - ``priority`` (number): the robot has this priority from now on;
    - ``held`` (reason, ...): all reasons for which the robot is held, whenever they change; ``released`` (): none;
    - ``failed`` (kind, cause), see :mod:`.failures`, and ``repaired`` ();
    - ``lapse_began`` (kind, cause; for a jump also x, y, yaw: by how much the reported pose is wrong) and
      ``lapse_ended`` (kind, cause), see :mod:`.lapse`;
    - ``recorded`` ('length', low, high [m], 'start_turn', low, high [rad], perhaps 'clearance', low, high [m]): the
      legs to which the robot's calibration was fitted, if it says so; the row comes when the robot is made;
    - ``beyond`` (name, value, ...): before ``departed`` if the goal lies outside of that, see :mod:`.recorded_range`;
    - ``meets`` (radius [m]): the robot takes part in encounters;
    - ``encounter`` (robot, kind, nearest distance [m], time for which it stands [s]), see :mod:`.encounter_law`;
    - ``battery`` (state of charge, what), see :class:`.events.ChargePassed`;
    - ``charging_began`` (zone) and ``charging_ended`` (zone);
    - ``waiting_began`` (goal id, place) and ``waiting_ended`` (goal id, place): a task waits for room;
    - ``works_at`` (goal id, place, capacity): a task has got room there; it comes before ``task_began``;
    - ``task_began`` (goal id, duration [ns]) and ``task_ended`` (goal id, state, text).

    Four kinds come only with the parameter ``log_motion``:

    - ``motion`` (x, y, yaw of the robot, then max_speed, acceleration, turn_rate, xy_goal_tolerance and
      yaw_goal_tolerance from the next leg on, as the parameters of these names; an acceleration or a turn rate of 0 has
      no limit);
    - ``phases`` (start_turn_linear [s/rad], start_turn_square [s/rad^2], braking_gain [1/s], braking_offset [m],
      turning_speed [rad/s], turning_gain [1/s], turning_offset [rad], bow_length [m] of the calibration);
    - ``manner``, after ``departed`` (rest at first [ns], travel after it [ns], way backwards at first [m] and its speed
      [m/s], time of spinning before the last turn [s] and its speed [rad/s]);
    - ``charge`` (state of charge, energy of a full battery [J], what has changed it: ``used``, ``charged`` or ``set``).
    """

    time_ns: int
    robot: str
    kind: str
    values: Any


#: the most frequent kinds of rows, with the numbers of their values
FLAT = {'departed': 6, 'stands': 6, 'ended': 6, 'entered': 4, 'left': 4}
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
