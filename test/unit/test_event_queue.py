"""The order of events, cancelling, and series that stay on their multiples however the clock leaps."""

from types import SimpleNamespace

import pytest
from hypothesis import given, strategies as st

from move_base_abstract.engine.event_queue import USERS, EventQueue
from move_base_abstract.engine.series import Series
from move_base_abstract.engine.simulation import Simulation

TIMES = st.integers(0, 50)


class Trace:
    """A queue whose events write down when they were due, when they happened, and who they are."""

    def __init__(self):
        self.queue = EventQueue()
        self.present = SimpleNamespace(now_ns=0)
        self.lines = []

    def schedule(self, due_ns, robot_index=0, name=''):
        return self.queue.schedule(due_ns, robot_index,
                                   lambda due, now: self.lines.append((due, now, robot_index, name)))

    def run(self, *instants):
        for now_ns in instants:
            self.queue.run_until(now_ns, self.present)
        lines, self.lines = self.lines, []
        return lines


# ---- order

def test_what_is_scheduled_meanwhile_happens_in_its_place():
    trace = Trace()

    def schedule_more(due_ns, _now_ns):
        trace.schedule(due_ns, 0, 'same instant')
        trace.schedule(due_ns + 2, 0, 'between')
        trace.schedule(due_ns - 1, 0, 'belated')
        trace.schedule(100, 0, 'later')

    trace.queue.schedule(1, 0, schedule_more)
    trace.schedule(2, 1, 'second')
    trace.schedule(4, 0, 'last')
    assert trace.run(10) == [(0, 10, 0, 'belated'), (1, 10, 0, 'same instant'), (2, 10, 1, 'second'),
                             (3, 10, 0, 'between'), (4, 10, 0, 'last')]
    assert trace.queue.next_due_ns() == 100


def test_what_is_told_at_the_end_of_an_instant_comes_in_the_place_of_an_event_that_is_scheduled_then():
    trace = Trace()
    tell = trace.queue.tell_at_end(7, lambda item: trace.lines.append((item,)))

    def happen(due_ns, _now_ns):
        tell('first')
        trace.schedule(due_ns, 8, 'above')
        trace.schedule(due_ns, 7, 'second')
        trace.schedule(due_ns, 7, 'cancelled').cancel()
        tell('third')
        trace.schedule(due_ns, 6, 'below')

    trace.queue.schedule(5, 0, happen)
    trace.schedule(5, 7, 'scheduled before')
    assert trace.run(9) == [(5, 9, 6, 'below'), (5, 9, 7, 'scheduled before'), ('first',), (5, 9, 7, 'second'),
                            ('third',), (5, 9, 8, 'above')]
    trace.schedule(9, 7, 'cancelled').cancel()
    assert not trace.queue.is_busy()
    tell('between runs')
    assert trace.queue.is_busy() and trace.run(9) == [('between runs',)] and not trace.queue.is_busy()


def test_what_is_scheduled_for_the_present_instant_comes_among_the_other_events_of_that_instant():
    trace = Trace()

    def schedule_more(due_ns, _now_ns):
        for robot_index in (4, 1, 2):
            trace.schedule(due_ns, robot_index, 'new')

    trace.queue.schedule(5, 0, schedule_more)
    for robot_index in (3, 1):
        trace.schedule(5, robot_index, 'old')
    trace.schedule(6, 0, 'next')
    assert [line[2:] for line in trace.run(6)] == [
        (1, 'old'), (1, 'new'), (2, 'new'), (3, 'old'), (4, 'new'), (0, 'next')]


def test_after_an_error_the_events_of_its_instant_are_still_there_and_move_with_the_clock():
    trace = Trace()

    def fail(due_ns, _now_ns):
        trace.schedule(due_ns, 1, 'same instant')
        raise RuntimeError

    trace.queue.schedule(5, 0, fail)
    with pytest.raises(RuntimeError):
        trace.run(5)
    assert trace.queue.is_busy() and trace.queue.is_for_onlookers() is False
    trace.schedule(6, 0, 'next')
    assert trace.queue.next_due_ns() == 5
    trace.queue.shift(-3)
    assert trace.run(2, 3) == [(2, 2, 1, 'same instant'), (3, 3, 0, 'next')]


