"""Whose turn it is: the order within a grant, callbacks that block, waits, and the end of it all.

lockstep_program.py plays the time master.
"""

import threading
from collections import Counter

import pytest

from lockstep_program import GUARD, Program
from move_base_abstract.lockstep.task import TurnLost
from move_base_abstract.lockstep.wire import NEVER


class Source:
    """Events at stated times."""

    def __init__(self, program, *times):
        self.program = program
        self.times = list(times)

    def next_due_ns(self):
        return self.times[0] if self.times else None

    def run(self, now_ns):
        while self.times and self.times[0] <= now_ns:
            self.program.say('event', self.times.pop(0))


def test_a_sleeper_goes_on_at_its_instant_and_not_before():
    program = Program()

    def main():
        for pause in (5, 1, 3):
            program.sleep(pause)
            program.say('main')
    assert program.run(main) == [('main', 5), ('main', 6), ('main', 9)]
    assert program.master.asked == [5, 6, 9, NEVER]


def test_within_a_grant_mail_comes_first_then_those_it_woke_then_events_then_sleepers():
    program = Program()
    tasks = {}

    def sleeper(name, pause):
        program.sleep(pause)
        program.say(name)

    def waiter(name):
        program.scheduler.wait()
        program.say(name)

    def wake(name):
        program.say('mail', name)
        program.scheduler.wake(tasks[name])

    program.master.script = [(10, [lambda: wake('second'), lambda: wake('first')])]
    program.scheduler.set_source(Source(program, 10, 12))

    def main():
        for name in ('first', 'second'):
            tasks[name] = program.thread(name, waiter, name)
        program.thread('late', sleeper, 'late', 10)
        program.thread('early', sleeper, 'early', 9)
        program.sleep(10)
        program.say('main')
    assert program.run(main) == [
        ('early', 9), ('mail', 'second', 10), ('mail', 'first', 10), ('second', 10), ('first', 10), ('event', 10, 10),
        ('main', 10), ('late', 10), ('event', 12, 12)]


def test_of_equal_times_who_began_to_sleep_first_goes_on_first():
    program = Program()

    def sleeper(name, naps):
        for nap in naps:
            program.sleep(nap)
        program.say(name)

    def main():
        program.thread('a', sleeper, 'a', (1, 5))
        program.thread('b', sleeper, 'b', (6,))
        program.thread('c', sleeper, 'c', (2, 4))
        program.sleep(6)
        program.say('main')
    assert program.run(main) == [('main', 6), ('b', 6), ('a', 6), ('c', 6)]


def test_another_worker_takes_over_where_a_callback_blocks():
    program = Program()

    def blocks():
        program.say('begins')
        program.sleep(5)
        program.say('ends')
    program.master.script = [(1, [blocks, program.sayer('next')]), (3, [program.sayer('later')])]
    assert program.run(lambda: None) == [
        ('begins', 1), ('next', 1), ('later', 3), ('ends', 6)]


def test_callbacks_that_block_within_callbacks_that_block_all_come_to_their_ends():
    program = Program()

    def blocks(name, pause):
        def callback():
            program.say('begins', name)
            program.sleep(pause)
            program.say('ends', name)
        return callback
    program.master.script = [(1, [blocks('a', 3), blocks('b', 1), blocks('c', 2)]), (2, [blocks('d', 2)])]
    assert program.run(lambda: None) == [
        ('begins', 'a', 1), ('begins', 'b', 1), ('begins', 'c', 1), ('begins', 'd', 2), ('ends', 'b', 2),
        ('ends', 'c', 3), ('ends', 'a', 4), ('ends', 'd', 4)]


def test_workers_are_used_again():
    program = Program()
    seen = Counter()

    def nap():
        seen[threading.get_ident()] += 1
        program.sleep(1)
    program.master.script = [(10 * step, [nap, nap]) for step in range(1, 20)]
    program.run(lambda: None)
    assert sum(seen.values()) == 38
    assert len(seen) <= 3


@pytest.mark.parametrize('until, said', [
    (9, [(True, 5), (False, 20)]), (5, [(True, 5), (False, 20)]), (3, [(False, 3), (True, 5)])])
def test_wait_tells_waking_from_time_being_up_and_leaves_no_time_behind(until, said):
    program = Program()

    def main():
        mine = program.scheduler.current()
        program.master.script = [(5, [lambda: program.scheduler.wake(mine)])]
        for wake_ns in (until, 20):
            program.say(program.scheduler.wait(wake_ns))
            assert program.scheduler.next_ns() == NEVER
    assert program.run(main) == said


def test_waking_who_does_not_wait_is_nothing():
    program = Program()

    def main():
        program.scheduler.wake(program.scheduler.current())
        program.scheduler.wait(3)
        program.say('main')
    assert program.run(main) == [('main', 3)]


def test_wait_until_looks_whenever_something_has_happened():
    program = Program()
    box = []
    told = []
    program.master.script = [(2, [lambda: box.append(1)]), (4, [lambda: box.append(2)])]

    def main():
        told.append(program.scheduler.wait_until(lambda: len(box) == 2, 10))
        program.say('both')
        told.append(program.scheduler.wait_until(lambda: len(box) == 3, 10))
        program.say('time is up')
        told.append(program.scheduler.wait_until(lambda: box, 10))
    assert program.run(main) == [('both', 4), ('time is up', 10)]
    assert told == [True, False, True]


