"""The errors of the simulator's core.

Every text says who complains, what was got, what is allowed, and where.
"""


class SimulatorError(Exception):
    """The base class of all errors that this package raises on purpose."""


class ConfigurationError(SimulatorError, ValueError):
    """A parameter, a file or an argument cannot be used."""


class FrameError(SimulatorError):
    """The coordinate frame of a pose cannot be related to the global frame."""


class TimeError(SimulatorError, ValueError):
    """An instant is not allowed, for example because it is before the present."""
