"""Questions to the ROS master, which takes no part, about what is there at this instant.

The answer would depend on who was faster in this round. So who asks waits until nobody who takes part has anything left
to do at this instant: what is started by one launch file is there, whoever was slower. And who asks does what follows
from the answer a round later: of two who ask at once neither sees what the other has made of its answer.
"""
from move_base_abstract.lockstep.scheduler import TurnLost

from ..replaced import replace
from .looks import STEP_NS

#: names of what asks
QUESTIONS = (*('rosgraph.masterapi.Master.' + name for name in (
    'getPublishedTopics', 'getTopicTypes', 'getSystemState', 'lookupNode', 'lookupService')),
    'rospy.get_published_topics', 'rospy.client.get_published_topics')
#: so many rounds bring links, what is latched on them, and an answer
ROUNDS = 10
#: so many questions in a row are a loop that waits by asking
ASKED = 100


def install(participant):
    """Have the application's threads wait before they ask."""
    asked = _Asked(participant.scheduler)
    for name in QUESTIONS:
        replace(name, lambda question: _after_others(participant.scheduler, question, asked))


class _Asked:
    """How many questions have been asked in a row, with no more time between them than passes at a loop that asks."""

    def __init__(self, scheduler):
        self._scheduler = scheduler
        self._last_ns = 0
        self._count = 0

    def once_more(self):
        """Count one; who asks without end, and without a sleep, lets time go on as who looks."""
        now_ns = self._scheduler.now_ns
        self._count = self._count + 1 if now_ns <= self._last_ns + STEP_NS else 1
        if self._count > ASKED:
            self._scheduler.look_away(STEP_NS)
        self._last_ns = self._scheduler.now_ns


def settle(scheduler):
    """Let come what is on its way at this instant, for a thread that will wait by the wall: who asks comes after it."""
    for _ in range(ROUNDS):
        scheduler.wait_round()


def _after_others(scheduler, question, asked):
    def ask(*args, **kwds):
        if not scheduler.is_mine():
            return question(*args, **kwds)
        try:
            asked.once_more()
            scheduler.rest()
            answer = question(*args, **kwds)
            scheduler.wait_round()
            return answer
        except TurnLost:
            return question(*args, **kwds)
    ask.__doc__ = question.__doc__
    return ask
