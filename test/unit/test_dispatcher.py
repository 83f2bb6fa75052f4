"""A dispatcher in plain Python: who gets what, batteries, what fails; nothing is lost. Policies against brute force."""
import itertools
import os
import random
import subprocess
import sys
from collections import Counter

import pytest
from night import times

from dispatches import S, dispatch_of, order, told
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.fleet import Dispatch
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.orders.order import Order, Stop
from move_base_abstract.orders.policies import (
    POLICIES,
    Auction,
    Batch,
    EarliestDeadline,
    FreeRobot,
    Nearest,
    OpenOrder,
    Question,
    make_policy,
)
from move_base_abstract.scenario import make_scenario


def test_an_order_goes_stop_by_stop_and_leaves_its_rows():
    dispatch = dispatch_of(places=[{'name': 'dock', 'x': 4.0, 'capacity': 1}])
    stops = (Stop(Pose2D(1.0, 0.0), action='load', duration_ns=2 * S), Stop(Pose2D(4.0), 'dock', 'unload'))
    dispatch.order(Order('one', 0, stops, deadline_ns=5 * S, priority=3))
    dispatch.run()
    assert told(dispatch) == [
        (0.0, '/dispatcher', 'order_arrived', 'one', 3, 5 * S, '', 1.0, 0.0, 'load', 'dock', 4.0, 0.0, 'unload'),
        (0.0, 'r_0', 'order_assigned', 'one', 1), (0.0, 'r_0', 'order_stop', 'one', 1, 'drives'),
        (1.0, 'r_0', 'order_stop', 'one', 1, 'works'), (3.0, 'r_0', 'order_stop', 'one', 1, 'done'),
        (3.0, 'r_0', 'order_stop', 'one', 2, 'drives'), (6.0, 'r_0', 'order_stop', 'one', 2, 'done'),
        (6.0, 'r_0', 'order_done', 'one', 'late', 6 * S, 1 * S)]


def test_orders_of_one_instant_are_given_away_together_by_priority_then_arrival():
    dispatch = dispatch_of(robots=1)
    for name, priority in (('low', 0), ('high', 1), ('low_2', 0)):
        dispatch.order(order(name, (1.0, 0.0), priority=priority))
    dispatch.run()
    assert [row[3] for row in told(dispatch, 'order_assigned')] == ['high', 'low', 'low_2']


def test_the_earliest_deadline_comes_first_and_none_comes_last():
    dispatch = dispatch_of(robots=1, policy='earliest_deadline')
    for name, deadline in (('never', None), ('late', 90), ('soon', 30)):
        dispatch.order(order(name, (1.0, 0.0), deadline_ns=deadline and deadline * S))
    dispatch.run()
    assert [row[3] for row in told(dispatch, 'order_assigned')] == ['soon', 'late', 'never']


@pytest.mark.parametrize('after, stop', [('restart', 1), ('resume', 2)])
@pytest.mark.parametrize('kind', ['abort', 'stall', 'silent'])
def test_what_a_failed_robot_carries_is_fetched_anew_or_taken_over(after, stop, kind):
    dispatch = dispatch_of(dispatcher={'after_failure': after}, failure_kind=kind, repair_time=1000.0)
    stops = (Stop(Pose2D(2.0, 0.0), action='load'), Stop(Pose2D(2.0, 8.0), action='unload'))
    dispatch.order(Order('one', 0, stops))
    dispatch.fleet.at(5 * S, lambda fleet: fleet.robot('r_0').fail())
    dispatch.run(until=900.0)
    rows = told(dispatch, 'order_returned', 'order_assigned', 'order_done')
    assert rows[1][:6] == (5.0, 'r_0', 'order_returned', 'one', 'robot failed', stop)
    assert rows[2] == (5.0, 'r_1', 'order_assigned', 'one', 2)
    assert rows[3][1:5] == ('r_1', 'order_done', 'one', 'done')


def test_what_nobody_can_reach_is_given_up_after_so_many_attempts_and_time_goes_on():
    dispatch = dispatch_of(dispatcher={'attempts': 4, 'distances': 'straight'}, world_bounds=[-5.0, -5.0, 50.0, 5.0])
    dispatch.order(order('far', (0.0, 90.0)))
    dispatch.order(order('near', (1.0, 0.0)))
    dispatch.run()
    assert Counter(row[2:4] for row in told(dispatch)) == {
        ('order_arrived', 'far'): 1, ('order_assigned', 'far'): 4, ('order_stop', 'far'): 4,
        ('order_returned', 'far'): 4, ('order_done', 'far'): 1, ('order_arrived', 'near'): 1,
        ('order_assigned', 'near'): 1, ('order_stop', 'near'): 2, ('order_done', 'near'): 1}
    assert [row[4] for row in told(dispatch, 'order_done')] == ['failed', 'done']


