"""Carries out the commands of the mission on ROS robots, and reports their ends to the mission.

All events of robots come over one queue and are handled in the main thread. Events that wait there are handled
together, in the order of the robots' indices, which is the mission's stated order for equal times.
"""
from __future__ import annotations

import contextlib
import queue
import threading
import time
from typing import Any, Optional

import rospy

from soil_mapping.mission.commands import Drive, TakeSample

READY_TIMEOUT_S = 60.0  # wall; on the scaled clock only
POLL_S = 0.01  # wall
START_TRIES = 5  # number of times that a robot is sent to its start, at most
START_PAUSE_S = 1.0  # simulated, between two tries
END = (-1, None)  # on the queue: the budget is over
SHUTDOWN = (-2, None)


class MissionFailed(RuntimeError):
    """The mission could not begin or go on; the text says why."""


class MissionRun:
    """One mission, from waiting for the robots to its end.

    coordinator: a soil_mapping Coordinator that has not started. robots: a RobotLink for each robot, in order; they put
    the ends of their goals on events (queue.Queue). computing: makes a context manager for the time during which the
    mission computes. show: called after each change.
    """

    def __init__(self, coordinator: Any, robots: Any, events: Any, computing: Any = contextlib.nullcontext,
                 show: Any = lambda: None) -> None:
        self._coordinator = coordinator
        self._robots = robots
        self._events = events
        self._computing = computing
        self._show = show
        self.began: Any = None
        self.ended: Any = None  # wall s (perf_counter) of the mission's begin and end

    @property
    def wall_s(self) -> Any:
        """The duration of the mission [wall s], when it is over."""
        return self.ended - self.began

    def wait_until_ready(self, participant: Any = None, check: Any = lambda: None) -> None:
        """Wait for all robots.

        participant: the participant of lockstep, whose wait takes no simulated time, or None. check: called repeatedly
        without lockstep; it may raise.

        :raises MissionFailed: after 60 s of wall time, with the names of what is missing, or if ROS is shut down.
        """
        if participant is not None:
            participant.wait_until(lambda: all(robot.is_ready for robot in self._robots), what='the robots')
            return
        deadline = time.monotonic() + READY_TIMEOUT_S
        while not (rospy.get_rostime() and all(robot.is_ready for robot in self._robots)):
            check()
            if rospy.is_shutdown():
                raise MissionFailed('ROS was shut down before the mission began')
            if time.monotonic() > deadline:
                lacks = ', '.join(robot.lacks for robot in self._robots if robot.lacks) or 'a message on /clock'
                raise MissionFailed(f'after {READY_TIMEOUT_S:g} s there is no {lacks}')
            time.sleep(POLL_S)

    def go_to_start(self) -> None:
        """Send robots that are elsewhere to their starts, and wait for them.

        A robot that gives up is sent again after a pause.

        :raises MissionFailed: if a robot has given up 5 times, or ROS is shut down.
        """
        places = self._coordinator.start_places
        tries = {robot.index: 0 for robot, (x, y) in zip(self._robots, places) if not robot.is_at(x, y)}
        for index in sorted(tries):
            rospy.loginfo('%s goes to its start at (%.2f, %.2f) m', self._robots[index].namespace, *places[index])
            self._robots[index].drive(*places[index])
        while tries:
            index, handle = self._next()
            reached = self._robots[index].end_of_goal(handle)
            if reached:
                self._robots[index].place_after(handle)
                del tries[index]
            elif reached is not None:
                tries[index] += 1
                self._go_to_start_again(self._robots[index], places[index], handle, tries[index])
        for robot in self._robots:
            robot.place()

    @staticmethod
    def _go_to_start_again(robot: Any, place: Any, handle: Any, tries: Any) -> None:
        told = f"{robot.namespace} did not get to its start at ({place[0]:.2f}, {place[1]:.2f}) m: " \
               f"'{handle.get_goal_status_text()}'"
        if tries >= START_TRIES:
            raise MissionFailed(f'{told} (tried {tries} times)')
        rospy.logwarn('%s; it is sent again', told)
        rospy.sleep(START_PAUSE_S)
        robot.drive(*place)

    def run(self) -> None:
        """Carry out the mission to its end. :raises MissionFailed: if a robot cannot sample, or ROS is shut down."""
        self.began = time.perf_counter()
        start_ns = now_ns()
        commands = self._coordinator.start(start_ns)
        threading.Thread(target=self._tell_end, name='budget', daemon=True).start()
        self._carry_out(commands)
        while not (self._coordinator.complete or self._take_events()):
            pass
        self._finish()
        self.ended = time.perf_counter()

    def shut_down(self) -> None:
        """End all waits for robots, because ROS ends. From any thread."""
        self._events.put(SHUTDOWN)

    def _tell_end(self) -> None:
        try:
            rospy.sleep(rospy.Duration(nsecs=self._coordinator.end_ns - now_ns()))
        except rospy.ROSInterruptException:
            return
        self._events.put(END)

    def _next(self) -> Any:
        event = self._events.get()
        if event is SHUTDOWN:
            raise MissionFailed('ROS was shut down during the mission')
        return event

    def _take_events(self) -> bool:
        """Wait for an event and handle all that are there; return whether the budget is over."""
        events = [self._next()]
        with contextlib.suppress(queue.Empty):
            while True:
                events.append(self._events.get_nowait())
        if SHUTDOWN in events:
            raise MissionFailed('ROS was shut down during the mission')
        for index, handle in sorted((event for event in events if event is not END), key=lambda event: event[0]):
            self._carry_out(self._tell(index, handle))
        self._show()
        return END in events

    def _tell(self, index: int, handle: Any, at_ns: Optional[int] = None) -> Any:
        """Report the end of a goal to the mission; return the commands that follow."""
        robot = self._robots[index]
        is_drive = robot.is_driving
        reached = robot.end_of_goal(handle)
        if reached is None:
            return []
        at_ns = now_ns() if at_ns is None else at_ns
        if is_drive:
            tell = self._coordinator.arrived if reached else self._coordinator.failed
            return tell(index, at_ns, robot.place_after(handle))
        if not reached:
            raise MissionFailed(f"{robot.namespace} could not sample: '{handle.get_goal_status_text()}'")
        place = robot.place()
        with self._computing():
            value = self._coordinator.truth.value_at(place.x, place.y)
            return self._coordinator.sampled(index, at_ns, place, value)

    def _carry_out(self, commands: Any) -> None:
        for command in commands:
            robot = self._robots[command.robot]
            if isinstance(command, Drive):
                robot.drive(command.x, command.y)
            elif isinstance(command, TakeSample):
                robot.take_sample(command.dwell_ns)

    def _finish(self) -> None:
        """End the mission. Robots are stopped first, so that their places are known; goals reached by then count."""
        end_ns = now_ns()
        for robot in self._robots:
            robot.cancel()
        last = {}
        while any(robot.is_busy and robot.index not in last for robot in self._robots):
            index, handle = self._next()
            if index >= 0:
                last[index] = handle
        for index, handle in sorted(last.items()):
            if self._robots[index].is_reached(handle):
                self._tell(index, handle, end_ns)
        self._coordinator.end(end_ns, [robot.place() for robot in self._robots])
        self._show()


def now_ns() -> int:
    """Return the present ROS time [simulated ns]."""
    return rospy.Time.now().to_nsec()
