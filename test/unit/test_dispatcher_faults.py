"""What is wrong with orders and policies, and runs that cannot go on: each is told, and ends nothing else."""
import numpy as np
import pytest

from dispatches import S, dispatch_of, order, told
from move_base_abstract.fleet.dispatch_world import Distances
from move_base_abstract.motion.geometry import Pose2D
from move_base_abstract.orders.dispatcher import PolicyError
from move_base_abstract.orders.order import Order, Stop
from move_base_abstract.orders.policies import POLICIES, Nearest


@pytest.mark.parametrize('wrong, text', [
    (order(''), 'id: got none'), (order('no stops'), 'stops: got 0; allowed: 1 to 100'),
    (Order('moon', 0, (Stop(Pose2D(), 'moon'),)), "stops[0]: place: got 'moon'; allowed: none"),
    (order('back', (0.0, 0.0), seconds=-1.0),
     'stops[0]: duration [ns]: got -1000000000; allowed: a finite number >= 0'),
    (order('past', (0.0, 0.0), deadline_ns=-S), 'deadline: got 1 s before its arrival'),
    (order('twice', (0.0, 0.0)), "id: 'twice' was given to an order before"),
    (Order('many', 0, 7), 'stops: got 7; allowed: a list of stops'),
    (order('when', (0.0, 0.0), deadline_ns='soon'), 'deadline'),
    (order('who', (0.0, 0.0), priority='high'), "priority: got 'high'; allowed: a whole number"),
    (Order('none', 0, (None,)), 'stops[0]: pose: got None'), (Order('flat', 0, (Stop((1.0, 2.0)),)), 'stops[0]: pose'),
    (Order('yes', 0, (Stop(Pose2D(), power=True),)), 'stops[0]: power: got True'),
    (Order('nan', 0, (Stop(Pose2D(), energy=float('nan')),)),
     'stops[0]: energy [J]: got nan; allowed: a finite number >= 0'),
    (Order('power', 0, (Stop(Pose2D(), power=10 ** 400),)),
     'stops[0]: power [W]: got a whole number of about 401 digits; allowed: a finite number >= 0'),
    (order('urgent', (0.0, 0.0), priority=2 ** 31), 'priority: got 2147483648; allowed: a whole number of 32 bits'),
    (Order('place', 0, (Stop(Pose2D(), ['a']),)), 'stops[0]: place: got'),
])
def test_a_wrong_order_is_refused_with_the_reason_and_moves_nobody(wrong, text):
    dispatch = dispatch_of()
    if wrong.order_id == 'twice':
        dispatch.order(wrong)
    dispatch.order(wrong)
    dispatch.run()
    refused = told(dispatch, 'order_refused')
    assert len(refused) == 1
    assert refused[0][1:4] == ('/dispatcher', 'order_refused', wrong.order_id)
    assert refused[0][4].startswith(text)
    assert len(told(dispatch, 'departed')) == (wrong.order_id == 'twice')


@pytest.mark.parametrize('choice, text', [
    ([('r_9', 'a')], "chose 'a' for 'r_9'; allowed: a robot of question.robots"),
    ([('r_0', 'z')], "chose 'z' for 'r_0'"), ([('r_0', 'a'), ('r_0', 'b')], "chose 'b' for 'r_0'"),
    ([('r_0', 'a'), ('r_1', 'a')], "chose 'a' for 'r_1'"), ([1], 'has failed: TypeError'), (None, 'has failed'),
    ([('a',)], 'has failed: ValueError')])
def test_what_a_policy_cannot_choose_is_an_error_that_says_so(choice, text):
    class Wrong:
        def choose(self, question):
            return choice
    dispatch = dispatch_of(policy=Wrong())
    dispatch.order(order('a', (0.0, 1.0)))
    dispatch.order(order('b', (0.0, 1.0)))
    with pytest.raises(PolicyError) as error:
        dispatch.run()
    assert text in str(error.value)
    assert dispatch.core.open_orders == ['a', 'b']
    assert told(dispatch, 'policy_failed')[0][1:] == ('/dispatcher', 'policy_failed', str(error.value))


def test_a_priority_of_another_kind_of_whole_number_is_one():
    dispatch = dispatch_of()
    dispatch.order(order('urgent', (0.0, 0.0), priority=np.int64(3)))
    dispatch.run()
    assert [row[3] for row in told(dispatch, 'order_done')] == ['urgent']


def test_an_order_that_is_put_right_is_no_longer_undone():
    dispatch = dispatch_of()
    for place, undone in (('nowhere', 'o refused'), ('', 'o with nobody')):
        dispatch.order(Order('o', 0, (Stop(Pose2D(0.0, 1.0), place),)))
        assert list(dispatch.core.undone()) == [undone]
    dispatch.run()
    assert (told(dispatch, 'order_done')[0][3], *dispatch.core.undone()) == ('o',)


class FailsWithBad(Nearest):
    def choose(self, question):
        if 'bad' in [one.order.order_id for one in question.orders]:
            raise KeyError('bad')
        return super().choose(question)


