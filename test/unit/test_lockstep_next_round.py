"""What waits for another round of the time master's, or comes from outside and enters with it.

lockstep_program.py plays the time master.
"""

import threading

from lockstep_program import GUARD, Program


def test_a_round_of_the_same_instant_can_be_waited_for():
    program = Program((5, [lambda: program.say('mail')]))

    def main():
        program.thread('other', program.sleep, 3)
        program.scheduler.wait_round()
        program.say('a round later')
        program.sleep(5)
        program.say('main')
    assert program.run(main) == [('a round later', 0), ('mail', 5), ('main', 5)]
    assert program.master.asked[:2] == [0, 3]


def test_threads_that_wait_for_a_round_go_on_in_the_order_in_which_they_began_to_wait():
    program = Program()

    def other(name):
        program.scheduler.wait_round()
        program.say(name)

    def main():
        for name in ('a', 'b', 'c'):
            program.thread(name, other, name)
        program.scheduler.wait_round()
        program.say('main')
    assert program.run(main) == [('main', 0), ('a', 0), ('b', 0), ('c', 0)]


def test_what_comes_from_outside_knocks_and_enters_after_the_mail_of_the_next_round():
    program = Program()

    def main():
        outside = threading.Thread(target=program.scheduler.from_outside, args=(program.sayer('outside'),))
        outside.start()
        outside.join(GUARD)
        assert program.master.knocks == 1
        assert program.trace == []
        program.sleep(5)
        program.say('main')
    assert program.run(main) == [('outside', 0), ('main', 5)]


def test_what_comes_from_outside_enters_in_the_order_in_which_it_came_after_mail_and_before_those_who_wait():
    program = Program((0, [lambda: program.say('mail')]))

    def waits():
        program.scheduler.wait_round()
        program.say('a round later')

    def main():
        program.thread('waits', waits)
        program.sleep(0)
        for name in ('first', 'second', 'third'):
            program.scheduler.from_outside(program.sayer(name))
        program.master.knocks = 0  # so that the script's mail comes with the same grant
        program.sleep(5)
    assert program.run(main) == [('mail', 0), ('first', 0), ('second', 0), ('third', 0), ('a round later', 0)]