def test_wait_until_sees_what_another_thread_does_at_the_same_instant():
    program = Program()
    box = []

    def other():
        program.sleep(5)
        box.append(1)
        program.say('put')

    def main():
        program.thread('other', other)
        program.scheduler.wait_until(lambda: box)
        program.say('seen')
    assert program.run(main) == [('put', 5), ('seen', 5)]


def test_waits_without_end_are_open_work_and_named():
    program = Program()
    told = []

    def other():
        program.scheduler.wait(waits_for='the end', kind=None)

    def main():
        program.thread('other', other)
        exchange = program.master.exchange
        program.master.exchange = lambda: (
            told.append([(task.name, task.waits_for) for task in program.scheduler.open_waits]), exchange())[1]
        program.scheduler.wait(3, 'a while')
        program.scheduler.wait(waits_for='a message')
    program.run(main)
    assert told == [[], [('main', 'a message')]]


def test_new_threads_run_in_the_order_in_which_they_were_started_after_who_starts_them():
    program = Program()

    def main():
        for name in 'abc':
            program.thread(name, program.say, name)
        program.say('main')
        program.sleep(1)
        program.say('main')
    assert program.run(main) == [('main', 0), ('a', 0), ('b', 0), ('c', 0), ('main', 1)]


def test_the_end_of_a_thread_is_seen_at_once_and_the_others_go_on():
    program = Program()

    def main():
        task = program.thread('other', program.sleep, 4)
        program.scheduler.wait_until(lambda: task.is_finished)
        program.say('joined')
    assert program.run(main) == [('joined', 4)]


def test_when_the_main_thread_ends_others_and_messages_go_on():
    program = Program((7, [lambda: program.say('mail')]))

    def other():
        program.sleep(5)
        program.say('other')
        program.sleep(5)
        program.say('other')
    assert program.run(lambda: program.thread('other', other)) == [('other', 5), ('mail', 7), ('other', 10)]


def test_an_event_that_waits_does_not_spoil_the_wait_of_the_thread_in_whose_turn_it_happened():
    program = Program()

    class Waits(Source):
        def run(self, now_ns):
            self.times.pop(0)
            program.sleep(2)
            program.say('event')
    program.scheduler.set_source(Waits(program, 5))

    def main():
        program.sleep(10)
        program.say('main')
    assert program.run(main) == [('event', 7), ('main', 10)]


def test_an_error_in_a_condition_is_its_owners_and_nobody_elses():
    program = Program((3, [lambda: program.say('mail')]))

    def broken():
        if program.scheduler.now_ns >= 3:
            raise KeyError('broken')
        return False

    def other():
        try:
            program.scheduler.wait_until(broken)
        except KeyError:
            program.say('error')

    def main():
        program.thread('other', other)
        program.sleep(5)
        program.say('main')
    assert program.run(main) == [('mail', 3), ('error', 3), ('main', 5)]


def test_an_error_in_a_message_s_handling_ends_neither_the_worker_nor_the_round(monkeypatch):
    shown = []
    monkeypatch.setattr(threading, 'excepthook', lambda raised: shown.append(raised.exc_type))

    def broken():
        raise KeyError('broken')
    program = Program((1, [broken, lambda: program.say('next')]), (2, [lambda: program.say('later')]))

    def main():
        program.sleep(5)
        program.say('main')
    assert program.run(main) == [('next', 1), ('later', 2), ('main', 5)]



@pytest.mark.parametrize('count', [1, 5])
def test_close_lets_go_of_all_threads_wherever_they_wait(count):
    program = Program()
    lost = []

    def waits(wait):
        try:
            wait()
        except TurnLost:
            lost.append(wait)

    def blocks():
        waits(lambda: program.sleep(1000))
    program.master.script = [(1, [blocks] * count)]

    def main():
        for _ in range(count):
            program.thread('sleeps', waits, lambda: program.sleep(2000))
            program.thread('waits', waits, program.scheduler.wait)
            program.thread('looks', waits, lambda: program.scheduler.wait_until(lambda: False))
        program.sleep(10)
        program.thread('has not begun', lost.append, 'goes as it likes')
        program.scheduler.close()
    assert program.run(main) == []
    assert len(lost) == 4 * count + 1
    assert not program.scheduler.is_mine()


def test_close_from_a_thread_without_the_turn():
    program = Program()

    def exchange():
        closing = threading.Thread(target=program.scheduler.close)
        closing.start()
        closing.join(GUARD)
        raise TurnLost()
    program.master.exchange = exchange

    def main():
        program.thread('other', program.sleep, 5)
        with pytest.raises(TurnLost):
            program.sleep(10)
        with pytest.raises(TurnLost):
            program.sleep(10)
    program.run(main)


def test_who_rests_goes_on_when_nothing_is_left_at_this_instant_and_all_do_at_once():
    program = Program()
    program.master.script = [(0, [program.sayer('first')]), (0, [program.sayer('second')]),
                             (5, [program.sayer('later')])]

    def rest(name):
        program.scheduler.rest()
        program.say(name)

    def main():
        program.thread('other', rest, 'other')
        rest('main')
        program.sleep(5)
    assert program.run(main) == [('first', 0), ('second', 0), ('main', 0), ('other', 0), ('later', 5)]
