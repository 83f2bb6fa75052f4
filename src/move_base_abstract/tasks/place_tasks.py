"""The tasks of one robot: it waits until there is room at their place, works, and draws from its battery."""
from __future__ import annotations

import math
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from ..common.shown import shown_text
from ..common.units import NS_PER_S, check_reachable
from ..engine.chance import Chance, Purpose
from ..engine.guard import attempt_each, fault_text, guarded
from ..goals.events import EMPTY, ChargePassed, Departed, Driven, Failed, Stands
from ..goals.ledger import GoalLedger
from ..goals.outcome import BATTERY_EMPTY, CANCELLED, CLOCK_RESTARTED, FAILED, GoalState, Outcome, aborted
from ..goals.task_events import LoadChanged, TaskBegan, TaskWaited, TaskWaits, WorksAt
from .arrivals import drawn_ns, some_of
from .room import Guest, Rooms

if TYPE_CHECKING:
    from ..engine.event_queue import Event
    from ..engine.stream import Stream
    from ..goals.client import TaskClient
    from ..goals.ledger import GoalRecord
    from ..motion.robot import Robot
    from .arrivals import Task

REFUSED = 'The queue at {} is full: {} wait there, and no more may.'
LEFT = aborted('The robot has left the place of its task.')
DONE = Outcome(GoalState.SUCCEEDED, 'Task done.')


