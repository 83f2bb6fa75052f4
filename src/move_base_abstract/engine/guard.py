"""Unexpected errors while a robot works on a goal: they end that goal and nothing else.

An object whose methods are :func:`guarded` has a method ``break_off(error)``, which cleans up step by step
(:func:`attempt_each`), so that a step that fails does not keep the others from being done.
"""
from __future__ import annotations

import functools
import logging
from typing import TYPE_CHECKING, Any, Callable, Iterable, Tuple, TypeVar

from ..common.shown import shown_text

if TYPE_CHECKING:
    from .simulation import Simulation

Method = TypeVar('Method', bound=Callable[..., Any])


def guarded(method: Method) -> Method:
    """Decorate ``method``: an exception in it is not raised; the object's ``break_off(error)`` is called instead."""
    @functools.wraps(method)
    def guard(self: Any, *arguments: Any) -> Any:
        try:
            return method(self, *arguments)
        except Exception as error:
            return self.break_off(error)
    return guard  # type: ignore[return-value]


def attempt_each(simulation: Simulation, who: str, error: Exception,
                 steps: Iterable[Tuple[Any, ...]]) -> None:
    """Report ``error`` as an error of ``who`` (a text), and do each of ``steps``: (function, argument, ...).

    An error in a step is reported, too, and the next step follows.
    """
    simulation.report_fault(who, error)
    for function, *arguments in steps:
        try:
            function(*arguments)
        except Exception as another:
            simulation.report_fault(who, another)


def fault_text(error: BaseException) -> str:
    """Return the text with which a goal ends because of the unexpected ``error``."""
    return 'The goal cannot be worked on: {}: {}'.format(type(error).__name__, shown_text(str(error)))


def log_fault(who: str, error: BaseException) -> None:
    """Log ``error`` with its traceback, as an error of ``who``, by Python's logging."""
    logging.getLogger('move_base_abstract').error('%s: %s', who, fault_text(error), exc_info=error)
