"""Tasks at places: who works, who waits, in which order; how they end; what they draw from a battery."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.engine.factors import Even
from move_base_abstract.engine.simulation import Simulation
from move_base_abstract.fleet import Fleet
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import robot_stream
from move_base_abstract.goals.outcome import NODE_KILLED
from move_base_abstract.goals.task_events import LoadChanged, TaskEnded
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task
from move_base_abstract.tasks.place_tasks import PlaceTaskRunner
from move_base_abstract.tasks.places import read_places
from move_base_abstract.tasks.room import Rooms

S = 1_000_000_000
DOCK = {'name': 'dock', 'x': 1.0, 'capacity': 1, 'duration': 10.0}


def fleet_of(*names, places=(DOCK,), **arguments):
    return Fleet(make_scenario({'seed': 3, 'defaults': {'max_speed': 2.0}, 'places': list(places), 'robots': [
        {'name': name, 'start_x': 1.0} for name in names]}), start_ns=0, **arguments)


def at_dock(task_id, seconds=0.0, **values):
    return Task(task_id, 0, 'dock', Pose2D(), int(seconds * S), **values)


def told(fleet, kinds=('task_began', 'task_ended')):
    """Return [(s, robot, kind, values)] of the trace."""
    return [(entry.time_ns / S, entry.robot, entry.kind, *entry.values) for entry in fleet.trace if entry.kind in kinds]


def test_at_one_instant_the_lower_index_comes_first_then_who_came_first():
    fleet = fleet_of('a', 'b', 'c')
    fleet.at(0, lambda fleet: fleet.robot('c').send_task(at_dock('tc', 3.0)))
    fleet.at(0, lambda fleet: fleet.robot('b').send_task(at_dock('tb')))
    fleet.at(2 * S, lambda fleet: fleet.robot('a').send_task(at_dock('ta')))
    fleet.run()
    assert told(fleet) == [
        (0.0, 'b', 'task_began', 'tb', 10 * S), (10.0, 'b', 'task_ended', 'tb', 'SUCCEEDED', 'Task done.'),
        (10.0, 'c', 'task_began', 'tc', 3 * S), (13.0, 'c', 'task_ended', 'tc', 'SUCCEEDED', 'Task done.'),
        (13.0, 'a', 'task_began', 'ta', 10 * S), (23.0, 'a', 'task_ended', 'ta', 'SUCCEEDED', 'Task done.')]
    assert told(fleet, ('waiting_began', 'waiting_ended')) == [
        (0.0, 'c', 'waiting_began', 'tc', 'dock'), (2.0, 'a', 'waiting_began', 'ta', 'dock'),
        (10.0, 'c', 'waiting_ended', 'tc', 'dock'), (13.0, 'a', 'waiting_ended', 'ta', 'dock')]


def test_as_many_work_as_there_is_room_for_and_any_number_where_nothing_is_said():
    for capacity, last in ((1, 30.0), (2, 20.0), (3, 10.0), (None, 10.0)):
        place = {key: value for key, value in {**DOCK, 'capacity': capacity}.items() if value}
        fleet = fleet_of('a', 'b', 'c', places=[place])
        for name in 'abc':
            fleet.robot(name).send_task(at_dock('t' + name))
        assert fleet.run() == last * S


def test_who_waits_no_more_is_passed_over():
    fleet = fleet_of('a', 'b', 'c')
    for name in 'abc':
        fleet.robot(name).send_task(at_dock('t' + name))
    fleet.at(4 * S, lambda fleet: fleet.robot('b').cancel_task())
    fleet.at(5 * S, lambda fleet: fleet.robot('a').cancel_task())
    fleet.run()
    assert told(fleet)[1:] == [
        (4.0, 'b', 'task_ended', 'tb', 'PREEMPTED', ''), (5.0, 'a', 'task_ended', 'ta', 'PREEMPTED', ''),
        (5.0, 'c', 'task_began', 'tc', 10 * S), (15.0, 'c', 'task_ended', 'tc', 'SUCCEEDED', 'Task done.')]
    assert told(fleet, ('waiting_ended',)) == [(4.0, 'b', 'waiting_ended', 'tb', 'dock'),
                                               (5.0, 'c', 'waiting_ended', 'tc', 'dock')]


def test_a_robot_that_sets_out_or_is_put_elsewhere_ends_its_task_and_leaves_the_room():
    fleet = fleet_of('a', 'b', 'c')
    for name in 'abc':
        fleet.robot(name).send_task(at_dock('t' + name))
    fleet.at(2 * S, lambda fleet: fleet.robot('b').place(Pose2D(9.0)))
    fleet.at(4 * S, lambda fleet: fleet.robot('a').send(5.0, 0.0))
    fleet.run()
    left = 'The robot has left the place of its task.'
    assert told(fleet)[1:4] == [
        (2.0, 'b', 'task_ended', 'tb', 'ABORTED', left), (4.0, 'a', 'task_ended', 'ta', 'ABORTED', left),
        (4.0, 'c', 'task_began', 'tc', 10 * S)]


def test_a_robot_that_is_put_somewhere_within_reach_goes_on_working():
    fleet = fleet_of('a')
    fleet.robot('a').send_task(at_dock('ta'))
    fleet.at(2 * S, lambda fleet: fleet.robot('a').place(Pose2D(1.3, 0.3)))
    assert fleet.run() == 10 * S


@pytest.mark.parametrize('task, text', [
    (Task('t', 0, 'moon', Pose2D(), S), 'place: got moon; allowed: dock'),
    (Task('t', 0, '', Pose2D(1.0), 0), 'duration: got 0 s and no place that has one; allowed: > 0 s'),
    (Task('t', 0, 'dock', Pose2D(), S, power=float('nan')), 'power: got nan; allowed: a finite number >= 0'),
    (Task('t', 0, 'dock', Pose2D(), S, energy=-1.0), 'energy: got -1; allowed: a finite number >= 0'),
    (Task('t', 0, '', Pose2D(2.0), S),
     'The robot stands at (1.000, 0.000); it has to stand within 0.5 m of its place at (2, 0).'),
    (Task('t', 0, 'dock', Pose2D(), 2 ** 62), 'The task takes too long'),
])
def test_what_cannot_be_done_is_aborted_with_the_reason_and_takes_no_room(task, text):
    ends = []
    fleet = fleet_of('a', 'b', on_worked=lambda *end: ends.append(end))
    fleet.robot('a').send_task(task)
    fleet.robot('b').send_task(at_dock('tb'))
    assert fleet.run() == 10 * S
    assert ends[0][2].name == 'ABORTED'
    assert ends[0][3].startswith(text)


def test_a_robot_that_fails_ends_its_task_and_takes_none_until_it_is_repaired():
    fleet = Fleet(make_scenario({'places': [DOCK], 'robots': [
        {'name': 'a', 'start_x': 1.0, 'failure_kind': 'stall'}, {'name': 'b', 'start_x': 1.0}]}), start_ns=0)
    fleet.robot('a').send_task(at_dock('one'))
    fleet.robot('b').send_task(at_dock('two', 2.0))
    fleet.at(4 * S, lambda fleet: fleet.robot('a').fail('stall', 3.0))
    fleet.at(5 * S, lambda fleet: fleet.robot('a').send_task(at_dock('three')))
    fleet.at(8 * S, lambda fleet: fleet.robot('a').send_task(at_dock('four')))
    fleet.run()
    failed = 'Aborting on the goal because the robot has failed'
    assert [entry[:5] for entry in told(fleet)][1:] == [
        (4.0, 'a', 'task_ended', 'one', 'ABORTED'), (4.0, 'b', 'task_began', 'two', 2 * S),
        (5.0, 'a', 'task_ended', 'three', 'ABORTED'), (6.0, 'b', 'task_ended', 'two', 'SUCCEEDED'),
        (8.0, 'a', 'task_began', 'four', 10 * S), (18.0, 'a', 'task_ended', 'four', 'SUCCEEDED')]
    assert [entry[5] for entry in told(fleet) if entry[4] == 'ABORTED'] == [failed] * 2


def test_a_robot_on_its_way_does_not_work():
    fleet = fleet_of('a')
    fleet.robot('a').send(5.0, 0.0)
    fleet.robot('a').send_task(at_dock('ta'))
    assert told(fleet)[-1][4:] == ('ABORTED', 'The robot is on its way; it has to stand within 0.5 m of dock.')


def test_a_newer_task_ends_the_one_under_way_and_waits_behind_the_others():
    fleet = fleet_of('a', 'b')
    fleet.robot('a').send_task(at_dock('one'))
    fleet.robot('b').send_task(at_dock('two'))
    fleet.at(3 * S, lambda fleet: fleet.robot('a').send_task(at_dock('three')))
    fleet.run()
    assert [entry[3] for entry in told(fleet, ('task_began',))] == ['one', 'two', 'three']


def test_durations_that_a_task_does_not_say_follow_from_seed_robot_and_number():
    place = {**DOCK, 'capacity': 3, 'duration_distribution': 'gamma', 'duration_cv': 1.0}

    def durations(*names):
        def more(name, goal_id, *_):
            if goal_id < '2':
                fleet.robot(name).send_task(at_dock(str(int(goal_id) + 1)))
        fleet = fleet_of(*names, places=[place], on_worked=more)
        for name in names:
            fleet.robot(name).send_task(at_dock('0'))
        fleet.run()
        return [entry.values[1] for entry in fleet.trace if (entry.robot, entry.kind) == ('b', 'task_began')]
    alone, together = durations('b'), durations('a', 'b')
    assert alone == together
    assert len(set(alone)) == 3


def test_removed_and_reset_robots_leave_the_room():
    for leave in (lambda fleet: fleet.remove('a'), lambda fleet: fleet.reset()):
        fleet = fleet_of('a', 'b')
        fleet.robot('a').send_task(at_dock('ta'))
        fleet.at(S, leave)
        fleet.at(2 * S, lambda fleet: fleet.robot('b').send_task(at_dock('tb')))
        assert fleet.run() == 12 * S


def test_without_places_nobody_works_and_nothing_else_is_told():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a'}]}))
    with pytest.raises(ConfigurationError, match='the scenario has no list of places'):
        fleet.robot('a').send_task(at_dock('ta'))
    traces = []
    for scenario in ({'robots': [{'name': 'a'}]}, {'robots': [{'name': 'a'}], 'places': []}):
        fleet = Fleet(make_scenario(scenario))
        fleet.robot('a').send(3.0, 4.0)
        fleet.run()
        traces.append(fleet.trace)
    assert traces[0] == traces[1]


class Rig:
    """Two robots that are not known here; ``loads`` gets (s, W), ``ends`` (s, state, waited s, worked s)."""

    def __init__(self, seconds=None, seed=0, frequency=0.0):
        self.loads, self.ends, self.shares = [], [], []
        self.simulation = Simulation()
        self.rooms = Rooms(self.simulation, read_places([DOCK], 'test'), seconds)
        client = NoClient('r')
        client.progress = lambda _record, elapsed_ns, duration_ns, now_ns: self.shares.append(
            (now_ns / S, elapsed_ns / duration_ns))
        self.tasks = [PlaceTaskRunner(self.rooms, index, 'r_{}'.format(index), seed, self.stream(index), client, None,
                                      frequency) for index in range(2)]

    def stream(self, index):
        stream = robot_stream()
        stream.subscribe('battery', {LoadChanged: lambda event: self.loads.append((event.time_ns / S, event.watts))})
        stream.subscribe('clients', {TaskEnded: lambda event: self.ended(self.tasks[index], event)})
        return stream

    def ended(self, tasks, event):
        self.ends.append((event.time_ns / S, event.state.name, tasks.waited_ns(event.time_ns) / S,
                          tasks.elapsed_ns(event.time_ns) / S))

    def take(self, index, seconds, task):
        self.simulation.advance(int(seconds * S))
        self.tasks[index].take(task.task_id, 0, task, self.simulation.now_ns)


def test_work_draws_its_power_and_its_energy_evenly_while_it_is_worked_on():
    rig = Rig()
    rig.take(0, 1.0, at_dock('a', 4.0, power=50.0, energy=20.0))
    rig.take(1, 2.0, at_dock('b', 5.0, energy=10.0))
    rig.simulation.advance(7 * S)
    rig.tasks[1].cancel('b', 0, 7 * S)
    assert rig.loads == [(1.0, 55.0), (5.0, 0.0), (5.0, 2.0), (7.0, 0.0)]
    assert rig.ends == [(5.0, 'SUCCEEDED', 0.0, 4.0), (7.0, 'PREEMPTED', 3.0, 2.0)]


def test_who_is_cancelled_while_waiting_has_waited_and_not_worked():
    rig = Rig()
    rig.take(0, 1.0, at_dock('a', 4.0))
    rig.take(1, 2.0, at_dock('b', 5.0))
    rig.simulation.advance(4 * S)
    rig.tasks[1].shut_down(NODE_KILLED, 4 * S)
    rig.simulation.advance(20 * S)
    assert rig.ends == [(4.0, 'ABORTED', 2.0, 0.0), (5.0, 'SUCCEEDED', 0.0, 4.0)]
    assert rig.loads == []


def test_a_clock_that_starts_anew_aborts_tasks_and_the_room_is_free():
    rig = Rig()
    rig.take(0, 5.0, at_dock('a', 4.0))
    rig.take(1, 6.0, at_dock('b', 4.0))
    rig.simulation.restart(1 * S)
    for tasks in rig.tasks:
        tasks.restart(6 * S, 1 * S)
    rig.take(1, 2.0, at_dock('c', 4.0))
    rig.simulation.advance(20 * S)
    assert rig.ends == [(1.0, 'ABORTED', 0.0, 1.0), (1.0, 'ABORTED', 0.0, 0.0), (6.0, 'SUCCEEDED', 0.0, 4.0)]


def anywhere(task_id, seconds=0.0):
    return Task(task_id, 0, '', Pose2D(), int(seconds * S))


def test_progress_is_told_at_its_frequency_and_at_the_end():
    rig = Rig(frequency=2.0)
    rig.take(0, 0.0, anywhere('a', 1.0))
    for quarters in range(20):
        rig.simulation.advance(quarters * S // 4)
    assert rig.shares == [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)]


def test_a_task_may_end_at_the_end_of_time_and_takes_no_negative_time():
    rig = Rig()
    rig.take(0, 3.0, anywhere('a', 2_147_483_644.0))
    rig.take(1, 3.0, anywhere('b', -1.0))
    rig.take(1, 3.0, anywhere('c', 2_147_483_645.0))
    rig.simulation.advance(2_147_483_647 * S)
    assert rig.ends == [(3.0, 'ABORTED', 0.0, 0.0), (3.0, 'ABORTED', 0.0, 0.0),
                        (2_147_483_647.0, 'SUCCEEDED', 0.0, 2_147_483_644.0)]


def test_durations_of_tasks_at_no_place_follow_from_seed_and_robot_and_lie_in_their_range():
    def durations(seed):
        rig = Rig(Even(2.0, 0.5), seed)
        for number in range(100):
            for index in range(2):
                rig.take(index, 3.0 * number, anywhere('{} {}'.format(index, number)))
        rig.take(0, 303.0, at_dock('dock'))
        rig.simulation.advance(400 * S)
        assert rig.ends.pop()[3] == 10.0  # that of the place
        return [end[3] for end in rig.ends]
    values = durations(7)
    assert values == durations(7) and len(set(values)) == 200 and not set(values) & set(durations(8))
    assert 1.5 <= min(values) < 1.6 and 2.4 < max(values) <= 2.5