def test_an_empty_battery_gives_the_order_back_and_a_charged_one_goes_on():
    dispatch = dispatch_of(battery_capacity=0.05, each={1: {'battery_start': 0.0}})
    dispatch.order(order('one', (0.0, 60.0)))
    dispatch.fleet.at(200 * S, lambda fleet: fleet.robot('r_1').set_charge(1.0))
    dispatch.run(until=400.0)
    rows = told(dispatch, 'order_returned', 'order_assigned')
    assert [(row[1], row[2]) for row in rows[:3]] == [
        ('r_0', 'order_assigned'), ('r_0', 'order_returned'), ('r_1', 'order_assigned')]
    assert rows[1][4] == 'battery empty'
    assert rows[2][0] == 200.0


def test_a_robot_that_somebody_else_sends_gives_its_order_back_and_is_free_when_that_is_over():
    dispatch = dispatch_of(robots=1)
    dispatch.order(order('one', (5.0, 0.0)))
    dispatch.fleet.at(2 * S, lambda fleet: fleet.robot('r_0').send(2.0, 4.0))
    dispatch.run()
    assert [row[:3] for row in told(dispatch, 'order_returned', 'order_assigned', 'order_done')] == [
        (0.0, 'r_0', 'order_assigned'), (2.0, 'r_0', 'order_returned'), (6.0, 'r_0', 'order_assigned'),
        (11.0, 'r_0', 'order_done')]


DOCK = {'name': 'dock', 'rectangle': [-3.0, -3.0, -1.0, -1.0], 'charger': True, 'capacity': 1}


def charging(robots=1, **settings):
    given = {'charge_below': 0.5, 'charge_until': 0.8, **settings}
    return dispatch_of({'name': 'o', 'every': 30.0, 'count': 30, 'stops': [{'x': 5.0, 'y': 5.0}, {'x': 0.0, 'y': 5.0}]},
                       robots=robots, zones=[DOCK], dispatcher=given, battery_capacity=0.4, charging_current=2.0)


def test_who_is_below_the_threshold_charges_to_the_other_one_and_does_no_order_meanwhile():
    dispatch = charging()
    dispatch.run()
    assert [row[4] for row in told(dispatch, 'order_done')] == ['done'] * 30
    rows = told(dispatch, 'battery', 'charge_assigned', 'charging_began', 'charge_over', 'order_assigned')
    began = [at for at, row in enumerate(rows) if row[2] == 'charge_assigned']
    assert len(began) >= 2
    for at in began:
        after = [row[2:] for row in rows[at:]]
        assert after[0] == ('charge_assigned', 'dock', 'low')
        kinds = [row[0] for row in after]
        assert 'order_assigned' not in kinds[:after.index(('battery', 0.8, 'above'))]
    assert dispatch.fleet.robot('r_0').state_of_charge > 0.4


def test_who_finds_the_charger_taken_waits_and_who_came_first_is_first():
    dispatch = charging(robots=3)
    dispatch.run()
    assert Counter(row[4] for row in told(dispatch, 'order_done')) == {'done': 30}
    at_dock = 0
    for row in told(dispatch, 'charging_began', 'charging_ended'):
        at_dock += 1 if row[2] == 'charging_began' else -1
        assert at_dock <= 1
    assert told(dispatch, 'charge_awaited')
    waiting = []
    for row in told(dispatch, 'charge_awaited', 'charge_assigned'):
        if row[2] == 'charge_awaited':
            waiting.append(row[1])
        elif row[1] in waiting:
            assert waiting.pop(0) == row[1]


def test_idle_robots_charge_where_that_is_asked_for_and_are_called_away():
    dispatch = charging(charge_when_idle=0.95)
    dispatch.run()
    assert ('dock', 'idle') in {row[3:] for row in told(dispatch, 'charge_assigned')}
    assert Counter(row[4] for row in told(dispatch, 'order_done')) == {'done': 30}
    assert not told(charging(), 'charge_assigned')


