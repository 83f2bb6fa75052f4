"""Which messages have any effect: an action client subscribes to more than most of its users ever ask for.

A client of actionlib subscribes to feedback in any case. Where no goal of it has a feedback callback, feedback changes
nothing in it. And a status that it has seen before changes nothing. The time master is told so: then time does not stop
for these. A client hears feedback from the first callback on, for good. What is not known to be deaf hears all.

The listener of tf2 only puts transforms into a buffer: whoever looks for them does so when it has something else to do,
and gets them then.
"""
import sys

from rospy.impl import registration

from move_base_abstract.lockstep.wire import Hearing as Heard

from ...replacing.replaced import replace


class Hearing:
    """Of one participant; ``topics`` has ``tell_hearing(impl, what)``."""

    def __init__(self, topics):
        self._topics = topics
        self._told = []  # (a subscription's implementation, what it hears), of those that do not hear all
        self._client_type = None

    def install(self):
        """Follow callbacks of subscriptions, and those of action clients."""
        self._follow_callbacks()
        try:
            from actionlib.action_client import ActionClient
        except ImportError:
            pass  # then nobody here uses it
        else:
            self._client_type = ActionClient
            self._follow_clients()
        for impl in registration.get_topic_manager().subs.values():
            self._look_at(impl)

    def forget(self, impl):
        """A subscription has ended."""
        self._told = [(other, what) for other, what in self._told if other is not impl]

    def _follow_callbacks(self):
        def looking(change):
            def _change(impl, *args):
                change(impl, *args)
                self._look_at(impl)
            return _change

        replace('rospy.topics._SubscriberImpl.add_callback', looking)
        replace('rospy.topics._SubscriberImpl.remove_callback', looking)

    def _follow_clients(self):
        """Look again at an action client from its first feedback callback on."""
        def beginning(init_goal):
            def _init_goal(manager, goal, transition_cb=None, feedback_cb=None):
                if feedback_cb is not None and not _passes_to_nobody(feedback_cb):
                    manager.hears_feedback = True
                    self._look_again()
                return init_goal(manager, goal, transition_cb, feedback_cb)
            return _init_goal

        replace('actionlib.action_client.GoalManager.init_goal', beginning)
        self._follow_simple_clients()

    def _follow_simple_clients(self):
        """A simple client has one callback for all goals, which users may also set."""
        def get(client):
            return client.__dict__.get('feedback_cb')

        def put(client, callback):
            client.__dict__['feedback_cb'] = callback
            if callback is not None:
                client.action_client.manager.hears_feedback = True
                self._look_again()
        replace('actionlib.simple_action_client.SimpleActionClient.feedback_cb', lambda _none: property(get, put))

    def _look_at(self, impl):
        if impl.closed:
            return  # its callbacks are gone
        heard = [self._heard_by(callback) for callback, _ in impl.callbacks] or [Heard.ALL]
        is_mixed = Heard.LATER in heard and min(heard) != Heard.LATER
        what = Heard.ALL if is_mixed else max(heard)
        before = next((heard for other, heard in self._told if other is impl), Heard.ALL)
        if what != before:
            self.forget(impl)
            if what != Heard.ALL:
                self._told.append((impl, what))
            self._topics.tell_hearing(impl, what)

    def _look_again(self):
        for impl, _ in self._told[:]:
            self._look_at(impl)

    def _heard_by(self, callback):
        """Return what has an effect on a callback."""
        client, function = getattr(callback, '__self__', None), getattr(callback, '__func__', None)
        if _puts_transforms_by(client, function):
            return Heard.LATER
        if self._client_type is None or not isinstance(client, self._client_type):
            return Heard.ALL
        if function is self._client_type._status_cb:
            return Heard.NEWS
        if function is self._client_type._feedback_cb and not getattr(client.manager, 'hears_feedback', False):
            return Heard.NOTHING
        return Heard.ALL


def _puts_transforms_by(listener, function):
    """Return whether a callback is that of a listener of tf2, whose buffer is tf2's own, too."""
    module, buffers = sys.modules.get('tf2_ros.transform_listener'), sys.modules.get('tf2_ros.buffer')
    if module is None or buffers is None or not isinstance(listener, module.TransformListener):
        return False
    own = [getattr(module.TransformListener, name, None) for name in ('callback', 'static_callback')]
    buffer = getattr(listener, 'buffer', None)
    return function in own and type(buffer) is buffers.Buffer and 'set_transform' not in vars(buffer)


def _passes_to_nobody(feedback_cb):
    """Return whether it is a simple client's own, which hands over to a callback that nobody has given."""
    from actionlib.simple_action_client import SimpleActionClient
    client = getattr(feedback_cb, '__self__', None)
    return (isinstance(client, SimpleActionClient)
            and getattr(feedback_cb, '__func__', None) is SimpleActionClient._handle_feedback
            and client.feedback_cb is None)