@given(st.lists(st.tuples(TIMES, st.integers(0, 3), st.booleans()), max_size=40), st.lists(TIMES, max_size=5))
def test_any_events_come_in_order_at_the_first_instant_not_before_them(plans, instants):
    trace = Trace()
    events = [trace.schedule(due_ns, robot, number) for number, (due_ns, robot, _) in enumerate(plans)]
    for event, (_, _, keep) in zip(events, plans):
        if not keep:
            event.cancel()
    instants = sorted(instants)
    ordered = sorted((due_ns, robot, number) for number, (due_ns, robot, keep) in enumerate(plans) if keep)
    expected = [(due_ns, next(now_ns for now_ns in instants if now_ns >= due_ns), robot, number)
                for due_ns, robot, number in ordered if instants and due_ns <= instants[-1]]
    assert trace.run(*instants) == expected
    left = [due_ns for due_ns, _, _ in ordered if not instants or due_ns > instants[-1]]
    assert trace.queue.next_due_ns() == (min(left) if left else None)


# ---- cancelling

def test_an_event_can_cancel_another_of_the_same_instant_and_itself():
    trace = Trace()
    events = {}

    def cancel_both(_due_ns, _now_ns):
        events['victim'].cancel()
        events['self'].cancel()

    events['self'] = trace.queue.schedule(1, 0, cancel_both)
    events['victim'] = trace.schedule(1, 0, 'victim')
    trace.schedule(1, 0, 'bystander')
    assert trace.run(1) == [(1, 1, 0, 'bystander')]


def test_an_event_that_has_happened_holds_no_action():
    trace = Trace()
    event = trace.schedule(1)
    assert event.action is not None
    trace.run(1)
    assert event.action is None


# ---- series

class SeriesTrace(Trace):
    def __init__(self, period_ns, first_ns=None):
        super().__init__()
        self.series = Series(self.queue, 3, period_ns, lambda due, now: self.lines.append((due, now)))
        if first_ns is not None:
            self.series.start(first_ns)


@pytest.mark.parametrize('period_ns', [0, -1])
def test_a_series_needs_a_period(period_ns):
    with pytest.raises(ValueError, match='the period of a series must be > 0 ns, got {}'.format(period_ns)):
        SeriesTrace(period_ns)


def test_a_series_is_still_on_its_multiples_after_a_billion_of_them():
    period_ns = 33_333_333
    trace = SeriesTrace(period_ns, first_ns=5)
    trace.run(5, 5 + 10 ** 9 * period_ns)
    assert trace.queue.next_due_ns() == 5 + (10 ** 9 + 1) * period_ns


def test_a_series_belongs_to_its_robot():
    trace = SeriesTrace(10, first_ns=10)
    trace.schedule(10, 4, 'after')
    trace.schedule(10, 2, 'before')
    assert trace.run(10) == [(10, 10, 2, 'before'), (10, 10), (10, 10, 4, 'after')]


def test_a_stopped_series_is_silent_until_it_is_started_anew_from_there():
    trace = SeriesTrace(10, first_ns=0)
    assert trace.run(0, 10) == [(0, 0), (10, 10)]
    trace.series.stop()
    trace.series.stop()
    assert (trace.run(25), trace.queue.next_due_ns()) == ([], None)
    trace.series.start(26)
    assert trace.run(30, 36) == [(26, 30), (36, 36)]


def test_starting_twice_makes_one_series():
    trace = SeriesTrace(10, first_ns=0)
    trace.series.start(5)
    assert trace.run(0, 5, 10, 15) == [(5, 5), (15, 15)]


def test_a_series_can_be_stopped_by_its_own_action():
    trace = Trace()
    series = Series(trace.queue, 0, 10, lambda due, now: (trace.lines.append((due, now)), series.stop()))
    series.start(0)
    assert trace.run(0, 10, 20) == [(0, 0)]


def test_a_series_may_be_started_anew_by_its_own_action():
    trace = Trace()

    def happen(due_ns, now_ns):
        trace.lines.append((due_ns, now_ns))
        if due_ns == 10:
            series.start(27)

    series = Series(trace.queue, 0, 10, happen)
    series.start(0)
    assert trace.run(0, 10, 20, 27, 37) == [(0, 0), (10, 10), (27, 27), (37, 37)]


