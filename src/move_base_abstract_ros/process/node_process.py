"""One of our nodes as a process: its command line, its start, its end, and one plain line for each error."""
from __future__ import annotations

import argparse
import gc
import http.client
import logging
import sys
import threading
import traceback
import xmlrpc.client
from typing import Any, Callable, Dict, Optional

import rosgraph
import rospkg
import rospy

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.lasting_output import drop_unread_outputs
from move_base_abstract.common.shown import shown_text
from move_base_abstract.lockstep.task import TurnLost

from ..replacing import rospy_start
from ..replacing.log_files import survive_full_disk
from .process_end import ProcessEnd, leave
from .ros_master_watch import RosMasterWatch, is_answering

_POLL_S = 0.05  # wall
_MASTER_TIMEOUT_S = 2.0  # wall
_FAILED = 1
#: the errors that rospy raises if the ROS master is gone
_NETWORK_ERRORS = (OSError, http.client.HTTPException, xmlrpc.client.Error, rosgraph.MasterException,
                   rosgraph.MasterError)


def parse_no_arguments(name: str, description: str, is_strict: bool = True) -> None:
    """Handle the command line of a node that is configured by parameters only: --help, and unknown arguments.

    With ``is_strict`` an unknown argument is an error, with exit code 2. Otherwise it is a warning, for a node that
    replaces one that ignores such arguments.
    """
    parser = argparse.ArgumentParser(prog=name, description=description, usage='%(prog)s [-h] [NAME:=VALUE ...]',
                                     epilog='NAME:=VALUE is a remapping, _PARAMETER:=VALUE a private parameter, as for '
                                     'any ROS node. The pages in docs/ of the package list them.')
    _, rest = parser.parse_known_args(rospy.myargv()[1:])
    if rest and is_strict:
        parser.error('unknown argument {}; allowed: NAME:=VALUE'.format(shown_text(rest[0])))
    if rest:
        print('{}: unknown argument {} is ignored'.format(name, shown_text(rest[0])), file=sys.stderr)


def run_node(name: str, set_up: Callable[[], Any], say_goodbye: Optional[Callable[[Any], None]] = None,
             failed: int = _FAILED, **options: Any) -> None:
    """Be the node ``name`` until ROS shuts down. At an error, print it in one line and exit.

    :param set_up: makes and returns the node's object; returns None if ROS shuts down meanwhile.
    :param say_goodbye: is called with that object before the topics close.
    :param failed: the exit code if a parameter cannot be used.
    :param options: those of rospy.init_node.
    """
    end = ProcessEnd(name, lambda signal: _shut_down(signal, name, end))
    watch = RosMasterWatch(name)
    result = _in_thread(lambda: _start(name, set_up, watch, options), end, watch)
    watch.stop()
    if end.asked.is_set():
        _finish(end)
    if watch.has_lost:
        leave(_FAILED)
    if isinstance(result, BaseException) and not isinstance(result, TurnLost):
        leave(tell_error(name, result, failed))
    if result is None or isinstance(result, TurnLost):  # the run is over, and what has ended it says why
        return
    end.enter_service()
    # The present objects live until the end, so Python's search for garbage need not go through them again and again.
    gc.collect()
    gc.freeze()
    if say_goodbye is not None:
        rospy.on_shutdown(lambda: say_goodbye(result))
    rospy.spin()
    if end.asked.is_set():
        _finish(end)


def _shut_down(signal: str, name: str, end: ProcessEnd) -> None:
    """Shut rospy down in order. If the ROS master is gone, do not wait long: rospy may hang in a call, with a lock."""
    if not is_answering(rosgraph.get_master_uri(), name, _MASTER_TIMEOUT_S):
        if not end.is_in_service:
            leave(0)
        end.hasten(_MASTER_TIMEOUT_S)
    drop_unread_outputs()
    rospy.signal_shutdown(signal)


def _start(name: str, set_up: Callable[[], Any], watch: RosMasterWatch, options: Dict[str, Any]) -> Any:
    watch.start()
    survive_full_disk()
    rospy_start.prepare()
    rospy.init_node(name, disable_signals=True, **options)
    return set_up()


def _in_thread(work: Callable[..., Any], end: ProcessEnd, watch: RosMasterWatch) -> Any:
    """Run ``work()`` in a thread; return its result or its error, or None if the process must end before.

    It is not the main thread, since ``work`` may wait for ever if the ROS master is gone.
    """
    results = []

    def run() -> None:
        try:
            results.append(work())
        except BaseException as error:
            results.append(error)

    worker = threading.Thread(target=run, name='set-up', daemon=True)
    worker.start()
    while worker.is_alive() and not end.asked.is_set() and not watch.has_lost:
        worker.join(_POLL_S)
    return results[0] if results else None


def _finish(end: ProcessEnd) -> None:
    """Exit when the shutdown is over; ProcessEnd makes sure that this is soon."""
    end.over.wait()
    logging.shutdown()
    leave(0)


def tell_error(name: str, error: Any, failed: int = _FAILED) -> int:
    """Log or print in one line why the node cannot start or go on; return the exit code."""
    if isinstance(error, SystemExit):
        return error.code if isinstance(error.code, int) else _FAILED
    code = _FAILED
    if isinstance(error, SimulatorError):
        code, text = failed, str(error)
    elif isinstance(error, _NETWORK_ERRORS):
        text = 'the ROS master at {} does not answer as it should: {}'.format(
            rosgraph.get_master_uri(), shown_text(' '.join(str(error).split())))
    elif isinstance(error, (rospy.ROSException, ValueError)):
        text = ' '.join(str(error)[:1000].split()) or type(error).__name__
    else:
        logging.getLogger('rospy').error('%s', ''.join(traceback.format_exception(
            type(error), error, error.__traceback__)))
        text = 'an error of the program itself, please report it with the log file in {}: {}: {}'.format(
            rospkg.get_log_dir(), type(error).__name__, shown_text(' '.join(str(error).split())))
    if rospy.core.is_initialized():
        rospy.logfatal('%s: %s', rospy.get_name(), text)
    else:
        print('{}: {}'.format(name, text), file=sys.stderr)
    return code
