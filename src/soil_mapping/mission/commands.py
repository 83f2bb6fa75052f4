"""What the coordinator and an engine say to each other. Places are in the map frame [m], x east, y north."""

from typing import NamedTuple, Optional


class Drive(NamedTuple):
    """Send a robot to a place; answer with Coordinator.arrived, or failed."""

    robot: int
    task: int  # number of the task, >= 0
    x: float
    y: float


class TakeSample(NamedTuple):
    """Let a robot sample where it stands for so long; answer with Coordinator.sampled."""

    robot: int
    task: int  # number of the task; FIRST_SAMPLE for the one that a robot takes at its start
    dwell_ns: int  # simulated ns


class Stop(NamedTuple):
    """Cancel what a robot is doing: the mission is over. No answer is wanted."""

    robot: int


class Place(NamedTuple):
    """Where a robot is, and how far it has driven since it was last heard of."""

    x: float
    y: float
    driven_m: Optional[float] = None  # None: as far as the straight line between the two places


FIRST_SAMPLE = -1  # instead of a task's number
