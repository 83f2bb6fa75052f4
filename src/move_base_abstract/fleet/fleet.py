"""A fleet in plain Python, without ROS: send goals, call :meth:`Fleet.run`, read the trace.

    fleet = Fleet(make_scenario({'robots': [{'name': 'bot', 'max_speed': 2.0}]}))
    fleet.send('bot', 10.0, 0.0)
    fleet.run()
    fleet.trace[-1]        # TraceEntry(time_ns=6000000000, robot='bot', kind='ended', ...)

The robots are those of the nodes, with the same settings, and time is kept in the same integer nanoseconds. Tests
compare the ROS fleet with this one.
"""
import itertools

from ..common.arguments import as_float, as_instant, check_kind
from ..common.errors import ConfigurationError, TimeError
from ..common.parameter_table import checked
from ..common.units import NS_PER_S, seconds_to_ns
from ..encounters.control import make_encounters
from ..energy.battery import STATE_OF_CHARGE
from ..engine.simulation import Simulation
from ..faults.failures import REQUEST, check_request
from ..goals.events import new
from ..goals.navigator import GoalPose
from ..motion.geometry import STRAIGHT_AHEAD, Pose2D, quaternion_of_yaw
from ..runs.event_log_file import End, write_event_log
from ..runs.trace import TraceEntry
from ..scenario import Scenario, make_robot
from ..sensing.surroundings import Surroundings
from ..tasks.arrivals import check_task
from ..tasks.places import PRIORITY
from ..tasks.room import Rooms
from ..traffic.control import Traffic
from .member import FleetWarning, Member, Members
from .robot_rows import TraceRows
from .robot_view import RobotView
from .user_calls import UserCalls

__all__ = ['Fleet', 'FleetWarning', 'TraceEntry']


