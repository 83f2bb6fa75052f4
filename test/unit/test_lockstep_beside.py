"""Threads that wait for somebody outside, beside the others."""
import sys
import threading

from lockstep_program import GUARD, Program
from move_base_abstract.lockstep.beside import Beside


def test_who_is_let_go_holds_up_nobody_and_takes_the_turn_again_before_it_acts():
    program = Program()
    scheduler, begun, over = program.scheduler, threading.Event(), threading.Event()

    def waits():
        begun.set()
        over.wait(GUARD)  # in the kernel: not by the scheduler
        program.say('back')
        program.sleep(2)
        program.say('slept')

    def main():
        program.thread('waits', waits)
        program.sleep(5)
        program.say('main')
        over.set()
        while not scheduler.has_outside:
            pass
        program.sleep(3)

    def watch():
        begun.wait(GUARD)
        holder = scheduler.turn_ident
        assert not scheduler.let_go(holder, lambda: False)
        assert scheduler.turn_ident == holder and scheduler.let_go(holder, lambda: True)
        assert not scheduler.let_go(-1, lambda: True)
    watcher = threading.Thread(target=watch)
    watcher.start()
    assert program.run(main) == [('main', 5), ('back', 5), ('slept', 7)]
    watcher.join()


def test_who_stops_waiting_while_it_is_let_go_keeps_the_turn():
    program = Program()
    scheduler, begun, over = program.scheduler, threading.Event(), threading.Event()
    told = []

    def main():
        begun.set()
        over.wait(GUARD)  # in the kernel: not by the scheduler
        program.say('acts', scheduler.is_mine())
        program.sleep(1)

    def watch():
        def still_waits():
            over.set()
            while sys._current_frames()[holder].f_code is not Beside.comes_back.__code__:
                pass  # it acts, and so asks for the turn
            return False
        begun.wait(GUARD)
        holder = scheduler.turn_ident
        told.append(scheduler.let_go(holder, still_waits))
    watcher = threading.Thread(target=watch)
    watcher.start()
    assert program.run(main) == [('acts', True, 0)]
    watcher.join()
    assert told == [False]
