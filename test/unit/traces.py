"""What fleets have recorded, as rows."""

S = 10 ** 9  # ns


def rows(fleet, *kinds):
    """Return what was recorded of some kinds: [(time [s], robot, kind, *values)]."""
    return [(entry.time_ns / S, entry.robot, entry.kind, *entry.values) for entry in fleet.trace if entry.kind in kinds]


def leg_of(fleet, name='bot'):
    """Return the leg that a robot travels, or None."""
    return fleet.robot(name)._robot.leg


def rows_of_one(fleet, *kinds):
    """Return the same of a fleet of one robot: [(time [s], kind, *values)]."""
    return [(time, kind, *values) for time, _, kind, *values in rows(fleet, *kinds)]
