"""Run a Plan with roslaunch's own parent, end the run in order, and say how it ended."""
import subprocess
import sys
import threading
import time

import roslaunch.nodeprocess
import roslaunch.parent
from roslaunch.core import is_machine_local

from move_base_abstract.runs import ends

from . import roles
from .plan import TIME_MASTER
from .sleeps import Sleeps
from .watched_process import Watched

_STATE_TIMEOUT = 5.0  # s, wall
_EACH_TIMEOUT = 10.0  # s, wall, for a node to take part before the next one starts; it may wait for the next one
_BEFORE_ASKING_S = 1.0  # wall: at the end of a run participants may end before the time master does
_LEAVERS_S = 2.0  # wall, for the process of a node that has left before the end of the run to end
_LOOK_S = 0.01  # wall
GOOD, BAD = 0, 1


class Parent(roslaunch.parent.ROSLaunchParent):
    """roslaunch's parent, for a Plan.

    After spin(), ``code`` is the exit code, GOOD or BAD, and ends() says how the processes ended.
    """

    def __init__(self, run_id, plan, log, warm=None, **options):
        """log: the path of the run's event log. warm: the WarmClient that starts Python nodes, if there is one."""
        super().__init__(run_id, [], local_only=True, process_listeners=(), **options)
        self._plan = plan
        self._log_path = log
        self._watched = {}
        self._waited_for = []
        self._has_started = False
        self._over = threading.Event()
        self._sleeps = Sleeps()
        if warm is not None:
            roslaunch.nodeprocess.subprocess = _Starting(warm.popen)
        self.code = GOOD

    def _init_runner(self):
        super()._init_runner()
        if self._plan.is_reversed:
            launch = self.runner.launch_node
            self.runner.launch_node = lambda node, core=False: self._launch_and_wait(launch, node, core)

    def _launch_and_wait(self, launch, node, core):
        """Launch a node. If it is a participant, wait until it takes part or the run has begun, at most 10 s."""
        started = launch(node, core)
        name, deadline = roles.name_of(node), time.monotonic() + _EACH_TIMEOUT
        while started[1] and name in self._plan.participants and time.monotonic() < deadline:
            state = ask_state(_STATE_TIMEOUT)
            if state is not None and (name in [one.name for one in state.participants]
                                      or state.phase != 'waiting_for_participants'):
                break
            time.sleep(_LOOK_S)
        return started

    def _load_config(self):
        self.config = self._plan.config

    def _start_pm(self):
        super()._start_pm()
        self.pm.add_process_listener(self)
        register, kill_all = self.pm.register, self.pm._post_run

        def watch(process):
            register(process)
            name = _name_of(process.name)
            self._watched[name] = Watched(process, self._sleeps.hurry_when if name == TIME_MASTER else None)

        def end_in_order():
            for one in list(self._watched.values()):
                one.look(is_early=True)
            self._over.set()
            self._sleeps.hurry()
            self._stop_time_master()
            self._await_leavers()
            for one in list(self._watched.values()):
                one.is_told = one.look() is None
            kill_all()
        self.pm.register = watch
        # Time stops before any node ends. Otherwise the others would go on for a time that depends on the wall clock.
        self.pm._post_run = end_in_order

    def process_died(self, process_name, exit_code):
        """Note that a process has ended; roslaunch calls this. ``process_name``: ends in a number of roslaunch."""
        if self._over.is_set():
            return
        name = _name_of(process_name)
        self._watched[name].look(is_early=True)
        if name == TIME_MASTER:
            self.code = GOOD if exit_code == 0 else BAD
            self.pm.shutdown()
        elif name in self._plan.participants and not self._has_started:
            self._waited_for.append((name, exit_code))
            if len(self._waited_for) == 1:
                threading.Thread(target=self._look_for_waiting, daemon=True).start()

    def _look_for_waiting(self):
        """Report a participant that has ended while the time master waits for it, and end the run.

        This runs in a thread of its own. It asks the time master after a while, because the run may be about to end,
        and does not ask again once time has started.
        """
        while not self._over.wait(_BEFORE_ASKING_S):
            state = ask_state(_STATE_TIMEOUT)
            if state is None:
                continue
            there = [one.name for one in state.participants]
            gone = [one for one in self._waited_for if one[0] not in there]
            if state.phase != 'waiting_for_participants':
                self._has_started = True
                return
            if gone and not self._over.is_set():
                self._complain(*gone[0])
                self.code = BAD
                self.pm.shutdown()
                return

    def _complain(self, name, exit_code):
        """Print that a participant has ended before time started, with its last lines, or with what to do about it."""
        print('lockstep_launch: {} ended ({}) before it took part, so that time never starts.{}'.format(
            name, ends.described(exit_code) if exit_code else 'exit code 0', ' It said last:' if exit_code else
            ' If it is a node that does not go on running, make it an onlooker: --onlooker {}'.format(name)),
            file=sys.stderr)
        for line in ends.plain_lines(self._watched[name].process(name, True)) if exit_code else ():
            print('    ' + line, file=sys.stderr)

    def _stop_time_master(self):
        for name in self.pm.get_active_names():
            if _name_of(name) == TIME_MASTER:
                process = self.pm.get_process(name)
                popen = process.popen
                process.stop([])
                if popen is not None and popen.returncode:
                    self.code = BAD

    def _await_leavers(self):
        """Wait for the processes of nodes that left before the end, by the event log: their exit codes count."""
        leavers = [self._watched[name] for name in ends.read_log(self._log_path).departures if name in self._watched]
        deadline = time.monotonic() + _LEAVERS_S
        while any(one.look(is_early=True) is None for one in leavers) and time.monotonic() < deadline:
            time.sleep(_LOOK_S)

    def ends(self):
        """Return [ends.End] of all processes of the run, including those that could not be started."""
        nodes = {roles.name_of(node): node for node in self.config.nodes if is_machine_local(node.machine)}
        return ends.judge([self._process(*one) for one in nodes.items()], ends.read_log(self._log_path))

    def _process(self, name, node):
        if name not in self._watched:
            return ends.Process(name, False, None, was_started=False)
        process = self._watched[name].process(name, name in self._plan.participants)
        return process._replace(is_shell=roles.is_shell(node))


class _Starting:
    """Takes the place of the module subprocess in roslaunch's module of processes. ``popen`` starts the processes."""

    def __init__(self, popen):
        self.Popen = popen

    def __getattr__(self, name):
        return getattr(subprocess, name)


def _name_of(process_name):
    """Return the full name of the node to which roslaunch's name for its process belongs; this ends in a number."""
    return '/' + process_name.rpartition('-')[0]


def ask_state(timeout):
    """Return the time master's TimeState, or None if there is none within ``timeout`` [s, wall]. It is latched."""
    import rospy

    from move_base_abstract.msg import TimeState
    if not rospy.core.is_initialized():
        rospy.init_node('lockstep_launch', anonymous=True, disable_rostime=True, disable_signals=True,
                        disable_rosout=True)
    try:
        return rospy.wait_for_message(TIME_MASTER + '/state', TimeState, timeout)
    except (rospy.ROSException, OSError):
        return None
