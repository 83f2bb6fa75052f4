"""What a Profile says at an instant, and its inverse; pieces of motion are made from the same phases."""


def covered(profile, elapsed):
    """Return the distance [m] covered ``elapsed`` [s] after the start, clamped to the trip."""
    if elapsed >= profile.seconds:
        return profile.distance
    return 0.0 if elapsed <= 0.0 else min(profile.distance, _phase(profile, 0, elapsed).at(elapsed)[0])


def speed(profile, elapsed):
    """Return the speed [m/s] at ``elapsed`` [s] after the start; 0 outside the trip."""
    return _phase(profile, 0, elapsed).at(elapsed)[1] if 0.0 <= elapsed < profile.seconds else 0.0


def elapsed_at(profile, way):
    """Return the time [s after the start] at which ``way`` [m] are covered, clamped to the trip."""
    return min(profile.seconds, _phase(profile, 1, way).elapsed(way) if profile.phases else 0.0)


def _phase(profile, field, value):
    return [phase for phase in profile.phases if phase[field] <= value or phase is profile.phases[0]][-1]
