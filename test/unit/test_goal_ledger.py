"""What becomes of goals and cancel requests: each row of move_base's contract that concerns states and texts."""

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.common.units import NS_PER_S
from move_base_abstract.goals.client import NoClient
from move_base_abstract.goals.events import Ended, robot_stream
from move_base_abstract.goals.ledger import GoalLedger
from move_base_abstract.goals.outcome import CANCELLED, NODE_KILLED, REACHED, GoalState, aborted

S = NS_PER_S
ACCEPTED = 'This goal has been accepted by the simple action server'
ANOTHER = 'This goal was canceled because another goal was received by the simple action server'
BEFORE_CANCEL = ('This goal handle was canceled by the action server because its timestamp is before the timestamp of '
                 'the last cancel request')


class Desk:
    """A ledger and a trace of all that it publishes: ('result', id, state, text, stamp) and ('status', {id: state})."""

    def __init__(self):
        self.now_ns = 0
        self.trace = []
        stream = robot_stream()
        stream.subscribe('trace', {Ended: self._result})
        self.ledger = GoalLedger('bot', stream, self)

    def publish_status(self):
        self.trace.append(('status', self.listed()))

    def new_id(self, now_ns):
        return 'made-up-{}'.format(now_ns)

    def _result(self, event):
        self.trace.append(('result', event.goal_id, event.state.name, event.text, event.time_ns))

    def listed(self, now_ns=None):
        records = self.ledger.records(self.now_ns if now_ns is None else now_ns)
        return {record.goal_id: record.state.name for record in records}

    def texts(self):
        return {record.goal_id: record.text for record in self.ledger.records(self.now_ns)}

    def receive(self, goal_id, stamp_ns=0, at=None):
        """Hand a goal in and return what is published about it."""
        self.now_ns = self.now_ns if at is None else at
        self.record = self.ledger.receive(goal_id, stamp_ns, self.now_ns)
        return self.told()

    def cancel(self, goal_id='', stamp_ns=0, at=None):
        """Hand a cancel in, end the active goal if it is meant, as the navigator does; return what is published."""
        self.now_ns = self.now_ns if at is None else at
        if self.ledger.cancel(goal_id, stamp_ns, self.now_ns):
            self.ledger.finish(CANCELLED, self.now_ns)
        return self.told()

    def finish(self, outcome=REACHED, at=None):
        self.now_ns = self.now_ns if at is None else at
        self.ledger.finish(outcome, self.now_ns)
        return self.told()

    def told(self):
        trace, self.trace = self.trace, []
        return trace


@pytest.fixture
def desk():
    return Desk()


# ---- accept, reach, abort

def test_a_goal_is_accepted_at_once(desk):
    assert desk.receive('g', S, at=2 * S) == [('status', {'g': 'ACTIVE'})]
    assert (desk.record.goal_id, desk.record.stamp_ns, desk.record.text) == ('g', S, ACCEPTED)
    assert desk.ledger.active is desk.record


@pytest.mark.parametrize('outcome, state, text', [
    (REACHED, 'SUCCEEDED', 'Goal reached.'), (aborted('no way'), 'ABORTED', 'no way'),
    (NODE_KILLED, 'ABORTED', 'Aborting on the goal because the node has been killed')])
def test_a_goal_has_one_ending_and_its_result_comes_before_the_status_that_shows_it(desk, outcome, state, text):
    desk.receive('g')
    assert desk.finish(outcome, at=7) == [('result', 'g', state, text, 7), ('status', {'g': state})]
    assert desk.ledger.active is None
    assert desk.finish(REACHED, at=8) == []


def test_a_goal_without_id_and_stamp_gets_both(desk):
    assert desk.receive('', at=3 * S) == [('status', {'made-up-3000000000': 'ACTIVE'})]
    assert (desk.record.goal_id, desk.record.stamp_ns) == ('made-up-3000000000', 3 * S)


def test_states_have_the_numbers_of_actionlib():
    numbers = {'PENDING': 0, 'ACTIVE': 1, 'PREEMPTED': 2, 'SUCCEEDED': 3, 'ABORTED': 4, 'REJECTED': 5,
               'PREEMPTING': 6, 'RECALLING': 7, 'RECALLED': 8}
    assert {state.name: state.value for state in GoalState} == numbers


# ---- pre-emption and order

def test_a_new_goal_ends_the_active_one_and_is_accepted(desk):
    desk.receive('old', at=1)
    assert desk.receive('new', at=2) == [
        ('result', 'old', 'PREEMPTED', ANOTHER, 2), ('status', {'old': 'PREEMPTED', 'new': 'PENDING'}),
        ('status', {'old': 'PREEMPTED', 'new': 'ACTIVE'})]
    assert desk.ledger.active.goal_id == 'new'


