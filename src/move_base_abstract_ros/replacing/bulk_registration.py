"""Register thousands of topics and services with the ROS master in a few calls, instead of one call for each.

rospy registers each topic by a call of its own, which takes most of the time that a large fleet needs to start. Here
the registrations are collected while the objects are made, and then sent together, as rospy itself does when it
unregisters. Parameters are read from one copy of the tree. A topic that is made here opens a file descriptor when its
first connection comes, not from the start: a thousand robots would need more than a process may have.
"""
from __future__ import annotations

import threading
import xmlrpc.client
from contextlib import contextmanager, suppress
from typing import Any, Collection, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple

import rosgraph
import rospy
import rospy.topics
from rospy.impl.registration import Registration, RegistrationListener, get_registration_listeners, get_topic_manager
from rospy.impl.statistics import SubscriberStatisticsLogger

from .replaced import replace, replaced

_CALLS_AT_ONCE = 500

#: held while registrations are collected. A thread that holds it registers at once, whatever other threads do
at_once = threading.RLock()


class _State:
    """The bulk registration that is under way, if there is one."""

    collector: Optional[_Collector] = None


@contextmanager
def bulk_registration() -> Iterator[None]:
    """Give a context: publishers, subscribers, services and :func:`set_params` in it reach the master at its end."""
    with at_once, _collecting():
        yield


@contextmanager
def _collecting() -> Iterator[None]:
    listeners = get_registration_listeners()
    with listeners.lock:
        managers, listeners.listeners = listeners.listeners, []
        collector = _Collector(managers)
        listeners.listeners.append(collector)
    _State.collector = collector
    with_statistics = SubscriberStatisticsLogger.is_enabled()
    _check_only_what_is_connected(get_topic_manager())
    try:
        with replaced('rospy.impl.statistics.SubscriberStatisticsLogger.is_enabled',
                      lambda _asking: staticmethod(lambda: with_statistics)), \
                replaced('rospy.topics.Poller', lambda _poller: _LazyPoller):
            yield
    finally:
        _State.collector = None
        with listeners.lock:
            listeners.listeners = managers
        collector.send()


def get_namespace(name: str) -> Dict[str, Any]:
    """Return {key: value} of all parameters below ``name``, an absolute name."""
    if _State.collector is None:
        found = rospy.get_param(name, {})
    else:
        found = _State.collector.parameters
        for part in name.strip('/').split('/'):
            found = found.get(part, {}) if isinstance(found, dict) else {}
    return found if isinstance(found, dict) else {}


def set_params(namespace: str, values: Mapping[str, Any]) -> None:
    """Set {key: value} below ``namespace``, an absolute name. Other parameters there stay."""
    if _State.collector is None:
        for key, value in values.items():
            rospy.set_param('{}/{}'.format(namespace, key), value)
    else:
        _State.collector.set_params(namespace, values)


def delete_params(namespace: str, keys: Collection[str]) -> None:
    """Delete the parameters ``keys`` below ``namespace``, an absolute name, and the namespace if nothing is left."""
    if not namespace.strip('/'):
        return
    there = rospy.get_param(namespace, None)
    if not isinstance(there, dict):
        return
    gone = [namespace] if all(key in keys for key in there) else [
        '{}/{}'.format(namespace, key) for key in keys if key in there]
    for name in gone:
        with suppress(KeyError):  # another node was faster
            rospy.delete_param(name)


def _check_only_what_is_connected(manager: Any) -> None:
    """Make rospy's regular search for broken connections skip topics without connections."""
    def check_all() -> None:
        with manager.lock:
            topics = [topic for group in (manager.pubs, manager.subs) for topic in group.values() if topic.connections]
        for topic in topics:
            topic.check()

    replace('rospy.topics._TopicManager.check_all', lambda _original: check_all, on=manager)


class _PlainTransport(xmlrpc.client.Transport):
    """Asks for answers without compression, because they come from this machine or one near by."""

    accept_gzip_encoding = False


class _LazyPoller:
    """Makes rospy's Poller of a topic's connections when the first connection comes."""

    _Poller = rospy.topics.Poller

    def __init__(self) -> None:
        self._poller: Any = None

    def add_fd(self, fd: int) -> None:
        """Watch a connection, by its file descriptor."""
        if self._poller is None:
            self._poller = self._Poller()
        self._poller.add_fd(fd)

    def remove_fd(self, fd: Optional[int]) -> None:
        """Stop watching a connection."""
        if self._poller is not None:
            self._poller.remove_fd(fd)

    def error_iter(self) -> Iterable[Any]:
        """Return the connections that have failed."""
        return self._poller.error_iter() if self._poller is not None else ()


class _Collector(RegistrationListener):
    """Collects the calls to the ROS master, and sends them together."""

    _METHODS = {Registration.PUB: 'registerPublisher', Registration.SUB: 'registerSubscriber',
                Registration.SRV: 'registerService'}

    def __init__(self, managers: Sequence[Any]) -> None:
        self._managers = managers
        self.calls: List[Tuple[str, Tuple[Any, ...], Optional[str]]] = []  # method, arguments, topic to connect
        # Not rospy.get_param: for '/' it returns only the parameters in its cache.
        self.parameters = rosgraph.Master(rospy.get_name()).getParam('/')

    def set_params(self, namespace: str, values: Mapping[str, Any]) -> None:
        """Note parameters to be set. If the namespace is empty, it is set as a whole, in one call."""
        there = get_namespace(namespace)
        if not there:
            self.calls.append(('setParam', (namespace, values), None))
            return
        for key, value in values.items():
            self.calls.append(('setParam', ('{}/{}'.format(namespace, key), value), None))

    def reg_added(self, resolved_name: str, data_type_or_uri: str, reg_type: str) -> None:
        """Note a new publisher, subscriber or service."""
        self.calls.append((self._METHODS[reg_type], (resolved_name, data_type_or_uri, rospy.get_node_uri()),
                           resolved_name if reg_type == Registration.SUB else None))

    def reg_removed(self, resolved_name: str, data_type_or_uri: str, reg_type: str) -> None:
        """Unregister something at once, because it was registered before."""
        for manager in self._managers:
            manager.reg_removed(resolved_name, data_type_or_uri, reg_type)

    def send(self) -> None:
        """Send all calls to the ROS master, and connect subscribers to the publishers that it names."""
        master = xmlrpc.client.ServerProxy(rosgraph.get_master_uri(), transport=_PlainTransport())
        for begin in range(0, len(self.calls), _CALLS_AT_ONCE):
            calls = self.calls[begin:begin + _CALLS_AT_ONCE]
            multicall = xmlrpc.client.MultiCall(master)
            for method, arguments, _ in calls:
                getattr(multicall, method)(rospy.get_name(), *arguments)
            for (method, arguments, topic), (code, message, value) in zip(calls, multicall()):
                if code != 1:
                    rospy.logfatal('%s: the ROS master refuses %s of %s: %s', rospy.get_name(), method, arguments[0],
                                   message)
                elif topic is not None:
                    self._connect(topic, value)

    def _connect(self, topic: str, uris: Sequence[str]) -> None:
        """Connect the subscription of ``topic`` to its publishers, unless all of them are connected."""
        subscription = get_topic_manager().get_subscriber_impl(topic)
        if subscription is None or all(subscription.has_connection(uri) for uri in uris):
            return
        for manager in self._managers:
            manager.publisher_update(topic, uris)
