"""The commands of the coordinator to an engine, and the places that it gets. Map frame [m], x east, y north."""

from typing import NamedTuple, Optional


class Drive(NamedTuple):
    """Send a robot to a place; the engine answers with Coordinator.arrived or failed."""

    robot: int
    task: int  # number of the task, >= 0
    x: float
    y: float


class TakeSample(NamedTuple):
    """Let a robot sample where it stands, for dwell_ns; the engine answers with Coordinator.sampled."""

    robot: int
    task: int  # number of the task; FIRST_SAMPLE for the sample that a robot takes at its start
    dwell_ns: int  # simulated ns


class Stop(NamedTuple):
    """Cancel what a robot is doing, because the mission is over. The engine does not answer."""

    robot: int


class Place(NamedTuple):
    """The place of a robot, and the way that it has driven since its last Place."""

    x: float
    y: float
    driven_m: Optional[float] = None  # None: the straight line between the two places


FIRST_SAMPLE = -1  # instead of a task's number