@pytest.mark.parametrize('finished', [False, True])
def test_a_goal_older_than_the_last_accepted_one_is_recalled_even_if_that_has_ended(desk, finished):
    desk.receive('newer', 9 * S, at=10 * S)
    if finished:
        desk.finish()
    state = 'SUCCEEDED' if finished else 'ACTIVE'
    assert desk.receive('older', 9 * S - 1) == [
        ('result', 'older', 'RECALLED', ANOTHER, 10 * S), ('status', {'newer': state, 'older': 'RECALLED'})]
    assert desk.record is None


def test_a_goal_with_the_same_stamp_as_the_active_one_replaces_it(desk):
    desk.receive('a', 5 * S, at=6 * S)
    assert desk.receive('b', 5 * S)[0] == ('result', 'a', 'PREEMPTED', ANOTHER, 6 * S)
    assert desk.ledger.active.goal_id == 'b'


# ---- duplicates

def test_a_goal_with_an_id_on_the_list_is_not_a_goal(desk):
    desk.receive('g', 5, at=6)
    assert (desk.receive('g', 99, at=100), desk.record) == ([], None)
    desk.finish()
    assert (desk.receive('g', 101, at=102), desk.record) == ([], None)
    assert desk.listed() == {'g': 'SUCCEEDED'}


def test_a_duplicate_keeps_an_ended_goal_on_the_list_for_longer(desk):
    desk.receive('old', at=0)
    desk.receive('new', at=S)
    desk.receive('old', at=4 * S)
    assert desk.listed(9 * S) == {'old': 'PREEMPTED', 'new': 'ACTIVE'}
    assert desk.listed(9 * S + 1) == {'new': 'ACTIVE'}


def test_an_id_that_has_left_the_list_may_be_used_again(desk):
    desk.receive('a', at=0)
    desk.receive('b', at=S)
    assert desk.receive('a', at=6 * S + 1)[-1] == ('status', {'b': 'PREEMPTED', 'a': 'ACTIVE'})


# ---- the status list

def test_an_ended_goal_stays_for_five_seconds_the_last_one_until_the_next_has_come(desk):
    desk.receive('a', at=0)
    desk.finish(at=S)
    assert desk.listed(1000 * S) == {'a': 'SUCCEEDED'}
    desk.receive('b', at=1000 * S)
    assert desk.listed(1005 * S) == {'a': 'SUCCEEDED', 'b': 'ACTIVE'}
    assert desk.listed(1005 * S + 1) == {'b': 'ACTIVE'}


def test_a_goal_that_never_ran_leaves_the_list_after_five_seconds(desk):
    desk.receive('newer', 10 * S, at=10 * S)
    desk.receive('older', 9 * S, at=11 * S)
    assert desk.listed(16 * S) == {'newer': 'ACTIVE', 'older': 'RECALLED'}
    assert desk.listed(16 * S + 1) == {'newer': 'ACTIVE'}


def test_a_list_may_keep_goals_for_another_time():
    ledger = GoalLedger('bot', robot_stream(), NoClient('bot'), keep_ns=10)
    for now_ns, goal_id in ((1, 'a'), (2, 'b')):
        ledger.receive(goal_id, 0, now_ns)
    assert [[record.goal_id for record in ledger.records(now_ns)] for now_ns in (12, 13)] == [['a', 'b'], ['b']]


# ---- cancel

def cancelled(goal_id, now_ns, **others):
    return [('status', dict(others, **{goal_id: 'PREEMPTING'})), ('result', goal_id, 'PREEMPTED', '', now_ns),
            ('status', dict(others, **{goal_id: 'PREEMPTED'}))]


@pytest.mark.parametrize('cancel_id, cancel_stamp', [
    ('', 0), ('g', 0), ('g', 1), ('g', 99 * S), ('', 5 * S), ('', 99 * S), ('other', 5 * S)])
def test_the_active_goal_is_cancelled_by_no_id_and_no_stamp_by_its_id_or_by_a_stamp_not_before_it(
        desk, cancel_id, cancel_stamp):
    desk.receive('g', 5 * S, at=6 * S)
    others = {'other': 'RECALLING'} if cancel_id == 'other' else {}
    trace = desk.cancel(cancel_id, cancel_stamp, at=7 * S)
    assert trace[-2:] == cancelled('g', 7 * S, **others)[-2:]
    assert trace[0][1]['g'] == 'PREEMPTING'
    assert desk.texts()['g'] == ''


@pytest.mark.parametrize('cancel_id, cancel_stamp', [('other', 0), ('', 5 * S - 1), ('other', 5 * S - 1)])
def test_the_active_goal_is_not_cancelled_by_another_id_or_by_a_stamp_before_it(desk, cancel_id, cancel_stamp):
    desk.receive('g', 5 * S, at=6 * S)
    assert desk.cancel(cancel_id, cancel_stamp, at=7 * S) == []
    assert desk.ledger.active.state is GoalState.ACTIVE


def test_a_cancel_of_an_ended_goal_changes_nothing(desk):
    desk.receive('g', at=1)
    desk.finish(at=2)
    assert [desk.cancel(goal_id, at=3) for goal_id in ('g', '')] == [[], []]
    assert desk.listed() == {'g': 'SUCCEEDED'}


