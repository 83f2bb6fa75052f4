"""The fleet in plain Python: whole traces, order of equal times, reset, add, remove."""
import gc
import math
import random
import sys
from collections import Counter

import pytest

from move_base_abstract.common.errors import ConfigurationError, TimeError
from move_base_abstract.fleet import Fleet, TraceEntry
from move_base_abstract.goals.outcome import GoalState
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.scenario import make_scenario
from move_base_abstract.tasks.arrivals import Task

S = 1_000_000_000
REACHED = ('SUCCEEDED', 'Goal reached.')


def make_fleet(count=1, **keywords):
    """Return a fleet of r_0, r_1... at 2 m/s, all at the origin."""
    return Fleet(make_scenario({'defaults': {'max_speed': 2.0}, 'robots': [{'name': 'r', 'count': count}]}), **keywords)


def endings(fleet):
    """Return (time, robot, goal, state) of the goals that have ended."""
    return [(entry.time_ns, entry.robot, *entry.values[:2]) for entry in fleet.trace if entry.kind == 'ended']


def test_one_goal_leaves_the_trace_of_a_departure_an_arrival_and_an_ending():
    fleet = make_fleet()
    goal_id = fleet.robot('r_0').send(10.0, 0.0)
    assert fleet.run() == 6 * S
    assert fleet.trace == [TraceEntry(S, 'r_0', 'goal', (goal_id,)),
                           TraceEntry(S, 'r_0', 'departed', (10.0, 0.0, 0.0)),
                           TraceEntry(6 * S, 'r_0', 'stands', (10.0, 0.0, 0.0)),
                           TraceEntry(6 * S, 'r_0', 'ended', (goal_id, *REACHED))]
    assert fleet.robot('r_0').distance == 10.0


def test_robots_that_arrive_at_one_instant_end_in_the_order_of_their_indices():
    fleet = make_fleet(12)
    for name in reversed(fleet.names):
        fleet.robot(name).send(4.0, 0.0)
    fleet.run()
    assert [robot for _, robot, *_ in endings(fleet)] == ['r_{}'.format(number) for number in range(12)]


def test_old_methods_of_a_fleet_work_and_say_the_new_ones():
    fleet = make_fleet()
    with pytest.warns(FutureWarning, match=r'^Fleet.send\(name\) is Fleet.robot\(name\).send now; the old name goes'):
        assert fleet.send('r_0', 4.0, 0.0) == 'r_0-1'
    fleet.run()
    with pytest.warns(FutureWarning, match=r'Fleet.robot\(name\).pose now'):
        assert fleet.pose('r_0') == Pose2D(4.0, 0.0)
    with pytest.raises(AttributeError, match='sent'):
        fleet.sent('r_0', 4.0, 0.0)


def test_a_class_of_a_users_own_may_extend_an_old_method_of_a_fleet():
    class Counting(Fleet):
        sent = 0

        def send(self, name, *goal):
            self.sent += 1
            return super().send(name, *goal)
    fleet = Counting(make_scenario({'robots': [{'name': 'bot'}]}))
    with pytest.warns(FutureWarning, match=r'Fleet.robot\(name\).send now'):
        assert (fleet.send('bot', 4.0, 0.0), fleet.sent) == ('bot-1', 1)
    with pytest.warns(FutureWarning, match=r'Fleet.robot\(name\).cancel now'):
        Fleet.cancel(fleet, 'bot')


def test_a_removed_robot_does_nothing_more():
    fleet = make_fleet()
    robot = fleet.robot('r_0')
    fleet.remove('r_0')
    for use in (lambda: robot.send(1.0, 0.0), robot.cancel, lambda: robot.pose, lambda: robot.hold('x'),
                lambda: robot.set_priority(1), lambda: robot.activity, lambda: robot.state_of_charge,
                # It has no battery, never fails, and there are no places.
                lambda: robot.set_charge(0.5), lambda: robot.set_tool(True), robot.fail, robot.repair,
                lambda: robot.send_task(Task('t', 0, '', Pose2D(), 1)), robot.cancel_task):
        with pytest.raises(ConfigurationError, match="robot 'r_0' was removed from its fleet"):
            use()
    assert repr(robot) == '<robot r_0, which was removed from its fleet>'


def test_running_until_a_time_stops_there_with_exact_poses():
    fleet = make_fleet()
    fleet.robot('r_0').send(10.0, 0.0)
    assert fleet.run(3 * S) == 3 * S
    assert fleet.robot('r_0').pose == Pose2D(4.0, 0.0)
    assert fleet.run_for(0.5) == 3_500_000_000
    assert fleet.robot('r_0').pose == Pose2D(5.0, 0.0)


