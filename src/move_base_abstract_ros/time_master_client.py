"""Call the services of the time master from a Python node: factor, pause, step, run until, and holds.

Durations of simulated time are seconds; they are exact to the nanosecond if they are given as rospy.Duration
or rospy.Time. Factors are simulated seconds per wall second. Timeouts are seconds of wall time.
"""
from __future__ import annotations

import contextlib
import math
import time
from typing import Any, Iterator, Optional, Type

import genpy
import rospy
from std_srvs.srv import Trigger

from move_base_abstract.srv import AcquireHold, ReleaseHold, RunUntil, SetFactor, Step

NANOSECONDS = 10 ** 9


class TimeMasterError(RuntimeError):
    """The time master refused a request, or did not answer."""


class TimeMasterClient:
    """The services of one time master as methods. ns: the name of the time master.

    If the time master refuses a request, the method raises TimeMasterError with the time master's own text.
    It also does so if there is no time master within connect_timeout seconds of wall time.
    """

    def __init__(self, ns: str = '/time_master', connect_timeout: float = 10.0) -> None:
        self._ns = ns.rstrip('/')
        self._connect_timeout = connect_timeout

    def set_factor(self, factor: Any) -> None:
        """Run at factor simulated seconds per wall second (0.01 to 1e6) from now on."""
        self._call('set_factor', SetFactor, float(factor))

    def pause(self) -> None:
        """Make time stand still. A step or run_until that is under way is given up."""
        self._call('pause', Trigger)

    def resume(self) -> None:
        """Make time go on, without a target."""
        self._call('resume', Trigger)

    def step(self, duration: Any) -> Any:
        """Run for duration (> 0; seconds or rospy.Duration), stop exactly there and stay paused.

        Returns the target as rospy.Time at once, before it is reached (see wait_until). If a step or
        run_until is under way, the duration counts from its target.
        """
        return self._call('step', Step, _to_ros(rospy.Duration, duration, 'step: duration')).target

    def run_until(self, target: float) -> None:
        """Run until target (simulated; seconds or rospy.Time), stop exactly there and stay paused.

        Returns at once (see wait_until).
        """
        self._call('run_until', RunUntil, _to_ros(rospy.Time, target, 'run_until: target'))

    def wait_until(self, target: Any, timeout: Optional[float] = None) -> None:
        """Wait until /clock is at target (seconds or rospy.Time) or beyond.

        timeout: seconds of wall time (None = no limit), after which TimeMasterError is raised. If ROS shuts
        down meanwhile, rospy.ROSInterruptException is raised.
        """
        target = _to_ros(rospy.Time, target, 'wait_until: target')
        deadline = None if timeout is None else time.monotonic() + timeout
        while rospy.get_rostime() < target:
            if rospy.is_shutdown():
                raise rospy.ROSInterruptException('shutdown while waiting for a simulated time')
            if deadline is not None and time.monotonic() > deadline:
                raise TimeMasterError(
                    f'simulated time did not get to {target.to_sec():.9f} s within {timeout} s of wall time')
            rospy.rostime.wallsleep(0.001)

    @contextlib.contextmanager
    def hold(self, name: str, timeout: float) -> Iterator[Any]:
        """Hold the clock at busy_factor inside a with block.

        name: the name of the hold, which must be unique, for instance rospy.get_name(). timeout: seconds of
        wall time (more than 0, to 86400) after which the time master releases the hold by itself: give more
        than the block needs. The hold is released in whatever way the block ends. If it has timed out before
        that, a warning is logged.
        """
        self._call('hold', AcquireHold, name, float(timeout))
        try:
            yield
        finally:
            self._release(name)

    def _release(self, name: str) -> None:
        # Never raises: it would hide the error with which the block ended.
        try:
            self._call('release', ReleaseHold, name)
        except TimeMasterError as error:
            rospy.logwarn('%s', error)

    def _call(self, service: str, kind: Type[Any], *arguments: Any) -> Any:
        name = f'{self._ns}/{service}'
        try:
            rospy.wait_for_service(name, self._connect_timeout)
            answer = rospy.ServiceProxy(name, kind)(*arguments)
        except (rospy.ROSException, rospy.ServiceException) as error:
            raise TimeMasterError(f'{name}: no answer ({error}); is a time master running there?') from error
        if not answer.success:
            raise TimeMasterError(f'{name}: {answer.message}')
        return answer


def _to_ros(kind: Type[Any], value: float, what: str) -> Any:
    """Return value as kind (rospy.Time or rospy.Duration). Seconds are rounded to the nanosecond."""
    if isinstance(value, genpy.TVal) and issubclass(kind, type(value)):  # messages hold genpy's own types
        return kind(value.secs, value.nsecs)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise TimeMasterError(f'{what} must be seconds or {kind.__name__}, got {value!r}')
    nanoseconds = value * NANOSECONDS if isinstance(value, int) else round(value * NANOSECONDS)
    if kind is rospy.Time and nanoseconds < 0:
        raise TimeMasterError(f'{what} must not be negative, got {value!r} s')
    return kind(*divmod(nanoseconds, NANOSECONDS))
