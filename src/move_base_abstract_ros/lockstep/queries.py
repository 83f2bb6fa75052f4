"""Questions to the ROS master, which takes no part, about what is there at this instant.

The answer would depend on who was faster in this round. So who asks waits until the others have done what they do at
this instant, and does what follows from the answer a round later: of two who ask at once neither sees what the other
has made of its answer.
"""
from move_base_abstract.lockstep.scheduler import TurnLost

from ..replaced import replace

_QUESTIONS = (*('rosgraph.masterapi.Master.' + name for name in (
    'getPublishedTopics', 'getTopicTypes', 'getSystemState', 'lookupNode', 'lookupService')),
    'rospy.get_published_topics', 'rospy.client.get_published_topics')
ROUNDS = 10


def install(participant):
    """Have the application's threads wait before they ask."""
    for name in _QUESTIONS:
        replace(name, lambda question: _after_others(participant.scheduler, question))


def settle(scheduler):
    """Let come what is on its way at this instant: links, what is latched on them, an answer."""
    for _ in range(ROUNDS):
        scheduler.wait_round()


def _after_others(scheduler, question):
    def ask(*args, **kwds):
        if not scheduler.is_mine():
            return question(*args, **kwds)
        try:
            settle(scheduler)
            answer = question(*args, **kwds)
            scheduler.wait_round()
            return answer
        except TurnLost:
            return question(*args, **kwds)
    ask.__doc__ = question.__doc__
    return ask