def test_a_second_cancel_of_a_goal_that_is_being_preempted_does_not_hit_it_again(desk):
    desk.receive('g', at=1)
    assert [desk.ledger.cancel('g', 0, 2), desk.ledger.cancel('', 0, 2)] == [True, False]


def test_a_goal_stamped_not_after_the_last_cancel_by_time_is_recalled_with_its_own_text(desk):
    assert desk.cancel('', 5 * S, at=4 * S) == []
    assert desk.cancel('', 3 * S) == []
    assert desk.receive('g', 5 * S, at=6 * S) == [('result', 'g', 'RECALLED', BEFORE_CANCEL, 6 * S),
                                                  ('status', {'g': 'RECALLED'})]
    assert desk.receive('h', 5 * S + 1) == [('status', {'g': 'RECALLED', 'h': 'ACTIVE'})]


def test_a_goal_without_a_stamp_is_not_hit_by_an_earlier_cancel_by_time(desk):
    desk.cancel('', 50 * S, at=4 * S)
    assert desk.receive('g') == [('status', {'g': 'ACTIVE'})]


# ---- a cancel that overtakes its goal

@pytest.mark.parametrize('goal_at', [2 * S, 6 * S, 1000 * S])
def test_a_goal_that_was_cancelled_before_it_came_is_recalled_however_much_simulated_time_has_passed(desk, goal_at):
    desk.cancel('g', at=S)
    assert desk.listed() == {'g': 'RECALLING'}
    assert desk.receive('g', at=goal_at) == [('result', 'g', 'RECALLED', '', goal_at), ('status', {'g': 'RECALLED'})]
    assert (desk.record, desk.ledger.active) == (None, None)


def test_the_active_goal_goes_on_while_another_is_recalled(desk):
    desk.receive('a', at=S)
    desk.cancel('b', at=S)
    desk.receive('b', at=S)
    assert desk.listed() == {'a': 'ACTIVE', 'b': 'RECALLED'}


def test_a_cancel_that_came_early_is_listed_for_five_seconds_and_hits_once(desk):
    desk.cancel('g', at=S)
    desk.cancel('g', at=2 * S)
    assert (desk.listed(6 * S), desk.listed(6 * S + 1)) == ({'g': 'RECALLING'}, {})
    desk.receive('g', at=7 * S)
    assert desk.receive('g', at=13 * S) == [('status', {'g': 'ACTIVE'})]


def test_a_cancel_of_everything_does_not_reach_goals_yet_to_come(desk):
    desk.cancel(at=S)
    assert desk.receive('g') == [('status', {'g': 'ACTIVE'})]


def test_the_last_thousand_early_cancels_are_remembered(desk):
    for number in range(1001):
        desk.cancel('g{}'.format(number), at=0)
    assert desk.listed(6 * S) == {}
    assert [desk.receive(goal_id, at=6 * S)[0][0] == 'result' for goal_id in ('g1', 'g1000', 'g0')] == [
        True, True, False]


def test_a_cleared_ledger_is_as_good_as_new_and_tells_nobody(desk):
    desk.receive('a', 9 * S, at=10 * S)
    desk.cancel('early', 20 * S)
    desk.finish()
    desk.receive('b')
    desk.told()
    desk.ledger.clear()
    assert (desk.told(), desk.listed(), desk.ledger.active) == ([], {}, None)
    assert [desk.receive(goal_id, S)[-1] for goal_id in ('a', 'early')] == [
        ('status', {'a': 'ACTIVE'}), ('status', {'a': 'PREEMPTED', 'early': 'ACTIVE'})]


# ---- any order of requests

IDS = st.sampled_from(['', 'a', 'b', 'c'])
STAMPS = st.sampled_from([0, 1, S, 3 * S, 20 * S])
REQUESTS = st.tuples(st.sampled_from(['receive', 'cancel', 'finish']), IDS, STAMPS, st.integers(1, 4 * S))


@given(st.lists(REQUESTS, max_size=25))
def test_whatever_comes_each_goal_that_is_taken_in_has_one_result_and_one_at_most_is_active(requests):
    desk = Desk()
    accepted, ended, now_ns = [], [], 0
    for kind, goal_id, stamp_ns, step_ns in requests:
        now_ns += step_ns
        if kind == 'finish':
            told = desk.finish(at=now_ns)
        else:
            told = getattr(desk, kind)(goal_id, stamp_ns, at=now_ns)
        if kind == 'receive' and desk.record is not None:
            accepted.append(desk.record)
        ended += [line[1] for line in told if line[0] == 'result' and line[2] != 'RECALLED']
        assert all(list(line[1].values()).count('ACTIVE') <= 1 for line in told if line[0] == 'status')
    ended += [line[1] for line in desk.finish(at=now_ns + 1) if line[0] == 'result']
    assert ended == [record.goal_id for record in accepted]
    assert all(record.ended_ns is not None for record in accepted)