class Fleet:
    """Robots on one event queue. At equal times: lower robot index first, then first scheduled, then users' calls.

    ``on_end(robot, goal_id, state, text, now_ns)``, if given, is called when a goal ends, and may send the next one.
    ``on_worked`` is called in the same way when a task at a place ends (:meth:`work`). ``on_event(entry)`` is called
    with each :class:`TraceEntry`, at the end of its instant and in the order of the trace. With ``trace=None`` nothing
    is recorded; otherwise :attr:`trace` is a list that begins with the entries of ``trace``. ``occupancy``
    (OccupancyMap in the global frame) is the map of the robots with ``use_map``. ``planner`` replaces the planner that
    the settings ask for. :attr:`warnings` has the warnings that a node would log, for example why a goal has no plan:
    [:class:`FleetWarning`, ...]; it is empty if there is no trace.
    """

    def __init__(self, scenario=Scenario(()), start_ns=NS_PER_S, on_end=None, planner=None, trace=(), occupancy=None,
                 on_worked=None, on_event=None):
        self.simulation = Simulation(as_instant(start_ns, 'start_ns'))
        self._start_ns = self.simulation.now_ns
        self._trace = None if trace is None else list(trace)
        self._rows = None if trace is None else TraceRows()  # the rows of the trace that are not in self._trace yet
        self._user_calls = UserCalls(self.simulation, on_event, on_end, on_worked)
        self.scenario = scenario
        self._rooms = None if scenario.places is None else Rooms(self.simulation, scenario.places)
        self._planner = planner
        self._occupancy = occupancy
        self.traffic = Traffic(self.simulation, scenario.zones, scenario.traffic)
        self.surroundings = Surroundings()
        self.encounters = make_encounters(self.simulation, scenario)
        self._members = Members()
        self.warnings = []
        self._indices = itertools.count()
        for spec in scenario.robots:
            self._add(spec)

    @property
    def trace(self):
        """All that has happened, a list of :class:`TraceEntry`, or None; each access adds the new entries to it."""
        if self._rows is not None:
            self._trace += self._rows.read()
        return self._trace

    @property
    def now_ns(self):
        """The present simulated time [ns]."""
        return self.simulation.now_ns

    @property
    def now(self):
        """The present simulated time [s]."""
        return self.simulation.now_ns / NS_PER_S

    @property
    def names(self):
        """The robots' names, in the order of their indices."""
        return list(self._members)

    @property
    def robots(self):
        """The robots, in the order of their indices: [:class:`.RobotView`, ...]."""
        return [RobotView(self, name) for name in self._members]

    def robot(self, name):
        """Return a robot's :class:`.RobotView`. :raises ConfigurationError: if there is none of that name."""
        return RobotView(self, name)

    def __repr__(self):
        return '<Fleet of {} robots at {:.3f} s>'.format(len(self._members), self.now)

    def add(self, name, **parameters):
        """Add a robot now; ``parameters`` are those of the ``move_base`` node.

        :raises ConfigurationError: if the name is taken or not a ROS name, or a parameter is not allowed.
        """
        if name in self._members:
            raise ConfigurationError("robot '{}' is there already".format(name))
        self._add(make_robot(name, parameters, name))

    def remove(self, name):
        """Remove a robot; its goal, if any, is aborted."""
        self._members[name].remove(self.now_ns)
        del self._members[name]

    def reset(self):
        """Put all robots back to their start, without goals. Simulated time is not reset."""
        for member in self._members.values():
            member.reset(self.now_ns)

    def send(self, name, x, y, yaw=0.0, goal_id='', frame='map'):
        """Send a goal [m, rad, in ``frame``] to a robot now; return its id.

        If anything is wrong with the goal, it ends with a text that says why.

        :raises ConfigurationError: if there is no such robot, or an argument is of a wrong type.
        """
        if not type(x) is type(y) is type(yaw) is float:
            x, y, yaw = as_float(x, 'x'), as_float(y, 'y'), as_float(yaw, 'yaw')
        if not type(goal_id) is type(frame) is str:
            check_kind(goal_id, str, 'goal_id')
            check_kind(frame, str, 'frame')
        member = self._members[name]
        goal_id = goal_id or f'{name}-{next(member.goal_numbers)}'
        goal = new(GoalPose, (
            frame, 0, (x, y), quaternion_of_yaw(yaw) if yaw else STRAIGHT_AHEAD, 0.0))
        member.navigator.receive(goal_id, 0, goal, self.simulation.now_ns)
        return goal_id

    def cancel(self, name, goal_id=''):
        """Cancel a robot's goal ``goal_id``, or, without an id, whatever goal it has."""
        self._members[name].navigator.cancel(goal_id, 0, self.now_ns)

    def work(self, name, task, goal_id=''):
        """Have a robot, which must stand at the place, do ``task`` (:class:`arrivals.Task`) now; return the goal's id.

        :raises ConfigurationError: if the scenario says nothing of places.
        """
        check_task(task)
        check_kind(goal_id, str, 'goal_id')
        goal_id = goal_id or task.task_id
        self._members[name].worker.take(goal_id, 0, task, self.now_ns)
        return goal_id

    def cancel_work(self, name, goal_id=''):
        """Cancel a robot's task ``goal_id``, or, without an id, whatever task it has."""
        self._members[name].worker.cancel(goal_id, 0, self.now_ns)

    def place(self, name, pose):
        """Put a robot at ``pose`` (Pose2D, global frame) at once. If it has a goal, it goes on from there."""
        check_kind(pose, Pose2D, 'pose')
        self._members[name].navigator.travel.place(pose, self.now_ns)

    def hold(self, name, reason):
        """Have a robot stand where it is, with its goal active, for ``reason`` (a text), until :meth:`release`."""
        check_kind(reason, str, 'reason')
        self._members[name].navigator.travel.hold(reason, self.now_ns)

    def release(self, name, reason):
        """End the hold for ``reason``. If no other reason holds the robot, its way is planned anew and it goes on."""
        self._members[name].navigator.travel.release(reason, self.now_ns)

    def fail(self, name, kind=None, repair=None):
        """Have a robot fail now; return whether it has. A robot that has failed already does not fail again.

        ``kind``: how it fails; None: as its ``failure_kind`` says. ``repair`` [s]: after how long it is repaired; None:
        as drawn.

        :raises ConfigurationError: if the robot never fails (``failure_kind: none``), or a value is not allowed.
        """
        failing = self._members[name].failing
        check_request(kind, repair, "robot '{}'".format(name))
        return failing.fail(REQUEST, self.now_ns, kind, repair)

    def repair(self, name):
        """Repair a robot now; return whether it had failed.

        :raises ConfigurationError: if the robot never fails (``failure_kind: none``).
        """
        return self._members[name].failing.repair(self.now_ns)

    def set_charge(self, name, state_of_charge):
        """Set the state of charge (0..1) of a robot's battery now.

        :raises ConfigurationError: if the robot has no battery, or the value is not allowed.
        """
        battery, where = self._members[name].battery, "robot '{}'".format(name)
        battery.set(checked(state_of_charge, 'state_of_charge', STATE_OF_CHARGE, where), self.now_ns)

    def set_tool(self, name, works):
        """Switch a robot's tool on or off now. While it is on, it draws ``tool_power`` from the battery.

        :raises ConfigurationError: if the robot has no battery.
        """
        self._members[name].battery.set_tool(works, self.now_ns)

    def condition(self, name):
        """Return a robot's :class:`.condition.Condition`."""
        return self._members[name].condition

    def close_zone(self, name, closed=True):
        """Let no robot into a zone from now on, or, with ``closed=False``, let robots in again.

        :raises ConfigurationError: if there is no zone of that name.
        """
        self.traffic.close_zone(name, closed)

    def set_priority(self, name, priority):
        """Give a robot another priority, with which it waits for zones and lanes from now on.

        :raises ConfigurationError: if it is not a whole number of 32 bits.
        """
        number = checked(priority, 'priority', PRIORITY, "robot '{}'".format(name))
        self._members[name].set_priority(number, self.now_ns)

    def set_zone_limit(self, name, max_speed=None):
        """Limit the speed of robots in a zone to ``max_speed`` [m/s] from now on; None removes the limit.

        :raises ConfigurationError: if there is no zone of that name, or the speed is not allowed.
        """
        self.traffic.set_zone_limit(name, max_speed)

    @property
    def zones(self):
        """The zones, and the lanes with a capacity, with the robots in them and waiting: [:class:`.AreaState`, ...]."""
        return self.traffic.states()

    def use_map(self, occupancy):
        """Use another map (OccupancyMap) from now on; routes that it blocks are planned again."""
        self._occupancy = occupancy
        for member in self._members.values():
            member.use_map(occupancy)
        for member in self._members.values():
            member.navigator.travel.map_changed(self.now_ns)

    def pose(self, name):
        """Return a robot's present pose (Pose2D, global frame)."""
        return self._members[name].robot.pose_at(self.now_ns)

    def scan(self, name):
        """Return the scan that a robot's laser measures now (:class:`.laser.Scan`), by its ``scan_`` parameters."""
        return self._members[name].scan(self.now_ns)

    def distance(self, name):
        """Return the distance that a robot has driven so far [m]."""
        return self._members[name].robot.distance_at(self.now_ns)

    def at(self, time_ns, action):
        """Call ``action(fleet)`` at the simulated time ``time_ns`` [ns], a whole number.

        :raises TimeError: if that time is past, or after the end of simulated time.
        """
        time_ns = as_instant(time_ns, 'time_ns')
        if time_ns < self.now_ns:
            raise TimeError('time {} ns is past, it is {} ns'.format(time_ns, self.now_ns))
        self._user_calls.at(time_ns, lambda _due_ns, _now_ns: action(self))

    def run(self, until_ns=None, until=None):
        """Run up to ``until_ns`` [ns] or ``until`` [s], or until no events are left; return the time [ns].

        Without either, the run waits neither for a battery to be charged or used up, nor for failures yet to come.

        :raises TimeError: if that time is past, or after the end of simulated time.
        """
        if until is not None:
            until_ns = seconds_to_ns(as_float(until, 'until'))
        until_ns = None if until_ns is None else as_instant(until_ns, 'until_ns')
        self.simulation.run(until_ns)
        return self.now_ns

    def run_for(self, seconds):
        """Run for ``seconds`` of simulated time; return the time [ns]."""
        return self.run(self.now_ns + seconds_to_ns(as_float(seconds, 'seconds')))

    def write_log(self, path):
        """Write :attr:`trace` as an event log (JSON lines), which replay, compare and the report read.

        :raises ConfigurationError: if the fleet has no trace, or ``path`` is a file that is not an event log.
        :raises OutputError: if the file cannot be written.
        """
        if self._trace is None:
            raise ConfigurationError('trace: got None, so there is nothing to write; allowed: a list')
        write_event_log(path, self.trace, self._start_ns, End(
            self.now_ns, not self.simulation.queue.is_busy(),
            [name for name, member in self._members.items() if member.navigator.is_active]))

    def _note(self, warning):
        if self._trace is not None:
            self.warnings.append(warning)

    def _add(self, spec):
        self._members[spec.name] = Member(self, spec, next(self._indices), self._planner, self._occupancy)
