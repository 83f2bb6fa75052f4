"""Places with priorities, pre-emption and a finite queue agree with SimPy's resources and with queueing theory."""
import random

import pytest
import simpy

from move_base_abstract import Fleet, make_scenario
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.tasks.arrivals import Task

S = 1_000_000_000


def jobs(seed, count, mean_gap, mean_work, priorities):
    """Return [(arrival [ns], work [ns], priority)] of ``count`` jobs; all instants differ."""
    dice, now, found = random.Random(seed), 0, []
    for _ in range(count):
        now += 1 + int(dice.expovariate(1.0 / mean_gap) * S)
        found.append((now, 1 + int(dice.expovariate(1.0 / mean_work) * S), dice.randrange(priorities)))
    return found


def by_fleet(given, **place):
    """Return ({job: [(began, ended) [ns], ...]}, set of refused jobs) for a place of a fleet."""
    fleet = Fleet(make_scenario({'places': [{'name': 'dock', **place}], 'robots': [
        {'name': 'r', 'count': len(given)}]}), start_ns=0)
    for number, (at_ns, work_ns, priority) in enumerate(given):
        task = Task(str(number), 0, 'dock', Pose2D(), work_ns, priority=priority)
        fleet.at(at_ns, lambda fleet, number=number, task=task: fleet.robot('r_{}'.format(number)).send_task(task))
    fleet.run()
    spans, began, refused = {}, {}, set()
    for entry in fleet.trace:
        number = int(entry.robot[2:])
        if entry.kind == 'task_began':
            began[number] = entry.time_ns
        elif entry.kind in ('waiting_began', 'task_ended') and number in began:
            spans.setdefault(number, []).append((began.pop(number), entry.time_ns))
        elif entry.kind == 'task_ended' and entry.values[1] == 'ABORTED':
            refused.add(number)
            assert entry.values[2] == 'The queue at dock is full: {} wait there, and no more may.'.format(
                place['queue'])
    return spans, refused


def by_simpy(given, capacity, preemption=False, queue=None):
    """Return the same as :func:`by_fleet` for SimPy's PriorityResource or PreemptiveResource."""
    env = simpy.Environment()
    kind = simpy.PreemptiveResource if preemption else simpy.PriorityResource
    desk, spans, refused = kind(env, capacity), {}, set()

    def job(number, at_ns, work_ns, priority):
        yield env.timeout(at_ns)
        is_full = desk.count == capacity and not (
            preemption and any(user.priority > -priority for user in desk.users))
        if queue is not None and is_full and len(desk.queue) >= queue:
            refused.add(number)
            return
        while work_ns:
            with desk.request(priority=-priority) as request:
                yield request
                began = env.now
                try:
                    yield env.timeout(work_ns)
                    work_ns = 0
                except simpy.Interrupt:
                    work_ns -= env.now - began
                spans.setdefault(number, []).append((began, env.now))
    for number, one in enumerate(given):
        env.process(job(number, *one))
    env.run()
    return spans, refused


@pytest.mark.parametrize('seed', range(6))
@pytest.mark.parametrize('place', [
    {'capacity': 1}, {'capacity': 3}, {'capacity': 1, 'queue': 0}, {'capacity': 2, 'queue': 3},
    {'capacity': 1, 'preemption': True}, {'capacity': 3, 'preemption': True},
    {'capacity': 2, 'preemption': True, 'queue': 2}])
def test_a_place_does_what_a_resource_does(seed, place):
    given = jobs(seed, 150, 8.0, 7.5 * place['capacity'], 1 + seed % 4)
    spans, refused = by_fleet(given, **place)
    assert (spans, refused) == by_simpy(given, **place)
    assert len(spans) + len(refused) == len(given)
    if seed % 4 and place.get('preemption'):
        assert any(len(own) > 1 for own in spans.values())
    assert bool(refused) == ('queue' in place)


