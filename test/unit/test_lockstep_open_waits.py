"""Which waits without end are for work that may come, and which for what is owed; no ROS, no wall clock."""

import concurrent.futures
import queue
import threading

import pytest

import test_lockstep_locks
from move_base_abstract.lockstep import locks, open_waits
from move_base_abstract.lockstep.task import TurnLost

program = test_lockstep_locks.program  # a fixture


@pytest.fixture(autouse=True)
def quick_end(monkeypatch):
    monkeypatch.setattr(locks, '_LAST_WAIT', 0.0)


def owed_and_idle(program, *waits, callbacks=()):
    """Return names of (those to whom something is owed, the idle ones), and what all wait for, when nothing is left."""
    told = []
    exchange = program.master.exchange

    def last_report():
        owed, idle = open_waits.split(program.scheduler.open_waits)
        told.append(([task.name for task in owed], [task.name for task in idle],
                     [task.waits_for for task in owed + idle]))
        return exchange()

    def main():
        program.master.exchange = last_report
        program.tasks = [program.thread('thread {}'.format(number), wait) for number, wait in enumerate(waits)]
        for callback in callbacks:
            program.scheduler._mail.append(callback)
    program.run(main)
    return told[-1]


IDLE = {
    'a queue': lambda: queue.Queue().get(),
    'a queue with priorities': lambda: queue.PriorityQueue().get(),
    'a simple queue': lambda: queue._PySimpleQueue().get(),
    'an event': lambda: threading.Event().wait(),
}
OWED = {
    'a lock': lambda: [lock.acquire() for lock in [threading.Lock()] * 2],
    'a full queue': lambda: [one.put(0) for one in [queue.Queue(1)] * 2],
    'the end of all jobs': lambda: [(one.put(0), one.join()) for one in [queue.Queue()]],
    'a permit': lambda: threading.Semaphore(0).acquire(),
    'others at a barrier': lambda: threading.Barrier(2).wait(),
    'a result': lambda: concurrent.futures.Future().result(),
    'results': lambda: concurrent.futures.wait([concurrent.futures.Future()]),
}


def wait_for_condition():
    condition = threading.Condition()
    with condition:
        condition.wait()


def wait_for_condition_to_hold():
    condition = threading.Condition()
    with condition:
        condition.wait_for(lambda: False)


@pytest.mark.parametrize('wait', [*IDLE.values(), wait_for_condition, wait_for_condition_to_hold],
                         ids=[*IDLE, 'a condition', 'a condition that holds'])
def test_who_waits_for_work_is_idle_and_its_place_is_told(program, wait):
    owed, idle, (what,) = owed_and_idle(program, wait)
    assert (owed, idle) == ([], ['thread 0'])
    assert __file__ in what and 'another thread' in what


def test_the_place_is_the_programs_own_where_it_waits_in_what_stands_in_for_rospy(program):
    ours = {'__name__': 'move_base_abstract_ros.lockstep.exchange.topics', 'queue': queue}
    exec(compile('def receive(): queue.Queue().get()', 'topics.py', 'exec'), ours)

    def wait():
        ours['receive']()
    _, _, (what,) = owed_and_idle(program, wait)
    assert __file__ in what and 'topics.py' not in what


@pytest.mark.parametrize('wait', OWED.values(), ids=OWED)
def test_what_others_must_do_is_owed(program, wait):
    assert owed_and_idle(program, wait)[:2] == (['thread 0'], [])


def test_what_is_said_to_be_waited_for_is_owed(program):
    def wait():
        program.scheduler.wait(waits_for='a message')
    assert owed_and_idle(program, wait) == (['thread 0'], [], ['a message'])


def test_a_callback_that_waits_is_in_the_middle_of_its_work(program):
    assert owed_and_idle(program, callbacks=[wait_for_condition])[:2] == (['lockstep_worker'], [])


def join(program, number):
    def wait():
        task = program.tasks[number]
        program.scheduler.wait_until(lambda: task.is_finished, kind=task)
    return wait


@pytest.mark.parametrize(('waits', 'owed'), [
    ((1, IDLE['a queue']), []), ((1, OWED['a lock']), [0, 1]), ((1, 2, IDLE['an event']), []), ((1, 0), [0, 1]),
    ((1, 2, 1), [0, 1, 2])], ids=['idle', 'stuck', 'idle one after the other', 'each other', 'round a circle'])
def test_who_waits_for_the_end_of_a_thread_is_owed_what_that_one_is(program, waits, owed):
    made = [join(program, wait) if isinstance(wait, int) else wait for wait in waits]
    found = owed_and_idle(program, *made)
    assert found[0] == ['thread {}'.format(number) for number in owed]


def test_the_end_of_a_thread_that_spins_is_not_owed(program):
    assert owed_and_idle(program, join(program, 1), lambda: program.scheduler.wait(kind=None))[0] == []


def test_all_threads_are_let_go_in_the_end(program):
    ended = []

    def wait():
        with pytest.raises(TurnLost):
            wait_for_condition()
        ended.append(True)
    owed_and_idle(program, wait)
    assert ended