def test_a_charged_robot_makes_room_for_one_that_waits():
    dispatch = dispatch_of(robots=2, zones=[DOCK], battery_capacity=0.4, charging_current=2.0,
                           dispatcher={'charge_below': 0.5, 'charge_until': 0.8},
                           each={0: {'battery_start': 0.3}, 1: {'battery_start': 0.49}})
    dispatch.run(until=600.0)
    assert [(row[1], row[2]) for row in told(dispatch)] == [
        ('r_0', 'charge_assigned'), ('r_1', 'charge_awaited'), ('r_0', 'charge_over'), ('r_1', 'charge_assigned')]
    assert dispatch.fleet.robot('r_0').pose == Pose2D(0.0, 0.0)


def test_time_goes_on_for_a_charge_that_an_order_waits_for():
    dispatch = dispatch_of(robots=1, zones=[DOCK], battery_capacity=0.4, each={0: {'battery_start': 0.2}})
    dispatch.fleet.at(S, lambda _: dispatch.order(order('one', (5.0, 0.0))))
    dispatch.run()
    assert [row[4] for row in told(dispatch, 'order_done')] == ['done']


def test_whose_battery_gets_empty_at_the_edge_of_a_charger_charges_there():
    dispatch = dispatch_of(robots=1, zones=[DOCK], battery_capacity=0.05, charging_current=2.0,
                           each={0: {'battery_start': 0.15}})
    dispatch.fleet.at(S, lambda _: dispatch.order(order('one', (1.0, 0.0))))
    dispatch.run(until=400.0)
    assert told(dispatch, 'battery')[0][3:] == (0.0, 'empty')
    assert len(told(dispatch, 'battery')) < 20  # it does not set out again with a nanosecond's charge
    assert [row[4] for row in told(dispatch, 'order_done')] == ['done']


def test_thresholds_that_robots_do_not_tell_of_are_an_error():
    scenario = make_scenario({'robots': [{'name': 'a', 'battery_capacity': 1.0}], 'zones': [DOCK]})
    with pytest.raises(ConfigurationError, match="robot 'a' does not report when its charge passes 0.9, 0.3"):
        Dispatch(scenario)


# --- policies --------------------------------------------------------------------------------------------------------

def question_of(seed, robots=4, orders=6, busy=0, priorities=1):
    dice = random.Random(seed)

    def distance(_robot, begin, end):
        return round(1000.0 * (abs(begin[0] - end[0]) + abs(begin[1] - end[1])))

    def point():
        return float(dice.randrange(8)), float(dice.randrange(8))
    given = [OpenOrder(order('o_{}'.format(k), point(), point(), priority=dice.randrange(priorities)), 0,
                       dice.choice([None, dice.randrange(100)]), 0, 0) for k in range(orders)]
    given.sort(key=lambda one: -one.order.priority)
    free = [FreeRobot('r_{}'.format(k), *point()) for k in range(robots + busy)]
    return Question(given, free[:robots], free[robots:], 0, distance)


