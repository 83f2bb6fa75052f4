"""A node takes part in lockstep, the event-driven clock, by ``lockstep.join()`` after ``rospy.init_node()``.

From then on ``rospy.sleep``, ``Rate``, ``Timer``, ``spin``, topics, services, ``wait_for_message``,
``wait_for_service`` and actionlib's clients are exact in simulated time, and the node's threads run one at a time.
docs/lockstep.md says what is part of a run and what is not.
"""
import importlib

_PLACES = {'Participant': 'participation.taking_part', 'is_lockstep': 'exchange.access', 'repetition': 'exchange.links',
           'sender': 'exchange.links', **dict.fromkeys(('join', 'node_is_there', 'participant', 'take_part'),
                                                       'participation.joining')}
__all__ = ['Participant', 'is_lockstep', 'join', 'node_is_there', 'participant', 'repetition', 'sender', 'take_part']


def __getattr__(name):
    """Import a name, and rospy with it, when it is first used: the launcher of a binary needs neither."""
    if name not in _PLACES:
        raise AttributeError('module {!r} has no attribute {!r}'.format(__name__, name))
    # Kept in the module, so that this function is called once per name.
    found = globals()[name] = getattr(importlib.import_module('.' + _PLACES[name], __name__), name)
    return found
