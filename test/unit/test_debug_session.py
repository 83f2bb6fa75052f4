"""A debugging session goes on and back: back is a new run, held to the rows that are known."""
import json
import os
from types import SimpleNamespace

import pytest

from move_base_abstract_ros.debugging.log_so_far import LogSoFar
from move_base_abstract_ros.debugging.session import Session
from move_base_abstract_ros.debugging.stops import ROUND, ROW, Refused, Stop

S = 10 ** 9
#: the rounds of a run: (instant [s], kinds of the rows that it writes)
ROUNDS = [(1, ''), (2, 'a'), (2, 'bcd'), (3, ''), (3, 'e'), (4, ''), (6, 'f'), (6, 'g')]


class FakeRun:
    """A run by a list of rounds, which stops as the time master does."""

    def __init__(self, folder, log, rounds):
        self.log, self.touched, self.is_over, self.rounds = LogSoFar(log), '', False, list(rounds)
        self.path, self.now_ns, self.has_ended = log, S, False
        self.state, self.nodes = SimpleNamespace(phase='stopped'), SimpleNamespace(places=[])
        os.mkdir(folder)
        with open(log + '.part', 'w') as stream:
            stream.write('{"event_log":1,"start_ns":0}\n')

    def await_start(self):
        return True

    def check_stopped(self):
        if self.is_over:
            raise Refused('over')

    def go(self, stop):
        self.check_stopped()
        count = 0
        while self.rounds:
            second, kinds = self.rounds[0]
            if stop.until_ns and second * S > stop.until_ns:
                self.now_ns, self.state.phase = stop.until_ns, 'paused'
                break
            self.rounds.pop(0)
            self.now_ns = second * S
            with open(self.path + '.part', 'a') as stream:
                for kind in kinds:
                    row = {'time_ns': self.now_ns, 'robot': 'r', 'kind': kind, 'values': ['a']}
                    stream.write(json.dumps(row) + '\n')
            self.log.read()
            count += 1 if stop.what == ROUND else sum(not stop.kind or stop.kind == kind for kind in kinds)
            self.state.phase = 'stopped'
            if (len(self.log.lines) >= stop.row if stop.row else count >= stop.times):
                break
        else:
            self.is_over, self.state.phase = True, 'ended'
        self.log.read()

    def interrupt(self):
        pass

    def end(self):
        self.has_ended = True

    def await_end(self):
        return 0


@pytest.fixture
def session_of(tmp_path):
    def make(*runs, known=None):
        each, begun = iter(runs or [ROUNDS] * 9), []

        def begin(folder, log, _places):
            begun.append(FakeRun(folder, log, next(each)))
            return begun[-1]
        session = Session(begin, str(tmp_path), known=known)
        session.run.log.read()
        session.begun = begun
        return session
    return make


def kinds(session):
    return ''.join(row.kind for row in session.run.log.entries(0, len(session.run.log.lines)))


def test_on_by_a_row_a_round_and_to_an_instant(session_of):
    session = session_of()
    session.go(Stop(ROW))
    assert kinds(session) == 'a'
    session.go(Stop(ROUND))
    assert kinds(session) == 'abcd'
    session.go_until(5 * S)
    assert (kinds(session), session.run.now_ns) == ('abcde', 5 * S)
    assert len(session.begun) == 1 and not session.said


def test_back_is_a_new_run_to_the_row_before_and_the_old_one_has_ended_first(session_of):
    session = session_of()
    session.go(Stop(ROW, kind='e'))
    session.back_rows(1)
    assert kinds(session) == 'abcd' and [run.has_ended for run in session.begun] == [True, False]
    session.back_rows(99)
    assert kinds(session) == '' and session.run.now_ns == S


def test_back_within_a_round_leads_to_the_instant_before(session_of):
    session = session_of()
    session.go(Stop(ROW, kind='g'))
    session.back_rows(1)
    assert kinds(session) == 'abcdef'
    session.back_rows(3)
    assert kinds(session) == 'abcd'
    session.back_rows(1)
    assert kinds(session) == '' and 'are of one round' in session.said[0]


def test_an_instant_that_has_gone_by_is_reached_by_a_new_run(session_of):
    session = session_of()
    session.to_instant(5 * S)
    assert len(session.begun) == 1
    session.to_instant(2 * S)
    assert (kinds(session), session.run.now_ns, len(session.begun)) == ('abcd', 2 * S, 2)
    session.to_instant(S)
    assert (kinds(session), session.run.now_ns, len(session.begun)) == ('', S, 3)


def test_a_run_that_is_over_can_be_gone_back_from_and_not_on(session_of):
    session = session_of()
    session.go_until(99 * S)
    assert session.run.is_over
    with pytest.raises(Refused):
        session.go(Stop(ROW))
    session.to_instant(4 * S)
    assert kinds(session) == 'abcde'


def test_a_row_that_differs_is_named_also_when_it_comes_long_after_the_way_back(session_of):
    session = session_of(ROUNDS, [*ROUNDS[:-1], (6, 'x')])
    session.go_until(6 * S)
    session.to_instant(3 * S)
    assert session.is_repeatable and not session.said
    session.go_until(6 * S)
    assert not session.is_repeatable
    assert 'row 7 is not as it was' in session.said[0] and '"kind": "g"' in session.said[1] and (
        '"kind": "x"' in session.said[2])
    session.said.clear()
    session.run.rounds.append((9, 'h'))
    session.run.is_over = False
    session.go_until(9 * S)
    assert not session.said  # it is said once


def test_a_run_is_held_to_a_log_that_is_given(session_of, tmp_path):
    first = session_of()
    first.go_until(9 * S)
    other = tmp_path / 'other'
    other.mkdir()
    known = first.run.log
    rounds = [*ROUNDS[:2], (2, 'bcx')]
    again = Session(lambda folder, log, _places: FakeRun(folder, log, rounds), str(other), known=known)
    again.go_until(2 * S)
    assert not again.is_repeatable and 'row 4 is not as in ' + known.path in again.said[0]


def test_a_run_that_was_touched_is_no_measure(session_of):
    session = session_of([*ROUNDS[:-1], (6, 'x')], ROUNDS)
    session.go_until(5 * S)
    session.run.touched = 'somebody called a function in /a'
    session.go_until(6 * S)
    session.to_instant(2 * S)
    session.go_until(6 * S)
    assert session.is_repeatable and session.said == ['the run before is thrown away: somebody called a function in /a']


def test_until_broken_stops_at_the_row_and_goes_back_to_it(session_of):
    rounds = [*((second, ['uncaught' if second == 6 else 'a']) for second in range(2, 40))]
    session = session_of(*[rounds] * 2)
    broken = session.until_broken()
    assert (broken.property, len(session.run.log.lines), session.run.now_ns) == ('no_exception', 5, 6 * S)
    assert len(session.begun) == 2
    assert session.until_broken() is None and session.run.is_over


def test_a_run_that_does_not_start_again_says_so(session_of):
    session = session_of()
    session.go_until(3 * S)
    begin = session._begin
    session._begin = lambda *words: _never(begin(*words))
    with pytest.raises(Refused, match='did not start again'):
        session.back_rows(1)


def _never(run):
    run.await_start = lambda: False
    return run