def test_a_policy_knows_how_much_each_robot_has_done():
    class Watching:
        def choose(self, question):
            seen.append((question.now_ns // S, [one[3:] for one in (*question.robots, *question.busy)]))
            return [(question.robots[0].name, question.orders[0].order.order_id)]

    seen = []
    dispatch = dispatch_of(policy=Watching())
    dispatch.order(order('a', (1.0, 0.0), (3.0, 0.0)))
    dispatch.order(order('b', (12.0, 0.0)))
    dispatch.fleet.at(2 * S, lambda fleet: fleet.robot('r_1').send(0.0, 0.0))
    dispatch.fleet.at(20 * S, lambda _: dispatch.order(order('c', (0.0, 0.0))))
    dispatch.run()
    none = 0, 0, 0
    assert seen[:2] == [(0, [none, none]), (0, [none, (1, 0, 0)])]
    assert seen[-1] == (20, [(2, 2, 12 * S), (1, 0, 2 * S)])


@pytest.mark.parametrize('seed', range(30))
def test_a_batch_has_the_least_sum_of_all(seed):
    pytest.importorskip('scipy')
    question = question_of(seed, robots=4, orders=3 + seed % 3)
    robots, orders = {one.name: one for one in question.robots}, {one.order.order_id: one for one in question.orders}
    pairs = Batch().choose(question)
    assert len(pairs) == min(len(robots), len(orders)) == len(dict(pairs)) == len({key for _, key in pairs})
    few, many = sorted((question.robots, question.orders), key=len)
    best = min(sum(question.away(*((one, other) if few is question.robots else (other, one)))
                   for one, other in zip(few, chosen)) for chosen in itertools.permutations(many, len(few)))
    assert sum(question.away(robots[name], orders[key]) for name, key in pairs) == best


@pytest.mark.parametrize('seed', range(20))
def test_each_order_in_turn_gets_the_nearest_robot_that_is_left_the_lower_index_of_equally_near_ones(seed):
    question = question_of(seed, priorities=3)
    for policy, key in ((Nearest(), lambda one: 0),
                        (EarliestDeadline(), lambda one: 1000 if one.deadline_ns is None else one.deadline_ns)):
        left, wanted = list(question.robots), []
        for one in sorted(question.orders, key=lambda one: (-one.order.priority, key(one))):
            if left:
                nearest = sorted(left, key=lambda robot: (question.away(robot, one), left.index(robot)))[0]
                left.remove(nearest)
                wanted.append((nearest.name, one.order.order_id))
        assert policy.choose(question) == wanted


@pytest.mark.parametrize('seed', range(20))
def test_in_an_auction_each_order_goes_where_the_whole_tour_is_the_shortest(seed):
    question = question_of(seed, robots=2, busy=2, orders=5)
    bidders = [*question.robots, *question.busy]
    tours = {robot.name: [] for robot in bidders}

    def length(robot, tour):
        points = [(robot.x, robot.y), *(point for one in tour for point in one.points)]
        return sum(question.distance('', *pair) for pair in zip(points, points[1:]))
    for one in question.orders:
        bids = [(length(robot, [*tours[robot.name][:at], one, *tours[robot.name][at:]]), index, at)
                for index, robot in enumerate(bidders) for at in range(len(tours[robot.name]) + 1)]
        _, index, at = min(bids)
        tours[bidders[index].name].insert(at, one)
    wanted = [(robot.name, tours[robot.name][0].order.order_id) for robot in question.robots if tours[robot.name]]
    assert Auction().choose(question) == wanted


def test_a_bid_in_an_auction_looks_up_only_the_ways_to_and_from_the_new_order():
    asked, robots, orders = [], 4, 60
    rng = random.Random(1)
    question = question_of(1, robots=robots)
    many = [OpenOrder(order(str(k), (rng.uniform(0.0, 50.0), rng.uniform(0.0, 50.0))), k, None, 0, 0)
            for k in range(orders)]
    away = question.distance
    Auction().choose(question._replace(orders=many, distance=lambda *of: asked.append(of) or away(*of)))
    assert len(asked) < 3 * sum(sold + robots for sold in range(orders))


def test_nobody_is_chosen_where_no_way_leads():
    question = question_of(1)._replace(distance=lambda robot, begin, end: None if robot == 'r_0' else 5)
    for policy in (Nearest(), EarliestDeadline(), Batch(), Auction()):
        pairs = dict(policy.choose(question))
        assert 'r_0' not in pairs
        assert pairs
    nowhere = question._replace(distance=lambda robot, begin, end: None)
    for policy in (Nearest(), EarliestDeadline(), Batch(), Auction()):
        assert policy.choose(nowhere) == []


class OwnPolicy:
    """Gives the last order to the last robot."""

    def choose(self, question):
        yield question.robots[-1].name, question.orders[-1].order.order_id


def test_a_users_own_policy_is_taken_by_name_or_as_an_object():
    for policy in ('{}:OwnPolicy'.format(__name__), OwnPolicy()):
        dispatch = dispatch_of(policy=policy)
        dispatch.order(order('a', (0.0, 1.0)))
        dispatch.order(order('b', (0.0, 1.0)))
        dispatch.run()
        assert told(dispatch, 'order_assigned')[0][1:4] == ('r_1', 'order_assigned', 'b')
        assert len(told(dispatch, 'order_done')) == 2


@pytest.mark.parametrize('name, text', [
    ('no_such_module:Policy', 'ModuleNotFoundError'), ('math:Policy', 'AttributeError'),
    ('collections:OrderedDict', 'has no method choose')])
def test_a_policy_that_cannot_be_made_is_an_error(name, text):
    with pytest.raises(ConfigurationError, match=text):
        make_policy(name, 'dispatcher')


# --- nothing is lost -------------------------------------------------------------------------------------------------

def hard_world(seed, policy):
    """Return a scenario in which robots fail, run empty, wait and give way."""
    dice = random.Random(seed)
    return {
        'seed': seed, 'robots': [{'name': 'r', 'count': 4, 'step_x': 2.0}],
        'defaults': {'max_speed': 1.0, 'battery_capacity': 0.3, 'charging_current': 2.0, 'repair_time': 40.0,
                     'failure_kind': dice.choice(['abort', 'stall', 'silent', 'stuck']), 'failures_per_km': 4.0},
        'zones': [DOCK, {'name': 'gate', 'rectangle': [3.0, 3.0, 5.0, 5.0], 'capacity': 1}], 'deadlock': 'avoid',
        'places': [{'name': 'a', 'x': 8.0, 'duration': 4.0, 'capacity': 1, 'queue': 1},
                   {'name': 'b', 'y': 8.0, 'duration': 6.0, 'capacity': 1, 'preemption': True}],
        'dispatcher': {'policy': policy, 'charge_below': 0.5, 'charge_until': 0.9,
                       'charge_when_idle': dice.choice([0.0, 0.95]),
                       'after_failure': dice.choice(['restart', 'resume'])},
        'orders': [{'name': 'o', 'rate': 0.05, 'count': 40, 'deadline': 90.0, 'stops': [
                       {'places': ['a', 'b'], 'action': 'load'}, {'area': [0.0, 0.0, 8.0, 8.0], 'action': 'unload'}]},
                   {'name': 'p', 'every': 40.0, 'count': 10, 'priority': 1, 'stops': [{'place': 'b'}]}]}


@pytest.mark.parametrize('policy', POLICIES)
@pytest.mark.parametrize('seed', range(times(2, 6)))
def test_nothing_is_lost_whatever_fails_and_a_run_repeats(seed, policy):
    raw = hard_world(seed, policy)

    def trace():
        dispatch = Dispatch(make_scenario(raw), start_ns=0)
        dispatch.run()
        return dispatch, dispatch.fleet.trace
    dispatch, first = trace()
    assert first == trace()[1]
    state, doing = {}, {}
    for entry in first:
        if entry.kind == 'order_arrived':
            assert entry.values[0] not in state
            state[entry.values[0]] = 'open'
        elif entry.kind == 'order_assigned':
            assert state[entry.values[0]] == 'open'
            assert entry.robot not in doing
            state[entry.values[0]], doing[entry.robot] = 'done by ' + entry.robot, entry.values[0]
        elif entry.kind == 'order_returned':
            assert doing.pop(entry.robot) == entry.values[0]
            state[entry.values[0]] = 'open'
        elif entry.kind == 'order_done':
            assert state[entry.values[0]] != 'over'
            doing.pop(entry.robot, None)
            state[entry.values[0]] = 'over'
    assert len(state) == 50
    left = [name for name, what in state.items() if what == 'open']
    assert sorted(left) == sorted(dispatch.core.open_orders)
    assert set(doing.values()) == {name for name, what in state.items() if what.startswith('done by')}
    usable = [robot for robot in dispatch.core.robots if not robot.is_out_of_order and not robot.must_charge]
    assert not left or not [robot for robot in usable if robot.name not in doing]  # else somebody could do them
    for name in doing:  # it stands where somebody with an empty battery is in its way
        assert dispatch.fleet.robot(name).activity.startswith('held: zone')


PROGRAM = """
import sys
from move_base_abstract.orders.policies import make_policy
try:
    print(type(make_policy(sys.argv[1], 'dispatcher')).__module__)
except Exception as error:
    print(error)
"""


@pytest.mark.parametrize('where, is_taken', [('work', False), ('program', False), ('other', True), ('work:path', True)])
def test_a_policy_comes_from_installed_packages_and_pythonpath_only(where, is_taken, tmp_path):
    for name in ('work', 'program', 'other'):
        (tmp_path / name).mkdir()
    (tmp_path / 'program' / 'run.py').write_text(PROGRAM)
    (tmp_path / where.partition(':')[0] / 'beside.py').write_text(
        'print("it ran")\nclass Mine:\n    def choose(self, question):\n        return []\n')
    named = [str(tmp_path / 'other'), *([str(tmp_path / 'work')] if ':' in where else []), '']  # '': no working folder
    done = subprocess.run([sys.executable, str(tmp_path / 'program' / 'run.py'), 'beside:Mine'], env={
        **os.environ, 'PYTHONPATH': os.pathsep.join([*named, os.environ.get('PYTHONPATH', ''), *sys.path[1:]])},
        cwd=tmp_path / 'work', stdout=subprocess.PIPE, text=True, check=True)
    if is_taken:
        assert done.stdout == 'it ran\nbeside\n'
    else:
        assert done.stdout == (
            "dispatcher: policy: beside:Mine cannot be made: ModuleNotFoundError: No module named 'beside'; modules "
            'are looked for in installed packages and PYTHONPATH\n')