def test_a_series_with_nothing_to_do_for_a_while_pauses_and_comes_back_on_its_multiples():
    trace = Trace()
    pauses = iter([25, 0, None, 10, None, None])

    def happen(due_ns, now_ns):
        trace.lines.append((due_ns, now_ns))
        return next(pauses)

    Series(trace.queue, 0, 10, happen).start(0)
    assert trace.run(*range(0, 80)) == [(0, 0), (30, 30), (40, 40), (50, 50), (70, 70)]


@given(st.integers(1, 20), TIMES, st.lists(st.integers(0, 300), max_size=30))
def test_any_leaps_give_one_call_each_on_the_first_multiple_still_due(period_ns, first_ns, instants):
    expected, multiple = [], first_ns
    for now_ns in sorted(instants):
        if multiple <= now_ns:
            expected.append((multiple, now_ns))
        while multiple <= now_ns:
            multiple += period_ns
    trace = SeriesTrace(period_ns, first_ns)
    assert trace.run(*sorted(instants)) == expected
    assert trace.queue.next_due_ns() == multiple


# ---- what others do in the place of series

SERIES = st.lists(st.tuples(st.integers(1, 9), st.integers(0, 3), st.integers(0, 12)), min_size=1, max_size=6)
OTHERS = st.lists(st.tuples(TIMES, st.integers(0, 3)), max_size=4)


def told_by(series, others):
    """Return a trace with series of output (period, robot, first) and other events (due, robot)."""
    trace = Trace()
    for number, (period_ns, robot_index, first_ns) in enumerate(series):
        def tell(due, now, number=number):
            trace.lines.append((due, now, number))
        Series(trace.queue, robot_index, period_ns, tell, is_output=True).start(first_ns)
    for due_ns, robot_index in others:
        trace.schedule(due_ns, robot_index, 'other')
    return trace


def instant_by_instant(trace, until_ns):
    while trace.queue.next_due_ns() is not None and trace.queue.next_due_ns() <= until_ns:
        trace.queue.run_until(trace.queue.next_due_ns(), trace.present)


@given(SERIES, OTHERS, st.integers(0, 60), st.integers(0, 60))
def test_series_whose_part_others_have_done_go_on_as_if_they_had_done_it(series, others, before_ns, until_ns):
    live, other = told_by(series, others), told_by(series, others)
    heard, end_ns = other.queue.heard_output(before_ns)
    assert end_ns == min([before_ns, *(due for due, _robot in others)])
    done = sorted((due_ns, place) for place, (first_ns, one) in enumerate(heard)
                  for due_ns in range(first_ns, min(until_ns + 1, end_ns), one.period_ns))
    for due_ns, place in done:
        heard[place][1].tell(due_ns)
    for due_ns, place in done:
        heard[place][1].skip(due_ns)
    instant_by_instant(live, 60)
    instant_by_instant(other, 60)
    assert other.lines == live.lines


def test_heard_output_comes_in_its_order_and_ends_at_the_first_event_of_another_kind():
    trace = told_by([(10, 1, 10), (20, 0, 20)], [(40, 5)])
    for before_ns, end_ns in ((1000, 40), (30, 30)):
        heard, found_ns = trace.queue.heard_output(before_ns)
        assert ([due_ns for due_ns, _ in heard], found_ns) == ([20, 10], end_ns)
    assert trace.lines == []


@pytest.mark.parametrize('goes_on', [False, True])
def test_time_goes_on_alone_only_for_what_says_so(goes_on):
    queue = EventQueue()
    assert (queue.ever_waits, queue.is_busy(), queue.is_for_onlookers()) == (False, False, False)
    queue.schedule(5, 0, lambda due_ns, _now_ns: None, keeps_going=lambda: goes_on)
    assert (queue.ever_waits, queue.is_busy(), queue.is_for_onlookers()) == (True, goes_on, not goes_on)
    other = queue.schedule(9, 0, lambda due_ns, _now_ns: None)
    assert (queue.is_busy(), queue.is_for_onlookers()) == (True, False)
    other.cancel()
    assert queue.is_for_onlookers() is not goes_on


