"""A source that goes on by itself: what is in its way, and that nothing else differs."""
import pytest

from lockstep_program import Program
from test_lockstep_scheduler import Source


@pytest.mark.parametrize('with_condition', [False, True])
def test_a_source_that_goes_on_by_itself_does_nothing_before_what_else_is_due(with_condition):
    def run(goes_on_by_itself):
        program = Program()
        gone = []

        def goes_on_to(due_ns):
            if program.master.script and program.master.script[0][0] <= due_ns:
                return False
            gone.append(due_ns)
            program.scheduler.now_ns = due_ns
            return True

        if goes_on_by_itself:
            program.master.goes_on_to = goes_on_to
        source = Source(program, 1, 2, 3, 6, 7, 7, 9, 10, 12, 15)
        program.master.script = [(6, [program.sayer('mail')]), (11, [program.sayer('mail')])]
        program.scheduler.set_source(source)

        def sleeper():
            for pause in (2, 6, 5):  # with the source, between two of its events, and after one that is told by mail
                program.sleep(pause)
                program.say('sleeper')

        def main():
            program.thread('sleeper', sleeper)
            if with_condition:
                program.scheduler.wait_until(lambda: len(source.times) < 3)
                program.say('condition')
            program.scheduler.rest()
            program.say('rested')
        return program.run(main), gone, len(program.master.asked)

    trace, gone, asked = run(True)
    before, _, asked_before = run(False)
    assert trace == before
    assert asked == asked_before - len(gone)
    # Not where a thread that may be in the middle of a wait is the last one at an instant, nor while a condition waits.
    assert gone == ([12, 15] if with_condition else [1, 7, 10, 12, 15])
