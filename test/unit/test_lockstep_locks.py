"""Python's locks, and what is made of them, among threads that take turns; time-outs are simulated."""

import queue
import threading

import pytest

from lockstep_program import GUARD, Program
from move_base_abstract.lockstep import locks
from move_base_abstract.lockstep.locks import CooperativeLock, CooperativeRLock
from move_base_abstract.lockstep.task import TurnLost


def unread():
    raise AssertionError('the clock of the machine is not asked')


@pytest.fixture
def program(monkeypatch):
    """Return a program in whose process locks give the turn away."""
    made = Program()
    monkeypatch.setattr(threading, 'Lock', CooperativeLock)
    monkeypatch.setattr(threading, '_allocate_lock', CooperativeLock)
    monkeypatch.setattr(threading, 'RLock', CooperativeRLock)
    for module, name in ((threading, '_time'), (queue, 'time')):
        monkeypatch.setattr(module, name, locks.clock(unread))
    monkeypatch.setattr(locks.Process, 'scheduler', made.scheduler)
    return made


@pytest.mark.parametrize(('own', 'make'), [(CooperativeLock, threading.Lock), (CooperativeRLock, threading.RLock)])
def test_a_lock_has_all_that_pythons_has(own, make):
    assert set(dir(make())) - set(dir(own())) == set()


def test_how_often_a_lock_is_taken_is_told_to_its_owner(program):
    lock = CooperativeRLock()
    assert (lock._recursion_count(), lock.locked()) == (0, False)
    with lock, lock:
        assert (lock._recursion_count(), lock.locked()) == (2, True)


@pytest.mark.parametrize('make', [CooperativeLock, CooperativeRLock])
def test_who_waits_for_a_lock_lets_its_holder_go_on_and_gets_it_in_turn(program, make):
    lock = make()

    def use(name, pause):
        with lock:
            program.say(name, 'has it')
            program.sleep(pause)
            program.say(name, 'gives it')

    def main():
        program.thread('a', use, 'a', 3)
        program.thread('b', use, 'b', 2)
        program.thread('c', use, 'c', 1)
        program.sleep(10)
        assert lock.acquire(False)
        lock.release()
    assert program.run(main) == [('a', 'has it', 0), ('a', 'gives it', 3), ('b', 'has it', 3), ('b', 'gives it', 5),
                                 ('c', 'has it', 5), ('c', 'gives it', 6)]


@pytest.mark.parametrize('make', [CooperativeLock, CooperativeRLock])
def test_a_time_out_is_simulated(program, make):
    lock = make()

    def hold():
        with lock:
            program.sleep(3_000_000_000)

    def main():
        program.thread('holder', hold)
        program.sleep(1_000_000_000)
        assert not lock.acquire(False)
        assert not lock.acquire(True, 0)
        program.say('not at once')
        assert not lock.acquire(True, 0.5)
        program.say('not in time')
        assert lock.acquire(True, 100)
        program.say('in time')
    assert program.run(main) == [('not at once', 1_000_000_000), ('not in time', 1_500_000_000),
                                 ('in time', 3_000_000_000)]


def test_the_longest_time_out_of_python_is_none(program):
    lock = CooperativeLock()

    program.master.script = [(5, [lock.release])]

    def main():
        lock.acquire()
        assert lock.acquire(True, threading.TIMEOUT_MAX)
    program.run(main)
    assert program.master.asked[0] == 2 ** 63 - 1


def test_arguments_are_as_python_s():
    lock, own = CooperativeLock(), threading.Lock()
    for taken in (lock, own):
        assert taken.acquire()
        assert taken.locked()
        for arguments in ((True, -2), (False, 1)):
            with pytest.raises(ValueError):
                taken.acquire(*arguments)
        taken.release()
        assert not taken.locked()
        with pytest.raises(RuntimeError):
            taken.release()


def test_a_recursive_lock_is_its_owner_s(program):
    lock = CooperativeRLock()

    def main():
        with pytest.raises(RuntimeError):
            lock.release()
        with lock:
            with lock:
                pass
            program.thread('other', lambda: program.say(lock.acquire(False)))
            program.sleep(1)
        with pytest.raises(RuntimeError):
            lock.release()
    assert program.run(main) == [(False, 0)]


def test_a_lock_that_a_waiter_gave_up_on_is_free_for_the_others(program):
    lock = CooperativeLock()

    def use(name, timeout):
        program.say(name, lock.acquire(True, timeout))

    def main():
        lock.acquire()
        program.thread('a', use, 'a', 2e-9)
        program.thread('b', use, 'b', 100)
        program.sleep(3)
        lock.release()
        program.sleep(1)
    assert program.run(main) == [('a', False, 2), ('b', True, 3)]


