"""Parameters that a participant has set in its turn: it sees them itself before the ROS master has them.

Names are absolute; a parameter that is a dict contains those below it. The rules are those of the ROS master
(rosmaster.paramserver); a test compares them. This module knows no ROS.
"""
from __future__ import annotations

from collections import deque
from typing import Any, Callable, Deque, List, Optional

#: stands for the value of a parameter that does not exist
MISSING = object()
_DELETED = object()


def parts_of(name: str) -> List[str]:
    """Return the parts of an absolute name between its slashes; [] for the root."""
    return [part for part in name.split('/') if part]


class PendingParameters:
    """The changes of parameters that the ROS master does not have yet, in their order."""

    def __init__(self) -> None:
        self._changes: Deque[Any] = deque()

    def __bool__(self) -> bool:
        return bool(self._changes)

    def set(self, name: str, value: Any) -> None:
        """Add the change that a parameter is set to ``value``, which must not be modified afterwards."""
        self._changes.append((parts_of(name), value))

    def delete(self, name: Any) -> None:
        """Add the change that a parameter is deleted."""
        self._changes.append((parts_of(name), _DELETED))

    def first_is_told(self) -> None:
        """Drop the first change, because the ROS master has it, or will have it before anybody asks."""
        self._changes.popleft()

    def concern(self, name: str) -> bool:
        """Return whether any of the changes affects the value of ``name``."""
        parts = parts_of(name)
        return any(_is_below(parts, changed) or _is_below(changed, parts) for changed, _ in self._changes)

    def seen(self, name: str, current: object) -> Any:
        """Return the value of ``name`` after the changes; ``current``: the value before. Either may be MISSING."""
        parts = parts_of(name)
        tree = {} if current is MISSING else _copied(current) if not parts else {}
        if parts and current is not MISSING:
            _set(tree, parts, _copied(current))
        for changed, value in self._changes:
            if value is _DELETED:
                _delete(tree, changed)
            elif changed:
                _set(tree, changed, _copied(value))
            else:
                tree = _copied(value)
        return _get(tree, parts)

    def names(self, names: List[Any]) -> List[Any]:
        """Return the names of all parameters after the changes; ``names``: those before."""
        there = [parts_of(name) for name in names]
        for changed, value in self._changes:
            there = [parts for parts in there if not _is_below(parts, changed)]
            if value is not _DELETED:  # a parameter above it has become a dict
                there = [parts for parts in there if not _is_below(changed, parts)]
                there += [changed + below for below in _leaves(value)]
        return ['/' + '/'.join(parts) for parts in there]


def search(namespace: str, key: str, has: Callable[..., Any]) -> Optional[str]:
    """Return the name that the ROS master finds for ``key`` from ``namespace`` upwards, or None.

    ``has(name)`` returns whether a parameter exists.
    """
    if key.startswith('/'):
        return key if has(key) else None
    first = parts_of(key)[0]
    above = parts_of(namespace)
    for length in range(len(above), -1, -1):
        if has('/' + '/'.join(above[:length] + [first])):
            return '/' + '/'.join(above[:length] + [key])
    return None


def in_order(value: Any) -> Any:
    """Return the value with all its dicts in the order of their keys."""
    if isinstance(value, dict):
        return {key: in_order(value[key]) for key in sorted(value)}
    return [in_order(item) for item in value] if isinstance(value, list) else value


def _is_below(parts: List[str], above: List[str]) -> bool:
    return parts[:len(above)] == above


def _copied(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return [_copied(item) for item in value] if isinstance(value, list) else value


def _leaves(value: Any) -> Any:
    """Return the paths, as lists of parts, of all values in ``value`` that are not dicts."""
    if not isinstance(value, dict):
        return [[]]
    return [[key] + below for key, item in value.items() for below in _leaves(item)]


def _set(tree: Any, parts: List[str], value: Any) -> None:
    for part in parts[:-1]:
        if not isinstance(tree.get(part), dict):
            tree[part] = {}
        tree = tree[part]
    tree[parts[-1]] = value


def _delete(tree: Any, parts: Any) -> None:
    for part in parts[:-1]:
        tree = tree.get(part) if isinstance(tree, dict) else None
    if isinstance(tree, dict):
        tree.pop(parts[-1], None)


def _get(tree: Any, parts: List[str]) -> Any:
    for part in parts:
        if not isinstance(tree, dict) or part not in tree:
            return MISSING
        tree = tree[part]
    return tree