def test_what_is_cancelled_long_before_it_is_due_does_not_stay():
    queue = EventQueue()
    happened = []
    for number in range(20_000):
        queue.schedule(10 ** 15 + number, 0, lambda due_ns, _now_ns: happened.append(due_ns)).cancel()
        if number % 1000 == 0:
            queue.schedule(10 ** 12 - number, 0, lambda due_ns, _now_ns: happened.append(due_ns))
    assert len(queue._heap) < 10_000
    queue.run_until(10 ** 16, SimpleNamespace(now_ns=0))
    assert happened == [10 ** 12 - number for number in reversed(range(0, 20_000, 1000))]


def test_what_is_decided_at_the_end_of_an_instant_can_be_left_until_all_has_come():
    simulation, told = Simulation(0), []
    for due_ns in (4, 5):
        simulation.queue.schedule(due_ns, 1, lambda due_ns, _now_ns: simulation.queue.decide(
            due_ns, lambda due_ns, _now_ns: told.append((due_ns, 'decided'))))
    for due_ns, index in ((4, 2), (5, 2), (6, 3)):
        simulation.queue.schedule(due_ns, index, lambda due_ns, _now_ns, index=index: told.append((due_ns, index)))
    simulation.advance(5, decides=False)
    assert told == [(4, 2), (4, 'decided'), (5, 2)] and simulation.next_due_ns() == 5
    simulation.queue.schedule(5, 3, lambda due_ns, _now_ns: told.append((due_ns, 3)))
    simulation.advance(5)
    assert told[3:] == [(5, 3), (5, 'decided')] and simulation.next_due_ns() == 6


def test_a_cancelled_event_changes_no_order_where_something_is_to_be_done_when_all_is_quiet():
    queue, told = EventQueue(), []
    tell = queue.tell_at_end(USERS, told.append)
    cancelled = queue.schedule(5, 3, lambda *_: None, keeps_going=lambda: False)

    def act(due_ns, _now_ns):
        cancelled.cancel()
        tell('user')
        queue.schedule(due_ns, 4, lambda *_: told.append('robot'), keeps_going=lambda: False)
    queue.schedule(5, 1, act)
    queue.when_quiet(lambda *_: told.append('quiet'))
    queue.run_until(5, SimpleNamespace(now_ns=0))
    assert told == ['robot', 'user', 'quiet']


def test_what_users_calls_cause_is_decided_after_all_of_those_of_one_turn():
    simulation, told = Simulation(0), []
    queue = simulation.queue

    def call(name, more=()):
        told.append(name)
        queue.decide(1, lambda *_: told.append('decided for ' + name))
        for other in more:
            tell(other)
    tell = queue.tell_at_end(USERS, lambda name: call(name, {'a': 'c'}.get(name, '')))
    queue.schedule(1, 0, lambda *_: [queue.decide(1, lambda *_: told.append('decided')), tell('a'), tell('b')])
    queue.schedule(1, USERS, lambda *_: call('x'))
    queue.schedule(1, USERS + 2, lambda *_: call('y'))
    simulation.run()
    assert told == ['decided', 'x', 'a', 'b', 'c', 'y', *('decided for ' + name for name in 'xabcy')]


def test_a_turn_of_users_calls_is_as_long_when_it_comes_first_or_follows_one_that_decides_nothing():
    simulation, told = Simulation(0), []
    queue = simulation.queue

    def call(name):
        told.append(name)
        if len(name) == 1:
            queue.schedule(0, 0, lambda *_: tell(name + name))
        elif name == 'aa':
            queue.decide(0, lambda *_: told.append('decided'))
    tell = queue.tell_at_end(USERS, call)
    for name in 'abc':
        tell(name)
    simulation.run()
    assert told == ['a', 'b', 'c', 'aa', 'bb', 'cc', 'decided']


def test_a_robot_s_event_amid_the_first_turn_of_users_calls_does_not_make_it_longer():
    simulation, told = Simulation(0), []
    queue = simulation.queue

    def call(name):
        told.append(name)
        if name == 'a':
            queue.schedule(0, 0, lambda *_: tell('aa'))
            queue.decide(0, lambda *_: told.append('decided'))
    tell = queue.tell_at_end(USERS, call)
    for name in 'ab':
        tell(name)
    simulation.run()
    assert told == ['a', 'b', 'decided', 'aa']