class PlaceTaskRunner:
    """The life of one robot's tasks, one at a time, from the goal to the ending. Not thread-safe, as the simulation.

    ``stream``: the robot's stream of events, for telling and hearing; ``client`` (TaskClient): the client of the goals;
    ``robot`` (Robot), None: the robot is not known here, so its pose is not checked. ``seed`` and ``robot_name``
    determine the durations that are drawn for tasks without one. The client is told the progress
    ``progress_frequency`` times per simulated second while the robot works and, unless that is 0, at the end.
    ``has_failed()`` returns whether the robot cannot work now.
    """

    def __init__(self, rooms: Rooms, robot_index: int, robot_name: str, seed: int, stream: Stream, client: TaskClient,
                 robot: Optional[Robot] = None, progress_frequency: float = 0.0,
                 has_failed: Callable[[], bool] = lambda: False) -> None:
        #: the GoalLedger of its goals
        self.ledger = GoalLedger(robot_name, stream, client, of_tasks=True)
        self._simulation = rooms.simulation
        self._robot_index = robot_index
        self._on_progress = client.progress
        self._progress = rooms.simulation.series(robot_index, progress_frequency, self._tell_progress,
                                                 is_output=True, is_heard=client.is_progress_heard)
        self._end: Optional[Event] = None  # the event at which the work ends
        self._began_ns = self._duration_ns = 0
        self._rooms = rooms
        self._robot = robot
        self._has_failed = has_failed
        self._robot_name = robot_name
        self._seed = seed
        self._chance: Optional[Chance] = None
        self._tell = stream.tell
        if robot is not None:
            stream.subscribe('tasks', {**dict.fromkeys((Departed, Driven, Stands), self._moved), Failed: self._failed,
                                       ChargePassed: self._charge_passed})
        self._number = 0
        self._task: Any = None  # a Task
        self._room: Any = None  # a Room
        self._ticket: Optional[int] = None
        self._is_admitted = False
        self._asked_ns = 0
        self._done_ns = self._left_ns = 0  # the time worked and the time left when the task had to give way
        self._draws = False
        self._waits: Optional[GoalRecord] = None  # the record of the goal that waits, once that has been reported

    @property
    def is_waiting(self) -> bool:
        """Whether the robot waits for room."""
        return self._waits is not None

    @property
    def is_working(self) -> bool:
        """Whether the robot works."""
        return self._end is not None

    @property
    def place(self) -> str:
        """The name of the place of the latest task, '': it has none."""
        return '' if self._task is None else str(self._task.place)

    def waited_ns(self, now_ns: int) -> int:
        """Return the time that the latest task has waited [ns]."""
        return (now_ns if self._is_pending else self._began_ns) - self._asked_ns - self._done_ns

    def elapsed_ns(self, now_ns: int) -> int:
        """Return the time that the robot has worked on the latest task [ns]."""
        return self._done_ns + min(now_ns - self._began_ns, self._duration_ns)

    @property
    def _is_pending(self) -> bool:
        return self._ticket is not None and not self._is_admitted

    @guarded
    def take(self, goal_id: str, stamp_ns: int, task: Task, now_ns: int, fault: Optional[str] = None) -> None:
        """Take in the goal ``task`` (Task); it ends the task that is under way.

        ``fault``: a text that says why the goal cannot be done, None: nothing is known to be wrong.
        """
        record = self.ledger.receive(goal_id, stamp_ns, now_ns)
        if record is None:
            return
        self._stop()
        self._number += 1
        self._left_ns = 0
        self._asked_ns = self._began_ns = now_ns
        self._duration_ns = self._done_ns = 0
        self._task = task
        if self._has_failed():
            self.ledger.finish(FAILED, now_ns)
            return
        fault = fault or self._fault(task)
        if fault:
            self.ledger.finish(aborted(fault), now_ns)
            return
        self._room = self._rooms.of(task.place)
        if self._room is None:
            self._begin(record, self._length_ns(task), now_ns)
            return
        self._is_admitted = False
        self._ticket = self._room.ask(Guest(
            self._robot_index, self._robot_name, self._admitted, self._told_to_wait, self._refused, self._give_way,
            task.priority), now_ns)

    @guarded
    def cancel(self, goal_id: str, stamp_ns: int, now_ns: int) -> None:
        """Take in a cancel request, as GoalLedger.cancel does; a task that it concerns ends at once."""
        if self.ledger.cancel(goal_id, stamp_ns, now_ns):
            self._stop()
            self.ledger.finish(CANCELLED, now_ns)

    @guarded
    def shut_down(self, outcome: Outcome, now_ns: int) -> None:
        """End the task that is under way with ``outcome``."""
        self._stop()
        self.ledger.finish(outcome, now_ns)

    def restart(self, before_ns: int, now_ns: int) -> None:
        """Go on after a restart of the clock: it was at ``before_ns`` [ns] and is at ``now_ns`` [ns] now.

        The task that is under way is aborted.
        """
        self._asked_ns += now_ns - before_ns
        self._began_ns += now_ns - before_ns
        self.shut_down(CLOCK_RESTARTED, now_ns)
        self.ledger.restart(now_ns)

    def break_off(self, error: Any) -> None:
        """End the task after the exception ``error``, with a text from that."""
        now_ns = self._simulation.now_ns
        attempt_each(self._simulation, 'the task of robot {}'.format(self._robot_index), error, (
            (self._stop,), (self.ledger.finish, aborted(fault_text(error)), now_ns)))

    def _begin(self, record: GoalRecord, duration_ns: int, now_ns: int) -> None:
        """Work on the goal ``record`` for ``duration_ns`` [ns] from now on. If that is not possible, abort the goal."""
        self._began_ns = now_ns
        try:
            check_reachable(now_ns + duration_ns, 'the task would end')
        except ValueError as error:
            self._duration_ns = 0
            self.ledger.finish(aborted('The task takes too long: {}'.format(error)), now_ns)
            return
        self._duration_ns = duration_ns
        if self._room is not None:
            self._tell(WorksAt(now_ns, self._robot_name, record.goal_id, self._task.place, self._room.capacity))
        self._tell(TaskBegan(now_ns, self._robot_name, record.goal_id, duration_ns))
        watts = self._task.power + self._task.energy * NS_PER_S / (self._done_ns + duration_ns)
        if watts > 0.0:
            self._draws = True
            self._tell(LoadChanged(now_ns, self._robot_name, watts))
        self._end = self._simulation.queue.schedule(now_ns + duration_ns, self._robot_index, self._done)
        if self._progress is not None:
            self._progress.start(now_ns)

    @guarded
    def _done(self, due_ns: int, _now_ns: int) -> None:
        self._end = None
        self._stop()
        if self._progress is not None:
            self._tell_progress(due_ns, due_ns)
        self.ledger.finish(DONE, due_ns)

    @guarded
    def _moved(self, event: Union[Departed, Driven, Stands]) -> None:
        """Note that the robot has departed or stands elsewhere: if that is too far away, its task ends."""
        if self._task is not None and self.ledger.active is not None and self._distance_fault(self._task):
            self.shut_down(LEFT, event.time_ns)

    def _failed(self, event: Failed) -> None:
        self.shut_down(FAILED, event.time_ns)

    def _charge_passed(self, event: ChargePassed) -> None:
        if event.what == EMPTY:
            self.shut_down(BATTERY_EMPTY, event.time_ns)

    @guarded
    def _told_to_wait(self, due_ns: int) -> None:
        if self._waits is None:
            record: Any = self.ledger.active
            self._waits = record
            self._tell(TaskWaits(due_ns, self._robot_name, record.goal_id, self._task.place))

    @guarded
    def _admitted(self, due_ns: int) -> None:
        self._is_admitted = True
        self._end_waiting(due_ns)
        record: Any = self.ledger.active
        self._begin(record, self._left_ns or self._length_ns(self._task), due_ns)
        if self._end is None:  # the task would take too long, so it has not begun
            self._stop()

    @guarded
    def _refused(self, waiting: int) -> None:
        """Abort the goal, since there is neither room nor a free place in the queue, where ``waiting`` robots wait."""
        self._ticket = None
        self.ledger.finish(aborted(REFUSED.format(self._task.place, waiting)), self._simulation.now_ns)

    @guarded
    def _give_way(self, due_ns: int) -> None:
        """Interrupt the work for a robot with a higher priority; the rest is done later."""
        self._left_ns = self._began_ns + self._duration_ns - due_ns
        self._done_ns += self._duration_ns - self._left_ns
        self._halt()
        self._stop_drawing(due_ns)
        self._began_ns, self._duration_ns, self._is_admitted = due_ns, 0, False
        self._told_to_wait(due_ns)

    def _tell_progress(self, due_ns: int, _now_ns: int) -> None:
        record: Any = self.ledger.active
        self._on_progress(record, self.elapsed_ns(due_ns), self._done_ns + self._duration_ns, due_ns)

    def _end_waiting(self, now_ns: int) -> None:
        if self._waits is not None:
            record, self._waits = self._waits, None
            self._tell(TaskWaited(now_ns, self._robot_name, record.goal_id, self._task.place))

    def _halt(self) -> None:
        """Stop working."""
        if self._end is not None:
            self._end.cancel()
            self._end = None
        if self._progress is not None:
            self._progress.stop()

    def _stop(self) -> None:
        self._halt()
        now_ns = self._simulation.now_ns
        if self._is_pending:
            self._began_ns = now_ns
        with ExitStack() as rest:  # these callbacks run even if there is an error; the last one runs first
            rest.callback(self._give_ticket_back, now_ns)
            rest.callback(self._stop_drawing, now_ns)
            self._end_waiting(now_ns)

    def _stop_drawing(self, now_ns: int) -> None:
        if self._draws:
            self._draws = False
            self._tell(LoadChanged(now_ns, self._robot_name, 0.0))

    def _give_ticket_back(self, now_ns: int) -> None:
        if self._ticket is not None:
            ticket, self._ticket = self._ticket, None
            self._room.give_back(ticket, now_ns)

    def _length_ns(self, task: Task) -> int:
        """Return the duration of the work [ns]: that of the task, or if it has none, one drawn for its place."""
        if task.duration_ns:
            return task.duration_ns
        chance = self._chance = self._chance or Chance(self._seed, self._robot_name)
        return drawn_ns(self._rooms.seconds_of(task),
                        lambda place: chance.uniform(self._number, Purpose.TASK_DURATION, place))

    def _fault(self, task: Task) -> Optional[str]:
        """Return why the robot cannot work on the task, or None."""
        places = self._rooms.places
        if task.place and task.place not in places:
            return 'place: got {}; allowed: {}'.format(shown_text(task.place), some_of(places))
        if task.duration_ns < 0:
            return 'duration must be >= 0 s, got {:g} s'.format(task.duration_ns / NS_PER_S)
        if not task.duration_ns and self._rooms.seconds_of(task) is None:
            return 'duration: got 0 s and no place that has one; allowed: > 0 s'
        for name in ('power', 'energy'):
            value = getattr(task, name)
            if not (math.isfinite(value) and value >= 0.0):
                return '{}: got {:g}; allowed: a finite number >= 0'.format(name, value)
        return self._distance_fault(task)

    def _distance_fault(self, task: Task) -> Optional[str]:
        if self._robot is None:
            return None
        place = self._rooms.place_of(task)
        if self._robot.leg is not None:
            return 'The robot is on its way; it has to stand within {:g} m of {}.'.format(place.reach, place.name)
        pose = self._robot.pose_at(self._simulation.now_ns)
        if not place.holds(pose):
            return 'The robot stands at ({:.3f}, {:.3f}); it has to stand within {:g} m of {} at ({:g}, {:g}).'.format(
                pose.x, pose.y, place.reach, place.name, place.pose.x, place.pose.y)
        return None