def test_a_goal_sent_when_another_ends_starts_at_that_instant():
    def on_end(name, _goal_id, state, _text, now_ns):
        seen.append((now_ns, state))
        if len(seen) < 3:
            fleet.robot(name).send(2.0 * len(seen) % 4.0, 0.0)

    seen = []
    fleet = make_fleet(on_end=on_end)
    fleet.robot('r_0').send(4.0, 0.0)
    fleet.run()
    assert seen == [(3 * S, GoalState.SUCCEEDED), (4 * S, GoalState.SUCCEEDED), (5 * S, GoalState.SUCCEEDED)]


def test_what_a_user_schedules_comes_after_the_robots_events_of_that_instant():
    fleet = make_fleet()
    fleet.robot('r_0').send(4.0, 0.0)
    poses = []
    fleet.at(3 * S, lambda there: poses.append((there.now_ns, len(endings(there)))))
    fleet.run()
    assert poses == [(3 * S, 1)]
    with pytest.raises(TimeError):
        fleet.at(S, lambda there: None)


@pytest.mark.parametrize('go_on', [
    lambda fleet, time_ns: fleet.run(time_ns), lambda fleet, time_ns: fleet.at(time_ns, print),
    lambda _fleet, time_ns: make_fleet(start_ns=time_ns)])
def test_simulated_time_has_an_end(go_on):
    fleet = make_fleet()
    with pytest.raises(TimeError, match='simulated time ends at 2147483647 s'):
        go_on(fleet, 10 ** 30)
    assert fleet.now_ns == S


def test_cancel_and_replacement_end_each_goal_once():
    fleet = make_fleet()
    fleet.robot('r_0').send(100.0, 0.0, goal_id='a')
    fleet.at(2 * S, lambda there: there.robot('r_0').send(0.0, 50.0, goal_id='b'))
    fleet.at(4 * S, lambda there: there.robot('r_0').cancel())
    fleet.run()
    assert endings(fleet) == [(2 * S, 'r_0', 'a', 'PREEMPTED'), (4 * S, 'r_0', 'b', 'PREEMPTED')]


def test_reset_brings_home_and_keeps_the_time():
    fleet = make_fleet(2)
    fleet.robot('r_1').send(100.0, 0.0, goal_id='a')
    fleet.run(5 * S)
    fleet.reset()
    assert (fleet.now_ns, fleet.robot('r_1').pose, fleet.robot('r_1').distance) == (5 * S, Pose2D(), 0.0)
    assert endings(fleet) == [(5 * S, 'r_1', 'a', 'ABORTED')]
    assert fleet.run() == 5 * S


def test_robots_come_and_go():
    fleet = make_fleet()
    fleet.add('late', max_speed=4.0, start_x=1.0)
    fleet.robot('late').send(5.0, 0.0, goal_id='a')
    fleet.run(1_500_000_000)
    fleet.remove('late')
    assert endings(fleet) == [(1_500_000_000, 'late', 'a', 'ABORTED')]
    assert fleet.names == ['r_0']
    with pytest.raises(ConfigurationError, match="robot 'late' is unknown; there are: r_0"):
        fleet.robot('late')
    with pytest.raises(ConfigurationError, match="robot 'r_0' is there already"):
        fleet.add('r_0')


def test_a_goal_out_of_bounds_or_in_a_foreign_frame_is_refused():
    fleet = Fleet(make_scenario({'robots': [{'name': 'r', 'world_bounds': [0, 0, 9, 9]}]}))
    fleet.robot('r').send(10.0, 0.0, goal_id='out')
    fleet.robot('r').send(1.0, 0.0, goal_id='far', frame='moon')
    assert [values[:2] for _, _, *values in endings(fleet)] == [['out', 'ABORTED'], ['far', 'ABORTED']]
    assert 'without ROS' in fleet.trace[-1].values[2]


def test_one_robot_more_changes_nothing_for_the_others():
    def trace_of_r_0(count):
        fleet = make_fleet(count, on_end=lambda name, *_: send(name))
        chance = {name: random.Random(name) for name in fleet.names}

        def send(name):
            fleet.robot(name).send(chance[name].uniform(0, 50), chance[name].uniform(0, 50))

        for name in fleet.names:
            send(name)
        fleet.run(500 * S)
        return [entry for entry in fleet.trace if entry.robot == 'r_0']

    alone = trace_of_r_0(1)
    assert len(alone) > 20
    assert trace_of_r_0(7) == alone


