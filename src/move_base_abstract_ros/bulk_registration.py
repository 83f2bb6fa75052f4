"""Telling the ROS master of thousands of topics and services in a few calls instead of one call each.

rospy registers each topic by a call of its own, which is most of the time that a large fleet needs to start. Here the
registrations are collected while the objects are made and sent together, as rospy itself does when it unregisters.
"""
import xmlrpc.client
from contextlib import contextmanager

import rospy
from rospy.impl.registration import Registration, RegistrationListener, get_registration_listeners

_CALLS_AT_ONCE = 500
_current = None


@contextmanager
def bulk_registration():
    """Within this context, publishers, subscribers, services and :func:`set_param` reach the master at its end."""
    global _current
    listeners = get_registration_listeners()
    with listeners.lock:
        managers, listeners.listeners = listeners.listeners, []
        collector = _Collector(managers)
        listeners.listeners.append(collector)
    _current = collector
    try:
        yield
    finally:
        _current = None
        with listeners.lock:
            listeners.listeners = managers
        collector.send()


def set_param(name, value):
    """Set a parameter as rospy.set_param does; in a bulk registration, with all else that is collected."""
    if _current is None:
        rospy.set_param(name, value)
    else:
        _current.calls.append(('setParam', (rospy.resolve_name(name), value), None))


class _Collector(RegistrationListener):
    """Keeps what would have been said to the master."""

    _METHODS = {Registration.PUB: 'registerPublisher', Registration.SUB: 'registerSubscriber',
                Registration.SRV: 'registerService'}

    def __init__(self, managers):
        self._managers = managers
        self.calls = []

    def reg_added(self, resolved_name, data_type_or_uri, reg_type):
        """Note a new publisher, subscriber or service."""
        self.calls.append((self._METHODS[reg_type], (resolved_name, data_type_or_uri, rospy.get_node_uri()),
                           resolved_name if reg_type == Registration.SUB else None))

    def reg_removed(self, resolved_name, data_type_or_uri, reg_type):
        """Pass on at once that something is gone: it was there before."""
        for manager in self._managers:
            manager.reg_removed(resolved_name, data_type_or_uri, reg_type)

    def send(self):
        """Tell the master all, and the subscribers of the publishers that there are."""
        master = xmlrpc.client.ServerProxy(rospy.core.rosgraph.get_master_uri())
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
                    for manager in self._managers:
                        manager.publisher_update(topic, value)
