"""One thread per process that notices if Stage falls silent. Then Stage's clock stands, and all nodes that use it."""
from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, List

import rospy

from move_base_abstract.common.shown import first_of
from move_base_abstract.supervision.silence_watch import SilenceWatch

if TYPE_CHECKING:
    from move_base_abstract.supervision.silence_watch import Silence

_POLL_SECONDS = 0.5
_NAMED = 5  # topics in a warning

_lock = threading.Lock()
_watch = SilenceWatch()
_threads: List[Any] = []


def add(topic: str) -> None:
    """Warn from now on if nothing comes on ``topic`` for a while."""
    with _lock:
        _watch.add(topic, time.monotonic())
        if not _threads:
            _threads.append(threading.Thread(target=_run, name='stage_watch', daemon=True))
            _threads[0].start()


def remove(topic: Any) -> None:
    """Stop watching ``topic``."""
    with _lock:
        _watch.remove(topic)


def heard(topic: str) -> None:
    """Note that a message has come on ``topic``."""
    with _lock:
        _watch.heard(topic, time.monotonic())


def _run() -> None:
    while not rospy.is_shutdown():
        time.sleep(_POLL_SECONDS)
        with _lock:
            silence = _watch.check(time.monotonic())
        _tell(silence)


def _tell(silence: Silence) -> None:
    if silence.unheard:
        rospy.logwarn('%s: nothing has come on %s for %g s: is Stage running, and does it use this name of the robot?',
                      rospy.get_name(), first_of(silence.unheard, _NAMED), _watch.limit)
    if silence.silent:
        rospy.logwarn('%s: Stage has fallen silent: nothing has come on %s for %g s or more. It has ended, hangs or is '
                      'paused; if it publishes /clock, time stands still. Start it again, and the robots go on',
                      rospy.get_name(), first_of(silence.silent, _NAMED), _watch.limit)
    if silence.back:
        rospy.loginfo('%s: Stage is heard again: %s', rospy.get_name(), first_of(silence.back, _NAMED))
