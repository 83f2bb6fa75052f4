"""Questions to the ROS master, which takes no part, about who is there at this instant.

The answer would depend on who was faster in this round. So who asks waits until nobody who takes part has anything left
to do at this instant: what is started by one launch file is there, whoever was slower. And who asks does what follows
from the answer a round later: of two who ask at once neither sees what the other has made of its answer.

Shown are participants, and of the others those that offer something: whose name labels the run.
"""
from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.registrations import KNOWN, Registrations
from move_base_abstract.lockstep.scheduler import TurnLost

from .master_calls import aside

#: so many rounds bring links, what is latched on them, and an answer
ROUNDS = 10
#: so many questions in a row are a loop that waits by asking
ASKED = 100


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


class Queries:
    """Of one participant; for its thread that has the turn. ``master``: a proxy of the ROS master."""

    def __init__(self, participant, master):
        self._participant = participant
        self._master = master
        self._told = set()
        self._asked = _Asked(participant.scheduler)

    def answers(self):
        """Return {method: answer(ask, *arguments)}."""
        return {'getPublishedTopics': self._after_others(self._published), 'getTopicTypes':
                self._after_others(self._types), 'getSystemState': self._after_others(self._state),
                'lookupNode': self._after_others(self._node), 'lookupService': self._after_others(self._service)}

    def _after_others(self, answer):
        def ask_who(ask, *arguments):
            scheduler = self._participant.scheduler
            try:
                self._asked.once_more()
                scheduler.rest()
                told = answer(ask, *arguments)
                scheduler.wait_round()
                return told
            except TurnLost:
                return ask()
        return ask_who

    def _registrations(self):
        """Return what is to be shown, and what the ROS master knows."""
        with aside():
            code, _, state = self._master.getSystemState(self._participant.members.own_name)
        state = state if code == 1 else [[], [], []]
        return Registrations(state, self._participant.members.there, self._participant.members.gone), state

    def _published(self, ask, *_arguments):
        code, message, pairs = ask()
        if code == 1:
            there, _ = self._registrations()
            pairs = there.published(pairs)
            self._tell(there.strangers({name for name, _ in pairs}))
        return [code, message, pairs]

    def _types(self, ask, *_arguments):
        code, message, pairs = ask()
        if code == 1:
            there, _ = self._registrations()
            pairs = there.topics(pairs)
            self._tell(there.strangers({name for name, _ in pairs}))
        return [code, message, pairs]

    def _state(self, ask, *_arguments):
        code, message, state = ask()
        if code == 1:
            there = Registrations(state, self._participant.members.there, self._participant.members.gone)
            state = there.state()
            self._tell(there.strangers())
        return [code, message, state]

    def _node(self, ask, _caller, node):
        participant = self._participant
        if node in participant.members.gone:
            return [-1, 'unknown node [{}]'.format(node), '']
        if node not in participant.members.there and node not in KNOWN:
            self._tell([node])
        return ask()

    def _service(self, ask, _caller, service):
        there, state = self._registrations()
        if there.only_gone_serve(service, state):
            return [-1, 'no provider', '']
        return ask()

    def _tell(self, strangers):
        for node in strangers:
            if node not in self._told:
                self._told.add(node)
                self._participant.label('it has asked the ROS master who is there: {} does not take part, and is there '
                                        'or not by the wall clock'.format(node))
