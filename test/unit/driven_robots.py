"""Fleets in plain Python with one robot that is driven by velocities."""
from move_base_abstract.fleet import Fleet
from move_base_abstract.scenario import make_scenario

S = 1_000_000_000
MS = 1_000_000


def fleet_of(**parameters):
    """Return a fleet with one robot, 'r', that is driven by velocities; it begins at 0 s."""
    robot = {'name': 'r', 'driven_by': 'velocities', 'log_motion': True, **parameters}
    return Fleet(make_scenario({'robots': [robot]}), start_ns=0)


def rows(fleet, *kinds):
    """Return [(time_ns, kind), ...] of the rows of these kinds."""
    return [(row.time_ns, row.kind) for row in fleet.trace if row.kind in kinds]


def limited(low, high, slowing, speeding):
    """Return the parameters of an axis with these limits."""
    return {'has_velocity_limits': True, 'min_velocity': low, 'max_velocity': high,
            'has_acceleration_limits': True, 'min_acceleration': slowing, 'max_acceleration': speeding}