def test_conditions_wake_in_the_order_of_waiting_and_time_out_exactly(program):
    condition = threading.Condition()

    def wait(name, timeout):
        with condition:
            program.say(name, condition.wait(timeout))

    def main():
        for name, timeout in (('a', None), ('b', 4e-9), ('c', None), ('d', None)):
            program.thread(name, wait, name, timeout)
        program.sleep(5)
        with condition:
            condition.notify()
        program.sleep(1)
        with condition:
            condition.notify_all()
        program.sleep(1)
    assert program.run(main) == [('b', False, 4), ('a', True, 5), ('c', True, 6), ('d', True, 6)]


def test_a_condition_gives_a_lock_that_was_taken_twice_whole_and_takes_it_back_twice(program):
    lock = CooperativeRLock()
    condition = threading.Condition(lock)

    def notify():
        with condition:
            program.say('has it')
            condition.notify()

    def main():
        with lock:
            with lock:
                program.thread('notify', notify)
                assert condition.wait()
                program.say('has it back')
                program.thread('other', other)
            program.sleep(2)
            program.say('gives it')
        with pytest.raises(RuntimeError, match='un-acquired'):
            lock.release()
        program.sleep(1)

    def other():
        with lock:
            program.say('other')
    assert program.run(main) == [('has it', 0), ('has it back', 0), ('gives it', 2), ('other', 2)]


def test_events(program):
    event = threading.Event()

    def main():
        program.thread('other', lambda: program.say('other', event.wait()))
        program.say('main', event.wait(3e-9))
        event.set()
        program.sleep(1)
        program.say('main', event.wait(3e-9))
    assert program.run(main) == [('main', False, 3), ('other', True, 3), ('main', True, 4)]


def test_queues(program):
    box = queue.Queue(maxsize=2)

    def produce():
        for number in range(4):
            box.put(number)
            program.say('put', number)

    def main():
        program.thread('producer', produce)
        with pytest.raises(queue.Empty):
            box.get(False)
        program.sleep(1)
        for number in range(4):
            assert box.get() == number
            program.sleep(1)
        with pytest.raises(queue.Empty):
            box.get(timeout=2e-9)
        program.say('empty')
    assert program.run(main) == [('put', 0, 0), ('put', 1, 0), ('put', 2, 1), ('put', 3, 2), ('empty', 7)]


def test_semaphores_and_barriers(program):
    semaphore = threading.Semaphore(2)
    barrier = threading.Barrier(3)

    def work(name, pause):
        with semaphore:
            program.say(name)
            program.sleep(pause)
        barrier.wait()
        program.say(name, 'after')

    def main():
        for name, pause in (('a', 5), ('b', 2), ('c', 1)):
            program.thread(name, work, name, pause)
        program.sleep(20)
    trace = program.run(main)
    assert trace[:3] == [('a', 0), ('b', 0), ('c', 2)]
    assert sorted(trace[3:]) == [(name, 'after', 5) for name in 'abc']


def test_a_lock_that_a_free_thread_holds_is_waited_for_with_time_standing_still(program):
    lock = CooperativeLock()
    held, go = threading.Semaphore(0), threading.Semaphore(0)

    def free():
        with lock:
            held.release()
            go.acquire()

    def main():
        thread = threading.Thread(target=free)
        program.scheduler.turn_ident, mine = 0, program.scheduler.turn_ident
        thread.start()
        held.acquire()
        program.scheduler.turn_ident = mine
        assert not lock.acquire(False)
        go.release()
        with lock:
            program.say('main')
        program.scheduler.turn_ident = 0
        thread.join(GUARD)
        program.scheduler.turn_ident = mine
    assert program.run(main) == [('main', 0)]
    assert program.master.asked == [2 ** 63 - 1]


def test_a_free_thread_that_releases_wakes_in_the_next_round(program):
    lock = CooperativeLock()

    def main():
        lock.acquire()
        free = threading.Thread(target=lock.release)
        exchange = program.master.exchange

        def release_meanwhile():
            program.master.exchange = exchange
            program.scheduler.turn_ident, mine = 0, program.scheduler.turn_ident
            free.start()
            free.join(GUARD)
            program.scheduler.turn_ident = mine
            return exchange()
        program.master.exchange = release_meanwhile
        lock.acquire()
        program.say('main')
    assert program.run(main) == [('main', 0)]


def test_when_lockstep_ends_who_waits_for_nobody_is_told(program, monkeypatch):
    monkeypatch.setattr(locks, '_LAST_WAIT', 0.01)
    lock = CooperativeLock()
    told = []

    def wait():
        try:
            lock.acquire()
        except TurnLost as error:
            told.append(str(error))

    def main():
        lock.acquire()
        program.thread('other', wait)
        program.thread('in time', lambda: told.append(lock.acquire(True, 60)))
        program.sleep(1)
    program.run(main)
    assert sorted(told, key=str) == [False, 'lockstep has ended while this thread waited for another one']


def test_when_lockstep_ends_locks_are_as_ever(program):
    lock = CooperativeLock()
    told = []

    def wait():
        told.append(lock.acquire())

    def main():
        lock.acquire()
        program.thread('other', wait)
        program.sleep(1)
        program.scheduler.close()
        assert told == []
        lock.release()
    program.run(main)
    assert told == [True]
