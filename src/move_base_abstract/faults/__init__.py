"""Faults of a robot: failures and deliberate faults, when they come, and the robot's present condition."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .condition import Condition as Condition
    from .failing import Failing as Failing, Failure as Failure
    from .failures import Failures as Failures, read_failures as read_failures
else:
    from ..common.lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
