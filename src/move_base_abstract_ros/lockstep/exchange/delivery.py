"""Which messages have any effect on a subscription: action clients subscribe to more than most programs need.

A client of actionlib subscribes to feedback in any case. If none of its goals has a feedback callback, feedback changes
nothing in it. A status that it has seen before changes nothing, either. The time master is told so, and then time does
not stop for such messages. From its first feedback callback on, a client hears all feedback. All other subscriptions
hear all messages.

The listener of tf2 only puts transforms into a buffer. The program looks for them when it has something else to do, and
gets them then.
"""
from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, Callable, List, Optional, Tuple

from rospy.impl import registration

from move_base_abstract.lockstep.wire import Delivery

from ...replacing.replaced import replace

if TYPE_CHECKING:
    from .topics import Topics


class Deliveries:
    """What one participant has chosen for its subscriptions. ``topics.choose(impl, what)`` is called at each change."""

    def __init__(self, topics: Topics) -> None:
        self._topics = topics
        # (a subscription's implementation, its Delivery), for subscriptions that do not hear all
        self._told: List[Tuple[Any, Delivery]] = []

    def install(self) -> None:
        """Follow callbacks of subscriptions, and those of action clients."""
        self._follow_callbacks()
        self._follow_clients()
        for impl in registration.get_topic_manager().subs.values():
            self._look_at(impl)

    def forget(self, impl: Any) -> None:
        """Forget a subscription that has ended."""
        self._told = [(other, what) for other, what in self._told if other is not impl]

    def _follow_callbacks(self) -> None:
        def looking(change: Callable[..., Any]) -> Callable[..., Any]:
            def _change(impl: Any, *args: Any) -> None:
                change(impl, *args)
                self._look_at(impl)
            return _change

        replace('rospy.topics._SubscriberImpl.add_callback', looking)
        replace('rospy.topics._SubscriberImpl.remove_callback', looking)

    def _follow_clients(self) -> None:
        """Check the subscriptions again at an action client's first feedback callback."""
        def beginning(init_goal: Callable[..., Any]) -> Callable[..., Any]:
            def _init_goal(manager: Any, goal: Any, transition_cb: Optional[Callable[..., Any]] = None,
                           feedback_cb: Optional[Callable[..., Any]] = None) -> Any:
                if feedback_cb is not None and not _passes_to_nobody(feedback_cb):
                    manager.hears_feedback = True
                    self._look_again()
                return init_goal(manager, goal, transition_cb, feedback_cb)
            return _init_goal

        replace('actionlib.action_client.GoalManager.init_goal', beginning)
        self._follow_simple_clients()

    def _follow_simple_clients(self) -> None:
        """Notice the feedback callback of a simple client: it has one for all goals, and programs may also set it."""
        def get(client: Any) -> Any:
            return client.__dict__.get('feedback_cb')

        def put(client: Any, callback: Any) -> None:
            client.__dict__['feedback_cb'] = callback
            if callback is not None:
                client.action_client.manager.hears_feedback = True
                self._look_again()
        replace('actionlib.simple_action_client.SimpleActionClient.feedback_cb', lambda _none: property(get, put))

    def _look_at(self, impl: Any) -> None:
        if impl.closed:
            return  # its callbacks are gone
        chosen = [self._chosen_by(callback) for callback, _ in impl.callbacks] or [Delivery.ALL]
        is_mixed = Delivery.LATER in chosen and min(chosen) != Delivery.LATER
        what = Delivery.ALL if is_mixed else max(chosen)
        before = next((chosen for other, chosen in self._told if other is impl), Delivery.ALL)
        if what != before:
            self.forget(impl)
            if what != Delivery.ALL:
                self._told.append((impl, what))
            self._topics.choose(impl, what)

    def _look_again(self) -> None:
        for impl, _ in self._told[:]:
            self._look_at(impl)

    def _chosen_by(self, callback: Any) -> Delivery:
        """Return which messages (Delivery) have an effect on a callback."""
        from actionlib.action_client import ActionClient  # only now: the locks that it makes are replaced ones
        client, function = getattr(callback, '__self__', None), getattr(callback, '__func__', None)
        if _puts_transforms_by(client, function):
            return Delivery.LATER
        if not isinstance(client, ActionClient):
            return Delivery.ALL
        if function is ActionClient._status_cb:
            return Delivery.NEWS
        if function is ActionClient._feedback_cb and not getattr(client.manager, 'hears_feedback', False):
            return Delivery.NOTHING
        return Delivery.ALL


def _puts_transforms_by(listener: Any, function: Optional[Callable[..., Any]]) -> bool:
    """Return whether a callback is that of a tf2 listener whose buffer is tf2's own, without changes."""
    module, buffers = sys.modules.get('tf2_ros.transform_listener'), sys.modules.get('tf2_ros.buffer')
    if module is None or buffers is None or not isinstance(listener, module.TransformListener):
        return False
    own = [getattr(module.TransformListener, name, None) for name in ('callback', 'static_callback')]
    buffer = getattr(listener, 'buffer', None)
    return function in own and type(buffer) is buffers.Buffer and 'set_transform' not in vars(buffer)


def _passes_to_nobody(feedback_cb: Callable[..., Any]) -> bool:
    """Return whether it is the callback of a simple client that would call the program's, which is not set."""
    from actionlib.simple_action_client import SimpleActionClient
    client = getattr(feedback_cb, '__self__', None)
    return (isinstance(client, SimpleActionClient)
            and getattr(feedback_cb, '__func__', None) is SimpleActionClient._handle_feedback
            and client.feedback_cb is None)