def check_that_bad_is_refused_and_the_others_are_done(dispatch, text):
    for name in ('a', 'bad', 'b', 'c'):
        dispatch.order(order(name, (7.0, 7.0) if name == 'bad' else (0.0, 1.0)))
    dispatch.run()
    (_, _, _, name, why), = told(dispatch, 'order_refused')
    assert (name, text in why) == ('bad', True)
    assert sorted(row[3] for row in told(dispatch, 'order_done')) == ['a', 'b', 'c']
    assert told(dispatch, 'policy_failed') == []
    assert list(dispatch.core.undone()) == ['bad refused']
    assert dispatch.fleet.warnings[-1][3] == 'Nothing is left to happen, but this is not done: bad refused'


def test_an_order_with_which_alone_a_policy_fails_is_refused_and_starves_no_other():
    check_that_bad_is_refused_and_the_others_are_done(dispatch_of(policy=FailsWithBad()), "has failed: KeyError: 'bad'")


@pytest.mark.parametrize('policy', POLICIES)
def test_an_order_to_which_no_distance_can_be_found_starves_no_other(policy, monkeypatch):
    asked = Distances.__call__

    def fails(self, robot, begin, end):
        if (7.0, 7.0) in (begin, end):
            raise OverflowError('too far')
        return asked(self, robot, begin, end)
    monkeypatch.setattr(Distances, '__call__', fails)
    check_that_bad_is_refused_and_the_others_are_done(dispatch_of(policy=policy), 'OverflowError: too far')


def test_a_policy_that_fails_ends_nothing_else():
    class FailsOnce:
        def __init__(self):
            self.asked = 0

        def choose(self, question):
            self.asked += 1
            if self.asked == 2:
                raise RuntimeError('thought too hard')
            return Nearest().choose(question)
    dispatch = dispatch_of(policy=FailsOnce())
    dispatch.order(order('a', (0.0, 5.0)))
    dispatch.fleet.at(2 * S, lambda fleet: dispatch.order(order('b', (10.0, 9.0))))
    with pytest.raises(PolicyError, match='thought too hard'):
        dispatch.run()
    assert [one[:4] for one in told(dispatch, 'policy_failed', 'order_done')] == [
        (2.0, '/dispatcher', 'policy_failed', told(dispatch, 'policy_failed')[0][3]), (5.0, 'r_0', 'order_done', 'a'),
        (14.0, 'r_1', 'order_done', 'b')]
    assert dispatch.run() == dispatch.fleet.now_ns  # what was wrong is said once


def test_a_run_that_cannot_go_on_says_which_orders_are_not_done_and_why():
    class InTurn:
        def choose(self, question):
            return [(question.robots[0].name, question.orders[0].order.order_id)]
    dispatch = dispatch_of(policy=InTurn(), zones=[
        {'name': name, 'rectangle': [x, -1.0, x + 6.0, 1.0], 'capacity': 1}
        for name, x in (('west', -1.0), ('east', 5.0))])
    for one in (order('a', (9.5, 0.0)), order('b', (0.5, 0.0)), order('c', (5.0, 5.0))):
        dispatch.order(one)
    dispatch.run(until=1.0)
    assert dispatch.fleet.warnings == []  # there is more to come
    dispatch.run()
    assert dispatch.fleet.warnings[-1] == (5 * S, '/dispatcher', '', (
        'Nothing is left to happen, but this is not done: a with r_0, held for zone east because of r_1 (waits, too); '
        'b with r_1, held for zone west because of r_0 (waits, too); c with nobody, no robot is free'))


LOW = {'battery_capacity': 1.0, 'battery_start': 0.4, 'charging_current': 10.0, 'friction_coefficient': 0.0}


def test_a_robot_that_cannot_reach_a_charger_is_sent_to_another_one_at_the_same_instant():
    zones = [{'name': name, 'rectangle': [-1.0, y - 1.0, 1.0, y + 1.0], 'charger': True}
             for name, y in (('shut', 20.0), ('open', -30.0))]
    dispatch = dispatch_of(robots=1, zones=zones, world_bounds=[-100.0, -100.0, 100.0, 10.0], **LOW,
                           dispatcher={'charge_below': 0.5})
    dispatch.run(until=100.0)
    assert told(dispatch, 'charge_assigned', 'charging_began') == [
        (0.0, 'r_0', 'charge_assigned', 'shut', 'low'), (0.0, 'r_0', 'charge_assigned', 'open', 'low'),
        (30.0, 'r_0', 'charging_began', 'open')]


def test_a_robot_at_home_in_a_charger_is_to_make_room_and_does_orders_all_the_same():
    zone = {'name': 'plug', 'rectangle': [-1.0, -1.0, 1.0, 1.0], 'charger': True, 'capacity': 1}
    dispatch = dispatch_of(zones=[zone], **LOW, dispatcher={'charge_below': 0.5})
    dispatch.run(until=200.0)
    dispatch.order(order('one', (20.0, 0.0)))
    dispatch.run(until=300.0)
    assert told(dispatch, 'order_assigned', 'charge_assigned') == [
        (200.0, 'r_0', 'order_assigned', 'one', 1), (200.0, 'r_1', 'charge_assigned', 'plug', 'low')]
