"""The rows of a robot: the same in the trace of the plain Python fleet and in a run's event log."""
from __future__ import annotations

from typing import Any, Iterable, Iterator, NamedTuple, Tuple

#: of what happens to robots, see :class:`TraceEntry`
KINDS = ('departed', 'route', 'stands', 'ended', 'places', 'entered', 'left', 'deadlock', 'gave_way', 'zone_limit',
         'paced', 'priority', 'held', 'released', 'failed', 'repaired', 'battery', 'charging_began', 'charging_ended',
         'charge', 'motion', 'phases', 'manner', 'waiting_began', 'waiting_ended', 'works_at', 'task_began',
         'task_ended', 'meets', 'encounter', 'recorded', 'beyond', 'lapse_began', 'lapse_ended')
#: of orders, and of robots that a dispatcher sends to charge, see :mod:`.orders.rows`
ORDER_KINDS = ('order_arrived', 'order_refused', 'policy_failed', 'order_assigned', 'order_stop', 'order_returned',
               'order_done', 'charge_assigned', 'charge_awaited', 'charge_over')


class TraceEntry(NamedTuple):
    """Something that happened: when [ns], to which robot, what, and the details.

    Kinds and values: ``departed`` (x, y, yaw of the goal), ``stands`` (x, y, yaw), ``ended`` (goal id, state, text);
    ``route`` (x, y, x, y, ...), behind ``departed``: the corners of a way that has any;
    ``places`` (area, how many), before the first ``entered`` of an area with room for some robots only;
    ``entered`` (area) and ``left`` (area): it got a place in a zone or on a lane, or gave it back; ``deadlock`` (robot,
    area, ...): it closed a circle of waiting; ``gave_way`` (area, ...): it drives back out of these for such a circle;
    ``zone_limit`` (zone, max_speed, 0: none) of the first robot by name, where a zone has another limit, and ``paced``
    (zone, max_speed) of each that goes on by it; ``priority`` (number): it has this one from now on;
    ``held`` (reason, ...): for which reasons the robot is held, whenever these change, and ``released`` ();
    ``failed`` (kind, cause, see :mod:`.failures`) and ``repaired`` ();
    ``lapse_began`` (kind, cause, of a jump x, y, yaw by which the pose that it tells lies beside the true one) and
    ``lapse_ended`` (kind, cause), see :mod:`.lapse`;
    ``recorded`` ('length', low, high, 'start_turn', low, high, perhaps 'clearance', low, high), of a robot with a
    calibration that says so, when it is there: what its legs were fitted to [m, rad, m], and ``beyond`` (what, value,
    ...), before ``departed``: a goal lies outside of that, see :mod:`.recorded_range`;
    ``meets`` (radius [m]): it takes part in encounters, and
    ``encounter`` (robot, kind, nearest distance [m], how long it stands for it [s]), see :mod:`.encounter_law`;
    ``battery`` (state of charge, what, see :mod:`.events`), ``charging_began`` and ``charging_ended`` (zone);
    ``waiting_began`` and ``waiting_ended`` (goal id, place), where a task has to wait;
    ``works_at`` (goal id, place, for how many there is room there), before ``task_began`` (goal id, how
    long it will take [ns]), ``task_ended`` (goal id, state, text);
    and, where it is asked for, ``motion`` (x, y, yaw of the robot, then by what it travels from the next leg on:
    max_speed, acceleration, turn_rate, xy_goal_tolerance, yaw_goal_tolerance, as the parameters of these names, in
    which 0 is an acceleration or a turn rate without limit), and with it ``phases`` (start_turn_linear [s/rad],
    start_turn_square [s/rad^2], braking_gain [1/s], braking_offset [m], turning_speed [rad/s], turning_gain [1/s],
    turning_offset [rad], bow_length [m] of its calibration), ``manner``, behind ``departed`` (rest at first [ns], how
    long it then travels [ns], how far backwards at first [m] and how fast [m/s], how long it spins before its last turn
    [s] and how fast [rad/s]), and ``charge`` (state of charge, what a full battery holds [J], ``used``, ``charged`` or
    ``set``: what has changed it). Positions in m, yaw in rad, global frame.
    """

    time_ns: int
    robot: str
    kind: str
    values: Any


def as_entries(rows: Iterable[Tuple[Any, ...]]) -> Iterator[TraceEntry]:
    """Return the rows of events as :class:`TraceEntry` objects: what nobody reads need not be made."""
    return (TraceEntry(row[0], row[1], row[2], row[3:]) for row in rows)
