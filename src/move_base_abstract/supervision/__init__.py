"""Checks whether clocks and other simulators follow the run, and whether they still run."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .clock_source import ClockSource as ClockSource
    from .follow_check import FollowCheck as FollowCheck, StampCheck as StampCheck
    from .rate_cap import RateCap as RateCap
    from .silence_watch import SilenceWatch as SilenceWatch
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