@pytest.mark.parametrize('load, most', [(0.5, 3), (0.9, 4), (1.5, 2)])
def test_a_place_with_a_finite_queue_is_an_m_m_1_k(load, most):
    """``most`` is the largest number of robots in the system: those that work and those that wait."""
    given = jobs(int(10 * load), 20_000, 10.0, 10.0 * load, 1)
    fleet = Fleet(make_scenario({'places': [{'name': 'dock', 'capacity': 1, 'queue': most - 1}], 'robots': [
        {'name': 'r', 'count': most + 1}]}), start_ns=0, trace=None,
        on_worked=lambda robot, goal_id, state, text, now_ns: ended(robot, goal_id, state.name, now_ns))
    idle, arrived, refused, in_system = list(fleet.names), {}, 0, 0.0

    def ended(robot, goal_id, state, now_ns):
        nonlocal refused, in_system
        idle.append(robot)
        refused += state == 'ABORTED'
        in_system += now_ns - arrived.pop(goal_id)

    def arrives(number, work_ns):
        arrived[str(number)] = fleet.now_ns
        fleet.robot(idle.pop(0)).send_task(Task(str(number), 0, 'dock', Pose2D(), work_ns))
    for number, (at_ns, work_ns, _) in enumerate(given):
        fleet.at(at_ns, lambda _, number=number, work_ns=work_ns: arrives(number, work_ns))
    end_ns = fleet.run()
    weights = [load ** k for k in range(most + 1)]
    assert refused / len(given) == pytest.approx(weights[-1] / sum(weights), abs=0.012)
    assert in_system / end_ns == pytest.approx(
        sum(k * weight for k, weight in enumerate(weights)) / sum(weights), rel=0.04)


def test_what_is_left_after_giving_way_is_paid_for_once_and_told_as_it_is():
    scenario = make_scenario({'defaults': {'battery_capacity': 1.0, 'ambient_power': 0.0}, 'robots': [
        {'name': 'a'}, {'name': 'b'}], 'places': [{'name': 'dock', 'capacity': 1, 'preemption': True}]})
    fleet = Fleet(scenario, start_ns=0)
    fleet.robot('a').send_task(Task('long', 0, 'dock', Pose2D(), 10 * S, power=10.0, energy=500.0))
    fleet.at(4 * S, lambda fleet: fleet.robot('b').send_task(Task('urgent', 0, 'dock', Pose2D(), 5 * S, priority=1)))
    fleet.run(until=6.0)
    assert fleet.robot('a').activity.startswith('waiting')
    fleet.run()
    assert [(entry.time_ns / S, entry.robot, entry.kind, *entry.values) for entry in fleet.trace
            if entry.kind not in ('works_at', 'task_ended')] == [
        (0.0, 'a', 'task_began', 'long', 10 * S), (4.0, 'a', 'waiting_began', 'long', 'dock'),
        (4.0, 'b', 'task_began', 'urgent', 5 * S), (9.0, 'a', 'waiting_ended', 'long', 'dock'),
        (9.0, 'a', 'task_began', 'long', 6 * S)]
    assert fleet.now == 15.0
    assert fleet.robot('a').condition.battery.soc == pytest.approx(1.0 - 600.0 / (12.0 * 3600.0), rel=1e-12)


def test_an_urgent_one_that_fails_while_it_works_lets_the_other_one_go_on():
    fleet = Fleet(make_scenario({'robots': [{'name': 'a'}, {'name': 'b'}], 'places': [
        {'name': 'dock', 'capacity': 1, 'preemption': True, 'queue': 0}]}), start_ns=0)
    fleet.robot('a').send_task(Task('long', 0, 'dock', Pose2D(), 10 * S))
    fleet.at(4 * S, lambda fleet: fleet.robot('b').send_task(Task('urgent', 0, 'dock', Pose2D(), 5 * S, priority=1)))
    fleet.at(6 * S, lambda fleet: fleet.robot('b').cancel_task())
    fleet.run()
    assert [(entry.time_ns / S, *entry.values[:2]) for entry in fleet.trace if entry.kind == 'task_ended'] == [
        (6.0, 'urgent', 'PREEMPTED'), (12.0, 'long', 'SUCCEEDED')]
