"""Selects and sorts the ROS master's registrations for participants, so that they are the same in each run.

The ROS master answers in the order of registration, and knows all nodes: participants, nodes that have left the run,
and onlookers. So its answer would depend on which node registered first, and on which is slow to leave. This module
knows no ROS and asks no node.
"""
from __future__ import annotations

from typing import Any, Collection, FrozenSet, List, Optional, Set

#: nodes that each system has, already before the run
KNOWN = ('/rosout', '/time_master')
_OF_EACH_NODE = '/rosout'  # the topic that each node publishes
_SERVICES_OF_EACH_NODE = ('/get_loggers', '/set_logger_level')


class Registrations:
    """The part of ``state``, the ROS master's publishers, subscribers and services, that participants see.

    ``present``: the names of the participants; ``gone``: the names of nodes that were participants. Another node is
    seen only if it offers a topic or a service besides those that each node has; a node that only listens is not seen.
    """

    def __init__(self, state: List[List[List[Any]]], present: Collection[str], gone: Collection[str]) -> None:
        self._present = frozenset(present)
        self._gone = frozenset(gone) - self._present
        publishers, subscribers, services = state
        self._registered = services
        offered = {node for name, nodes in publishers if name != _OF_EACH_NODE for node in nodes}
        offered |= {node for name, nodes in services if not name.endswith(_SERVICES_OF_EACH_NODE) for node in nodes}
        self._shown = self._present.union(KNOWN) | (offered - self._gone)
        takes_part = self._present.union(KNOWN)
        self._publishers = _of(publishers, self._shown)
        self._subscribers = _of(subscribers, takes_part)
        self._services = _of(services, self._shown)

    def state(self) -> List[List[List[Any]]]:
        """Return [publishers, subscribers, services], each [[name, [node, ...]], ...], sorted by names and nodes."""
        return [self._publishers, self._subscribers, self._services]

    def topics(self, pairs: List[List[str]]) -> List[List[str]]:
        """Return, sorted, the [topic, type] in ``pairs`` that a node seen publishes or a participant subscribes to."""
        there = {name for name, _ in self._publishers + self._subscribers}
        return sorted(pair for pair in pairs if pair[0] in there)

    def published(self, pairs: List[List[str]]) -> List[List[str]]:
        """Return, sorted, the [topic, type] in ``pairs`` that a node seen publishes."""
        there = {name for name, _ in self._publishers}
        return sorted(pair for pair in pairs if pair[0] in there)

    def only_gone_serve(self, service: str) -> bool:
        """Return whether a service is registered only by nodes that no longer take part."""
        nodes = [node for name, nodes in self._registered if name == service for node in nodes]
        return bool(nodes) and self._gone.issuperset(nodes)

    def strangers(self, topics: Optional[Set[str]] = None) -> List[str]:
        """Return, sorted, the nodes seen that take no part; ``topics``: only those that publish one of these."""
        groups = self._publishers + self._services if topics is None else [
            entry for entry in self._publishers if entry[0] in topics]
        return sorted({node for _, nodes in groups for node in nodes} - self._present - set(KNOWN))


def _of(entries: List[List[Any]], shown: FrozenSet[str]) -> List[List[Any]]:
    kept = [[name, sorted(node for node in nodes if node in shown)] for name, nodes in entries]
    return sorted(entry for entry in kept if entry[1])
