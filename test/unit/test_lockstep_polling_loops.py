"""Loops that wait by looking: they give the turn away after so many looks, and what only looks is nothing that happens.

lockstep_program.py plays the time master.
"""
import pytest

from lockstep_program import Program
from move_base_abstract.lockstep import loops as module

STEP = 10


@pytest.fixture(autouse=True)
def _few_looks(monkeypatch):
    monkeypatch.setattr(module, 'LOOKS', 3)
    monkeypatch.setattr(module, 'TURNS_AGAIN', 2)


def test_time_goes_on_by_a_step_after_so_many_looks():
    program = Program()

    def main():
        for _ in range(7):
            program.scheduler.look(STEP)
            program.say('looks')
    assert [now_ns for _, now_ns in program.run(main)] == [0, 0, 10, 10, 10, 20, 20]


def test_what_is_looked_for_is_seen_at_its_instant():
    program = Program()
    flag = []
    program.master.script = [(4, [lambda: flag.append(True)])]

    def main():
        while not flag:
            program.scheduler.look(STEP)
        program.say('seen')
    assert program.run(main) == [('seen', 4)]


def test_two_that_only_look_let_time_go_on():
    program = Program()

    def look(name):
        while program.scheduler.now_ns < 30:
            program.scheduler.look(STEP)
        program.say(name)

    def main():
        program.thread('other', look, 'other')
        look('main')
    assert program.run(main) == [('other', 30), ('main', 30)]
    assert program.master.asked[:3] == [10, 20, 30]


def test_what_another_thread_did_before_it_began_to_look_is_seen():
    program = Program()
    flag = []

    def other():
        program.sleep(7)
        flag.append(True)
        while program.scheduler.now_ns < 30:
            program.scheduler.look(STEP)

    def main():
        program.thread('other', other)
        while not flag:
            program.scheduler.look(STEP)
        program.say('seen')
    assert program.run(main) == [('seen', 7)]


def test_who_does_something_has_all_its_looks_again():
    program = Program()

    def main():
        for _ in range(6):
            program.scheduler.look(STEP)
            program.scheduler.acts()
        program.say('main')
    assert program.run(main) == [('main', 0)]


def test_who_only_looks_once_in_each_message_is_not_held_up():
    program = Program()
    program.master.script = [(time, [lambda: (program.scheduler.look(STEP), program.say('heard'))])
                             for time in range(1, 9)]
    assert program.run(lambda: program.sleep(9)) == [('heard', time) for time in range(1, 9)]


def test_turns_are_counted_until_something_is_done():
    program = Program()
    counts = []

    def main():
        for number in range(5):
            task = program.scheduler.turn()
            counts.append((task.turns, task.idle_turns))
            if number == 2:
                program.scheduler.acts()
        program.sleep(1)
        counts.append(program.scheduler.turn().turns)
    program.run(main)
    assert counts == [(1, 1), (2, 2), (3, 3), (1, 1), (2, 2), 1]


def test_who_looks_away_goes_on_when_something_happens_or_a_step_later():
    program = Program()
    program.master.script = [(4, [lambda: None])]

    def main():
        for _ in range(2):
            program.scheduler.turn()
            program.scheduler.look_away(STEP)
            program.say('looks', program.scheduler.turn().turns)
    assert program.run(main) == [('looks', 1, 4), ('looks', 1, 14)]


def test_who_has_looked_away_needs_fewer_turns_until_it_does_something_else():
    program = Program()
    counts = []

    def main():
        program.scheduler.look_away(STEP)
        counts.append(program.scheduler.turn().idle_turns)
        program.scheduler.acts()
        counts.append(program.scheduler.turn().idle_turns)
        program.scheduler.look_away(STEP)
        program.sleep(1)
        counts.append(program.scheduler.turn().idle_turns)
    program.run(main)
    assert counts == [2, 1, 1]
