"""Questions to the ROS master about the nodes, topics and services at this instant.

The answer would depend on which node was faster in this round, since the ROS master takes no part. So a node that asks
waits until no participant has anything left to do at this instant. Then all nodes of a launch file have registered,
also the slower ones. And a node that asks goes on a round after the answer: if two nodes ask at once, neither sees what
the other has done because of its answer.

An answer names participants, and of the other nodes those that offer something. Such a name labels the run.
"""
from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Set

from move_base_abstract.lockstep.loops import STEP_NS
from move_base_abstract.lockstep.registrations import KNOWN, Registrations
from move_base_abstract.lockstep.task import TurnLost

from .master_calls import Answer, aside

if TYPE_CHECKING:
    from move_base_abstract.lockstep.scheduler import Scheduler

    from ..participation.taking_part import Participant

#: number of rounds that are enough for new connections, the latched messages on them, and an answer
ROUNDS = 10
#: a node that asks more often than this in a row waits in a loop
ASKED = 100


class _Asked:
    """Counts questions in a row. Between them at most as much simulated time passes as in a loop that asks."""

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._last_ns = 0
        self._count = 0

    def once_more(self) -> None:
        """Count a question. In a loop that asks without a sleep, let time go on as in one that waits by looking."""
        now_ns = self._scheduler.now_ns
        self._count = self._count + 1 if now_ns <= self._last_ns + STEP_NS else 1
        if self._count > ASKED:
            self._scheduler.look_away(STEP_NS)
        self._last_ns = self._scheduler.now_ns


def settle(scheduler: Scheduler) -> None:
    """Let messages that are on their way at this instant arrive, before the calling thread waits in wall time."""
    for _ in range(ROUNDS):
        scheduler.wait_round()


class Queries:
    """The questions of one participant; for its thread that has the turn. ``master`` is a proxy of the ROS master."""

    def __init__(self, participant: Participant, master: Any) -> None:
        self._participant = participant
        self._master = master
        self._told: Set[str] = set()
        self._asked = _Asked(participant.scheduler)

    def answers(self) -> Dict[str, Callable[..., Answer]]:
        """Return {method: answer(ask, *arguments)}."""
        answers: Dict[str, Callable[..., Answer]] = {
            'getPublishedTopics': partial(self._topics, Registrations.published),
            'getTopicTypes': partial(self._topics, Registrations.topics), 'getSystemState': self._state,
            'lookupNode': self._node, 'lookupService': self._service}
        return {method: self._after_others(answer) for method, answer in answers.items()}

    def _after_others(self, answer: Callable[..., Answer]) -> Callable[..., Answer]:
        def ask_who(ask: Callable[[], Answer], *arguments: str) -> Answer:
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

    def _registrations(self, state: Any = None) -> Registrations:
        """Return what of the ROS master's ``state`` is to be shown; None: of its present state."""
        if state is None:
            with aside():
                code, _, found = self._master.getSystemState(self._participant.members.own_name)
            state = found if code == 1 else [[], [], []]
        return Registrations(state, self._participant.members.there, self._participant.members.gone)

    def _topics(self, shown: Callable[..., List[List[str]]], ask: Callable[[], Answer], *_arguments: str) -> Answer:
        code, message, pairs = ask()
        if code == 1:
            there = self._registrations()
            pairs = shown(there, pairs)
            self._tell(there.strangers({name for name, _ in pairs}))
        return [code, message, pairs]

    def _state(self, ask: Callable[[], Answer], *_arguments: str) -> Answer:
        code, message, state = ask()
        if code == 1:
            there = self._registrations(state)
            state = there.state()
            self._tell(there.strangers())
        return [code, message, state]

    def _node(self, ask: Callable[[], Answer], _caller: str, node: str) -> Answer:
        participant = self._participant
        if node in participant.members.gone:
            return [-1, 'unknown node [{}]'.format(node), '']
        if node not in participant.members.there and node not in KNOWN:
            self._tell([node])
        return ask()

    def _service(self, ask: Callable[[], Answer], _caller: str, service: str) -> Answer:
        if self._registrations().only_gone_serve(service):
            return [-1, 'no provider', '']
        return ask()

    def _tell(self, strangers: Iterable[str]) -> None:
        for node in strangers:
            if node not in self._told:
                self._told.add(node)
                self._participant.label('it has asked the ROS master for nodes, topics or services: {} does not take '
                                        'part, so it depends on the wall clock whether it is there'.format(node))
