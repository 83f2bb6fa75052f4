"""ROS parameters, set and read by the thread that has the turn.

A new value goes to the time master with the report, and to the ROS master when the round is over; this process sees it
at once. So a participant reads what earlier rounds have set, whichever node was faster. If a node that does not take
part sets a parameter that a participant reads, the run is labelled: the time master is told which names are read.
"""
from __future__ import annotations

import xmlrpc.client
from collections import deque
from typing import TYPE_CHECKING, Any, Callable, Dict, Set, Tuple

import rosgraph
import rospy.core

from move_base_abstract.lockstep import wire
from move_base_abstract.lockstep.parameters import MISSING, PendingParameters, in_order, search
from move_base_abstract.lockstep.task import TurnLost

from .master_calls import Answer, aside

if TYPE_CHECKING:
    from ..participation.taking_part import Participant

_BEGIN, _END = '<value>', '</value>'
#: parameters in which roslaunch notes its own addresses: their names contain port numbers
_OF_ROSLAUNCH = '/roslaunch/uris'


class Parameters:
    """The parameters as one participant sees them; for its thread that has the turn.

    ``master`` is a proxy of the ROS master.
    """

    def __init__(self, participant: Participant, master: Any) -> None:
        self._participant = participant
        self._master = master
        self._pending = PendingParameters()
        self._untold: Any = deque()  # the pending changes as calls of the ROS master
        self._asked: Set[str] = set()
        self._kept: Dict[Tuple[str, str], Tuple[int, Any]] = {}  # {(method, name): (code, value) of the ROS master}
        self._keeps = True

    def answers(self) -> Dict[str, Callable[..., Answer]]:
        """Return {method: answer(ask, *arguments)}."""
        return {'setParam': self._set, 'deleteParam': self._delete, 'getParam': self._get, 'hasParam': self._has,
                'searchParam': self._search, 'getParamNames': self._names, 'subscribeParam': self._subscribe}

    def forget(self) -> None:
        """Forget the kept answers of the ROS master: the time master says that parameters may have changed."""
        self._kept.clear()

    def settle(self) -> None:
        """Tell the ROS master the values set in this turn, since a node that takes no part may now read them.

        That node may also set parameters, of which the time master hears only later. So answers are not kept any more.
        """
        self._keeps = False
        scheduler = self._participant.scheduler
        if self._untold and scheduler.is_mine():
            try:
                scheduler.wait_round()
            except TurnLost:
                self.flush()

    def flush(self) -> None:
        """Tell the ROS master of the changes at once, since no round follows in which the time master would do it."""
        if not self._untold:
            return
        # Not by the other proxy: a signal may make this thread end the node in the middle of that proxy's request.
        master = rospy.core.xmlrpcapi(rosgraph.get_master_uri(), cache=False)
        while self._untold:
            method, *arguments = self._untold.popleft()
            with aside():
                getattr(master, method)(self._participant.members.own_name, *arguments)

    # --- changes ----------------------------------------------------------------------------------------------------

    def _set(self, _ask: Any, caller: str, key: str, value: Any) -> Answer:
        name = _resolved(caller, key)
        text = xmlrpc.client.dumps((value,))  # raises the same errors as the request
        (value,), _ = xmlrpc.client.loads(text)
        self._pending.set(name, value)
        self._report(wire.parameter(name, True, text[text.index(_BEGIN):text.rindex(_END) + len(_END)]),
                     ('setParam', name, value))
        return [1, 'parameter {} set'.format(name), 0]

    def _delete(self, _ask: Any, caller: str, key: str) -> Answer:
        name = _resolved(caller, key)
        if not self._is_set(name):
            return [-1, 'parameter [{}] is not set'.format(name), 0]
        self._pending.delete(name)
        self._report(wire.parameter(name, False, ''), ('deleteParam', name))
        return [1, 'parameter {} deleted'.format(name), 0]

    def _report(self, item: bytes, call: Tuple[Any, ...]) -> None:
        self._untold.append(call)

        def told() -> bytes:
            self._pending.first_is_told()
            self.forget()
            self._untold.popleft()
            return item
        self._participant.add_aside(told)

    # --- questions --------------------------------------------------------------------------------------------------

    def _ask(self, method: str, name: str) -> Tuple[int, Any]:
        """Return (code, value) of the ROS master's answer, and report to the time master that ``name`` is read."""
        self._note(name)
        kept = self._kept.get((method, name))
        if kept is None or not self._keeps:
            with aside():
                code, _, value = getattr(self._master, method)(self._participant.members.own_name, name)
            kept = self._kept[method, name] = code, value
        return kept

    def _note(self, name: str) -> None:
        if name not in self._asked:
            self._asked.add(name)
            self._participant.add_aside(wire.asks(name))

    def _value(self, name: str) -> Any:
        """Return the value of a parameter as this process sees it, or MISSING."""
        code, value = self._ask('getParam', name)
        return self._pending.seen(name, value if code == 1 else MISSING)

    def _is_set(self, name: str) -> bool:
        if self._pending.concern(name):
            return self._value(name) is not MISSING
        return self._ask('hasParam', name) == (1, True)

    def _get(self, _ask: Any, caller: str, key: str) -> Answer:
        name = _resolved(caller, key)
        value = self._value(name)
        if value is MISSING:
            return [-1, 'Parameter [{}] is not set'.format(name), 0]
        return [1, 'Parameter [{}]'.format(name), in_order(value)]

    def _has(self, _ask: Any, caller: str, key: str) -> Answer:
        name = _resolved(caller, key)
        return [1, name, self._is_set(name)]

    def _search(self, ask: Callable[[], Answer], caller: str, key: str) -> Answer:
        if not key or key.startswith('~'):
            return ask()  # refused
        found = search(caller, key, self._is_set)
        if found is None:
            return [-1, 'Cannot find parameter [{}] in an upwards search'.format(key), '']
        return [1, 'Found [{}]'.format(found), found]

    def _names(self, ask: Callable[[], Answer], _caller: str) -> Answer:
        self._note('/')
        code, message, names = ask()
        if code == 1:
            names = sorted(name for name in self._pending.names(names) if not name.startswith(_OF_ROSLAUNCH + '/'))
        return [code, message, names]

    def _subscribe(self, ask: Callable[[], Answer], caller: str, _api: str, key: str) -> Answer:
        self._participant.label('it has the ROS master tell it of parameter {}: that comes at some moment of the '
                                'wall clock'.format(_resolved(caller, key)))
        return ask()


def _resolved(caller: str, key: str) -> str:
    return rosgraph.names.resolve_name(key, caller)
