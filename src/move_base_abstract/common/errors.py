"""The errors of the simulator's core.

Every text says who complains, what was got, what is allowed, and where.
"""


class SimulatorError(Exception):
    """The root of everything that this package raises on purpose."""


class ConfigurationError(SimulatorError, ValueError):
    """A parameter, a file or an argument that cannot be used."""


class FrameError(SimulatorError):
    """A pose whose coordinate frame cannot be related to the global frame."""


class TimeError(SimulatorError, ValueError):
    """An instant that is not allowed, for example one before the present."""
