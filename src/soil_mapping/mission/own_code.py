"""A user's own sampling or allocation, given by name: 'my_package.module:Class'. docs/soil_study.md has the interface.

All that a user's class returns is checked, and its exceptions are reported with its name. So a mistake ends a mission
with a sentence that says where the mistake is.
"""
from __future__ import annotations

import hashlib
import importlib
import importlib.util
import math
import operator
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Sequence, Tuple, Union

from move_base_abstract.common.errors import ConfigurationError

from .allocation import Allocator
from .sampling import Task

if TYPE_CHECKING:
    from ..config import Allocation, Sampling, TrialConfig
    from ..ground_truth.grid import Grid

ROLES = {'sampling': ('new_tasks',), 'allocation': ('allocate',)}  # and the methods that each must have


def is_own(value: Union[str, Allocation, Sampling]) -> bool:
    """Return whether a TrialConfig's sampling or allocation names a user's class."""
    return not isinstance(value, Enum)


def load_class(role: str, name: str) -> Any:
    """Return the class that 'module:Class' names. :raises ConfigurationError: if it cannot be loaded, and why."""
    module_name, _, class_name = name.partition(':')
    try:
        module = importlib.import_module(module_name)
    except Exception as error:
        raise ConfigurationError(f'{role} {name!r}: cannot import {module_name}: {type(error).__name__}: {error}; it '
                                 'must be in a workspace that is sourced, or on PYTHONPATH') from error
    found = getattr(module, class_name, None)
    if not isinstance(found, type):
        raise ConfigurationError(f'{role} {name!r}: {module_name} ({module.__file__}) has no class {class_name}')
    missing = [method for method in ROLES[role] if not callable(getattr(found, method, None))]
    if missing:
        raise ConfigurationError(f'{role} {name!r}: the class has no method {missing[0]}')
    return found


def own_code(config: TrialConfig) -> Dict[str, str]:
    """Return {name: SHA-256 of its file} for the user's classes that a TrialConfig names."""
    found = {}
    for role in ROLES:
        name = getattr(config, role)
        if is_own(name):
            load_class(role, name)
            file: Any = importlib.util.find_spec(name.partition(':')[0]).origin  # type: ignore[union-attr]
            found[name] = hashlib.sha256(Path(file).read_bytes()).hexdigest()
    return found


class OwnSampling:
    """A user's sampling with the mission's interface. It numbers the tasks and checks their places."""

    def __init__(self, config: TrialConfig, seed: int, grid: Grid) -> None:
        self._name, self._grid, self._made = config.sampling, grid, 0
        kind = load_class('sampling', self._name)
        self._own: Any = _guarded('sampling', self._name, '__init__', lambda: kind(config, seed, grid))
        self.first_samples = bool(getattr(self._own, 'first_samples', True))

    @property
    def exhausted(self) -> bool:
        """Whether no more tasks will be made; False if the class does not say."""
        return bool(getattr(self._own, 'exhausted', False))

    def new_tasks(self, estimate: Any) -> List[Task]:
        """Return the tasks that the user's class makes; estimate: an Estimate, or None if there is no map yet."""
        places = _guarded('sampling', self._name, 'new_tasks', lambda: list(self._own.new_tasks(estimate)))
        tasks = [Task(self._made + index, *self._checked(place)) for index, place in enumerate(places)]
        self._made += len(tasks)
        return tasks

    def _checked(self, place: Any) -> Tuple[float, float]:
        try:
            x, y = map(float, place)
        except (TypeError, ValueError):
            x = y = math.nan
        if not (0.0 <= x <= self._grid.width_m and 0.0 <= y <= self._grid.height_m):
            raise ConfigurationError(f'sampling {self._name!r}: new_tasks must return places (x, y) within the field, '
                                     f'0 to {self._grid.width_m:g} and 0 to {self._grid.height_m:g} m, '
                                     f'got {place!r:.200}')
        return x, y


class OwnAllocator(Allocator):
    """The queues of all robots, filled by a user's class."""

    def __init__(self, config: TrialConfig, seed: int, grid: Grid,
                 places: Any) -> None:
        super().__init__(None, places)
        self._name = config.allocation
        kind = load_class('allocation', self._name)
        self._own: Any = _guarded('allocation', self._name, '__init__', lambda: kind(config, seed, grid))

    def allocate(self, task: Task) -> int:
        """Put a task where the user's class wants it; return the robot's index."""
        queues, free_at = tuple(map(tuple, self.queues)), tuple(self._free_at)
        answer = _guarded('allocation', self._name, 'allocate', lambda: self._own.allocate(task, queues, free_at))
        try:
            robot, position = map(operator.index, answer)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            robot = position = -1
        if not (0 <= robot < len(queues) and 0 <= position <= len(queues[robot])):
            raise ConfigurationError(f'allocation {self._name!r}: allocate must return (robot, place in its queue), '
                                     f'with queues of {", ".join(str(len(queue)) for queue in queues)} tasks, got '
                                     f'{answer!r:.200}')
        self.queues[robot].insert(position, task)
        return robot


def _guarded(role: str, name: str, method: str, call: Callable[..., Any]) -> Sequence[Union[Tuple[float, float], int]]:
    try:
        return call()
    except ConfigurationError:
        raise
    except Exception as error:
        raise ConfigurationError(f'{role} {name!r}: {method} failed: {type(error).__name__}: {error}') from error
