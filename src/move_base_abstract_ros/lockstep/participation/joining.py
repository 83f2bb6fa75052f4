"""How a node joins the run: ``lockstep.join`` and its two halves."""
from __future__ import annotations

import os
import signal
import threading
import time
from types import SimpleNamespace
from typing import Optional

import rosgraph
import rospy

from move_base_abstract.common.parameter_table import checked
from move_base_abstract.lockstep.charge import make_charge
from move_base_abstract.lockstep.node_parameters import RANK
from move_base_abstract.properties import statements, stating

from ...replacing import replaced
from ..exchange.access import connect, is_lockstep
from ..failing import outcomes, uncaught
from ..ros_master.master_calls import calls
from ..ros_master.parameters import Parameters
from ..ros_master.queries import Queries
from ..waiting import polling, threads, waits
from . import finish
from .taking_part import Participant

_state = SimpleNamespace(joined=None)


def participant() -> Optional[Participant]:
    """Return this process's :class:`Participant`, or None if it has not joined."""
    return _state.joined


def join(rank: Optional[int] = None, own_threads: bool = True) -> Optional[Participant]:
    """Take part in lockstep; return the :class:`Participant`, or None if the time master is not in lockstep.

    Call this after ``rospy.init_node``, before topics, threads and locks are made. (Topics that exist already are
    taken over; locks are not.) It returns when the clock has started, and waits for that as long as it takes.

    :param rank: orders messages of the same instant, lowest first. Without it, and without the private parameter
        ``lockstep_rank``, nodes come after the robots, in the order of their names.
    :param own_threads: False for a node that starts no threads of its own: Python's threads and locks are left alone,
        and questions to the ROS master about nodes and topics are answered as without lockstep.
    :raises ConfigurationError: for a bad parameter, or if the time master leaves lockstep meanwhile.
    """
    if _state.joined is not None or not is_lockstep():
        return _state.joined
    joining = take_part(rospy.get_name(), rospy.get_node_uri(), rank, own_threads)
    node_is_there(joining)
    return joining


def take_part(name: str, uri: str, rank: Optional[int], own_threads: bool = True) -> Participant:
    """Take part as the node ``name`` with the address ``uri``; this is the first half of :func:`join`.

    The node may not exist yet. If ``rank`` is None, the parameter ``lockstep_rank`` counts.

    :raises ConfigurationError: for a bad parameter, or if the time master leaves lockstep meanwhile.
    """
    declared = rank if rank is not None else rospy.get_param(name + '/lockstep_rank', None)
    if declared is not None:
        declared = checked(declared, 'lockstep_rank', RANK, name)
    charge = make_charge(rospy.get_param(name + '/lockstep_charge', 'none'), time.perf_counter_ns, time.process_time_ns)
    joining = Participant(connect(), charge)
    # Time comes with the grants; a message on /clock may come earlier or later than its grant.
    replaced.replace('rospy.impl.simtime._set_rostime', lambda _original: lambda _time: None)
    # After the hooks of the application, which may still publish.
    rospy.core.add_preshutdown_hook(lambda _reason: joining.leave('its node shuts down'))
    joining.present(name, uri, declared)
    joining.topics.install()
    joining.services.install()
    waits.install(joining)
    polling.install(joining)
    threads.install(joining, own_threads)
    uncaught.install(joining)
    outcomes.install(joining)
    stating.tell_to(lambda row: joining.log(name, statements.ROW, row))
    finish.install(joining)
    _follow_forks(joining)
    _follow_master_calls(joining, own_threads)
    _state.joined = joining
    return joining


def _follow_master_calls(joining: Participant, asks: bool) -> None:
    """Order the setting and reading of parameters by the rounds; if ``asks``, also questions about nodes and topics."""
    master = rospy.core.xmlrpcapi(rosgraph.get_master_uri())
    parameters = joining.parameters = Parameters(joining, master)
    calls.follow(joining, {**(Queries(joining, master).answers() if asks else {}), **parameters.answers()})


def _follow_forks(joining: Participant) -> None:
    """Make a child that is forked (multiprocessing, os.fork) take no part, and not speak for its parent.

    SIGTERM ends it, like any process that handles no signals. Otherwise it would inherit rospy's handler, which ends no
    process. ``with multiprocessing.Pool()`` ends its workers by SIGTERM: with rospy's handler it would sometimes wait
    for them for ever (without lockstep, too), and the run with it.
    """
    before = threading.local()

    def hold() -> None:
        before.mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})

    def go_on() -> None:
        signal.pthread_sigmask(signal.SIG_SETMASK, before.mask)

    def let_go() -> None:
        joining.scheduler.abandon()
        joining.connection.forget()
        if getattr(signal.getsignal(signal.SIGTERM), '__module__', None) == rospy.core.__name__:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        go_on()  # a signal that came meanwhile ends the child

    os.register_at_fork(before=hold, after_in_parent=go_on, after_in_child=let_go)


def node_is_there(joining: Participant) -> None:
    """Finish :func:`join` when ``rospy.init_node`` has returned; this is its second half."""
    uncaught.note_lines(joining)
    leave_clock()
    _warn(joining)


def leave_clock() -> None:
    """Listen to ``/clock`` no longer: this node needs it no more, and nobody is told that time does not wait for it."""
    clock = getattr(rospy.impl.simtime, '_clock_sub', None)
    if clock is not None:
        clock.unregister()


def _warn(joined: Participant) -> None:
    if replaced.unknown():
        rospy.logwarn('%s: %s', rospy.get_name(), replaced.unknown())
    if not rospy.get_param('/use_sim_time', False):
        rospy.logwarn('%s takes part in lockstep, but /use_sim_time is not true', rospy.get_name())
    if not joined.charge.is_repeatable:
        joined.label('it charges what it measures; replay the record to repeat the run')
    if os.environ.get('PYTHONHASHSEED', 'random') == 'random':
        rospy.logdebug('%s: sets of texts have another order in every run; PYTHONHASHSEED=0 fixes that',
                       rospy.get_name())
