"""Who is there, of what the ROS master knows: the same in each run, whoever registered first, or is slow to go.

The ROS master answers in the order of registration, and has everybody in its books: nodes of the run, nodes that have
left it, and whoever looks on. Nothing here knows ROS or asks anybody.
"""
from __future__ import annotations

from typing import Any, FrozenSet, List, Optional, Set

#: those that each system has, from before the run on
KNOWN = ('/rosout', '/time_master')
_OF_EACH_NODE = '/rosout'  # its publication
_SERVICES_OF_EACH_NODE = ('/get_loggers', '/set_logger_level')


class Registrations:
    """What participants are shown of ``state``, the ROS master's publishers, subscribers and services.

    ``present``: the names of the participants; ``gone``: of those that were. Of the others those are shown that offer
    something beside what each node has, a topic or a service; who only looks on is not.
    """

    def __init__(self, state: List[List[List[Any]]], present: List[str], gone: List[str]) -> None:
        self._present = frozenset(present)
        self._gone = frozenset(gone) - self._present
        publishers, subscribers, services = state
        offered = {node for name, nodes in publishers if name != _OF_EACH_NODE for node in nodes}
        offered |= {node for name, nodes in services if not name.endswith(_SERVICES_OF_EACH_NODE) for node in nodes}
        self._shown = self._present.union(KNOWN) | (offered - self._gone)
        takes_part = self._present.union(KNOWN)
        self._publishers = _of(publishers, self._shown)
        self._subscribers = _of(subscribers, takes_part)
        self._services = _of(services, self._shown)

    def state(self) -> List[List[List[Any]]]:
        """Return publishers, subscribers and services: names and nodes in the order of their bytes."""
        return [self._publishers, self._subscribers, self._services]

    def topics(self, pairs: List[List[str]]) -> List[List[str]]:
        """Return those [topic, type] of ``pairs`` that somebody publishes or a participant hears, in order."""
        there = {name for name, _ in self._publishers + self._subscribers}
        return sorted(pair for pair in pairs if pair[0] in there)

    def published(self, pairs: List[List[str]]) -> List[List[str]]:
        """Return those [topic, type] of ``pairs`` that somebody publishes, in order."""
        there = {name for name, _ in self._publishers}
        return sorted(pair for pair in pairs if pair[0] in there)

    def has_gone(self, node: str) -> bool:
        """Return whether a node took part, and does so no more."""
        return node in self._gone

    def only_gone_serve(self, service: str, state: List[List[List[Any]]]) -> bool:
        """Return whether all that the ROS master has for a service are nodes that took part."""
        nodes = [node for name, nodes in state[2] if name == service for node in nodes]
        return bool(nodes) and self._gone.issuperset(nodes)

    def strangers(self, topics: Optional[Set[str]] = None) -> List[str]:
        """Return the nodes shown that take no part, in order; ``topics``: only those that publish any of these."""
        groups = self._publishers + self._services if topics is None else [
            entry for entry in self._publishers if entry[0] in topics]
        return sorted({node for _, nodes in groups for node in nodes} - self._present - set(KNOWN))


def _of(entries: List[List[Any]], shown: FrozenSet[str]) -> List[List[Any]]:
    kept = [[name, sorted(node for node in nodes if node in shown)] for name, nodes in entries]
    return sorted(entry for entry in kept if entry[1])
