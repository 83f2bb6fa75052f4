"""Random programs of threads, messages and waits go the same way in every run, however the machine switches threads."""

import random
import sys

import pytest
from night import times

from lockstep_program import Program


class Chance:
    """A random program: threads that sleep, wake, wait, start others and are interrupted by messages that may block."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.program = Program()
        self.counter = 0
        self.waiting = []
        self.budget = 120

    def run(self):
        self.program.master.script = [
            (time_ns, [self.message(index, number) for number in range(self.random.randint(1, 3))])
            for index, time_ns in enumerate(sorted(self.random.randint(0, 40) for _ in range(12)))]
        self.program.run(lambda: self.live('main', 3))
        return self.program.trace

    def message(self, index, number):
        pause = self.random.choice((0, 0, 0, 1, 7))

        def handle():
            self.program.say('message', index, number)
            self.counter += 1
            if pause:
                self.program.sleep(pause)
                self.program.say('message ends', index, number)
        return handle

    def live(self, name, depth):
        for step in range(8):
            self.budget -= 1
            if self.budget < 0:
                return
            choice = self.random.randint(0, 5)
            self.program.say(name, step, choice)
            getattr(self, 'do_{}'.format(choice))(name, step, depth)
        self.program.say(name, 'ends')

    def do_0(self, _name, _step, _depth):
        self.program.sleep(self.random.choice((1, 2, 2, 5)))

    def do_1(self, name, step, depth):
        if depth:
            self.program.thread('t', self.live, '{}.{}'.format(name, step), depth - 1)

    def do_2(self, name, _step, _depth):
        self.waiting.append(self.program.scheduler.current())
        woken = self.program.scheduler.wait(self.program.scheduler.now_ns + self.random.randint(1, 9))
        self.program.say(name, 'woken' if woken else 'time is up')

    def do_3(self, _name, _step, _depth):
        while self.waiting:
            self.program.scheduler.wake(self.waiting.pop())

    def do_4(self, name, _step, _depth):
        wanted = self.counter + 2
        reached = self.program.scheduler.wait_until(lambda: self.counter >= wanted, self.program.scheduler.now_ns + 9)
        self.program.say(name, 'reached' if reached else 'not reached')

    def do_5(self, name, step, _depth):
        self.counter += 1
        self.program.scheduler.from_outside(self.program.sayer(name, 'posted', step))


@pytest.fixture
def _frequent_switches():
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.parametrize('seed', range(times(2, 6)))
def test_random_programs_go_the_same_way_in_fifty_runs(seed, _frequent_switches):
    first = Chance(seed).run()
    assert len(first) > 40
    for _ in range(49):
        assert Chance(seed).run() == first


def test_random_programs_differ():
    assert Chance(1).run() != Chance(2).run()
