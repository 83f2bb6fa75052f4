"""Run a Plan: roslaunch's own parent, that ends a run in order and says how it ended."""
import sys
import time

import roslaunch.parent

from . import roles
from .plan import TIME_MASTER

_STATE_TIMEOUT = 5.0  # s, wall
_EACH_TIMEOUT = 10.0  # s, wall, for a node to take part before the next one starts; it may wait for that one
_LOOK_S = 0.02  # wall
GOOD, BAD = 0, 1


class Parent(roslaunch.parent.ROSLaunchParent):
    """roslaunch's parent of a Plan. ``code`` is the exit code when spin() has returned, GOOD or BAD."""

    def __init__(self, run_id, plan, **options):
        super().__init__(run_id, [], local_only=True, process_listeners=(), **options)
        self._plan = plan
        self._required = [roles.name_of(node) for node in plan.config.nodes if node.required]
        self.code = GOOD
        self._ending = False

    def _init_runner(self):
        super()._init_runner()
        if self._plan.is_reversed:
            launch = self.runner.launch_node
            self.runner.launch_node = lambda node, core=False: self._launch_and_wait(launch, node, core)

    def _launch_and_wait(self, launch, node, core):
        """Launch a node, and wait until it takes part, or is not going to."""
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
        kill_all = self.pm._post_run

        def end_in_order():
            self._ending = True
            self._stop_time_master()
            kill_all()
        # Time stops before anybody goes; else those that are left would live on for as long as the wall clock pleases.
        self.pm._post_run = end_in_order

    def process_died(self, process_name, exit_code):
        """Hear from roslaunch that a process is gone; ``process_name`` ends in a number of roslaunch's."""
        if self._ending:
            return
        name = '/' + process_name.rpartition('-')[0]
        if name == TIME_MASTER:
            self.code = GOOD if exit_code == 0 else BAD
            self.pm.shutdown()
        elif name in self._required and exit_code:
            self.code = BAD
        elif name in self._plan.participants and self._is_waited_for(name):
            print('lockstep_launch: {} ended (exit code {}) before it took part, so that time never starts. If it is '
                  'no node that goes on, leave it as an onlooker: --onlooker {}'.format(name, exit_code, name),
                  file=sys.stderr)
            self.code = BAD
            self.pm.shutdown()

    def _stop_time_master(self):
        for name in self.pm.get_active_names():
            if '/' + name.rpartition('-')[0] == TIME_MASTER:
                process = self.pm.get_process(name)
                popen = process.popen
                process.stop([])
                if popen is not None and popen.returncode:
                    self.code = BAD

    def _is_waited_for(self, name):
        """Whether the time master still waits for the participants, and this one is not there."""
        state = ask_state(_STATE_TIMEOUT)
        return state is not None and state.phase == 'waiting_for_participants' and name not in [
            one.name for one in state.participants]


def ask_state(timeout):
    """Return what the time master says of itself, or None. Its state is latched and comes again and again."""
    import rospy

    from move_base_abstract.msg import TimeState
    if not rospy.core.is_initialized():
        rospy.init_node('lockstep_launch', anonymous=True, disable_rostime=True, disable_signals=True,
                        disable_rosout=True)
    try:
        return rospy.wait_for_message(TIME_MASTER + '/state', TimeState, timeout)
    except (rospy.ROSException, OSError):
        return None