def calls_for_each_goal(robots, goals):
    """Return how many calls of Python functions a goal takes, from a robot's last goal to its next."""
    def on_end(name, *_ended):
        if next(left) > 0:
            fleet.robot(name).send(chance.uniform(0.0, 50.0), chance.uniform(0.0, 50.0))

    fleet, chance, left = make_fleet(robots, on_end=on_end), random.Random(1), iter(range(goals, -robots, -1))
    for name in fleet.names:
        fleet.robot(name).send(10.0, 0.0)
    calls = Counter()
    sys.setprofile(lambda _frame, event, _argument: calls.update([event]))
    try:
        fleet.run()
    finally:
        sys.setprofile(None)
    return calls['call'] / (goals + robots)


def test_a_goal_takes_few_calls_whatever_the_number_of_robots():
    few, many = calls_for_each_goal(1, 200), calls_for_each_goal(100, 2000)
    assert few < 65 and many < few + 1


def test_the_trace_is_one_list_whenever_it_is_read():
    fleet = make_fleet(trace=[TraceEntry(0, 'r_0', 'stands', (0.0, 0.0, 0.0))])
    trace = fleet.trace
    fleet.robot('r_0').send(10.0, 0.0)
    assert [entry.kind for entry in fleet.trace] == ['stands', 'goal', 'departed']
    fleet.run()
    assert fleet.trace is trace and [entry.kind for entry in trace][2:] == ['departed', 'stands', 'ended']
    assert all(type(entry) is TraceEntry for entry in trace)


def test_without_a_trace_nothing_is_kept():
    fleet = make_fleet(trace=None)
    fleet.robot('r_0').send(10.0, 0.0)
    fleet.run()
    assert fleet.trace is None


def test_more_goals_leave_no_more_objects_for_the_garbage_collector_to_visit():
    left = [200]

    def send_next(name, *_ended):
        if left[0]:
            left[0] -= 1
            fleet.robot(name).send(float(left[0] % 7), 1.0)

    fleet = make_fleet(3, on_end=send_next)
    for name in fleet.names:
        send_next(name)
    gc.collect()
    gc.disable()  # so that the collector only counts: what was made less what has gone
    try:
        fleet.run()
        count = gc.get_count()[0]
    finally:
        gc.enable()
    assert count < 200
    assert Counter(entry.kind for entry in fleet.trace) == {
        'goal': 200, 'departed': 200, 'stands': 200, 'ended': 200}


def test_each_goal_has_a_row_before_all_that_follows_from_it_whatever_becomes_of_it():
    fleet = Fleet(make_scenario({'robots': [
        {'name': 'a', 'max_speed': 2.0},
        {'name': 'b', 'failure_kind': 'silent', 'failure_times': [4.0], 'repair_time': 10.0}]}), 0)
    robot, silent, ledger = fleet.robot('a'), fleet.robot('b'), fleet.robot('a').navigator._ledger
    robot.send(10.0, 0.0, goal_id='first')
    robot.send(4.0, 0.0, goal_id='second')  # replaces it
    robot.send(4.0, 0.0, goal_id='second')  # is known already
    robot.send(math.nan, 0.0, goal_id='nowhere')
    robot.cancel('early')
    robot.send(1.0, 0.0, goal_id='early')
    robot.hold('door')
    robot.send(2.0, 0.0, goal_id='held')
    ledger.cancel('', 5, 0)
    fleet.run(5)
    robot.navigator.receive('late', 3, None, 5)
    silent.send(50.0, 0.0, goal_id='under way')
    fleet.run(6 * S)
    silent.send(1.0, 0.0, goal_id='queued')
    fleet.run()
    rows = [(name, kind, values[0]) for _, name, kind, values in fleet.trace if kind in ('goal', 'departed', 'ended')]
    told = [(kind, value) for name, kind, value in rows if name == 'a']
    assert told[:4] == [('goal', 'first'), ('departed', 10.0), ('goal', 'second'), ('ended', 'first')]
    assert [value for kind, value in told if kind == 'goal'] == ['first', 'second', 'nowhere', 'early', 'held', 'late']
    for _, goal in [one for one in told if one[0] == 'ended']:
        assert told.index(('goal', goal)) < told.index(('ended', goal))
    assert [(values[0], time_ns // S) for time_ns, name, kind, values in fleet.trace
            if (name, kind) == ('b', 'goal')] == [('under way', 0), ('queued', 14)]
