"""What lockstep_launch shows of its nodes, and when it goes on."""
import os
import subprocess

from move_base_abstract_ros.launching import outputs
from move_base_abstract_ros.launching.scripted import rostest_case

MOST = outputs._MOST_PIECES * outputs._PIECE


def screen(tmp_path):
    """Return a Screen, and the output of a process on it whose pipe is there."""
    made = outputs.Screen(str(tmp_path))
    one = made.of('/node')
    one.prepare()
    return made, one


def test_a_node_that_prints_without_an_end_does_not_keep_the_run(tmp_path, capfdbinary):
    made, one = screen(tmp_path)
    with subprocess.Popen(['yes', 'more'], stdout=one._write) as process:
        made.pause(10.0)
        process.kill()
    assert 0 < len(capfdbinary.readouterr().err) <= MOST
    assert set(one.printed()) == {'more'}


def test_a_line_without_an_end_is_taken_in_parts(tmp_path):
    made, one = screen(tmp_path)
    for _ in range(5):
        one.take(b'x' * (outputs._LONGEST_LINE // 2))
    assert [len(line) for line in one.printed()] == [outputs._LONGEST_LINE] * 2
    one.take(b'\nlast')
    one.take(b'')
    assert one.printed()[-2:] == ('x' * (outputs._LONGEST_LINE // 2), 'last')


def test_what_an_ended_process_has_printed_is_shown(tmp_path):
    made, one = screen(tmp_path)
    os.write(one._write, b'a\nb')
    os.close(one._write)
    made.pause(0.0)
    assert one.printed() == ('a', 'b') and not made._pipes


def test_a_rostest_has_a_case_for_each_property_that_was_judged_and_for_each_that_is_broken():
    broken = {'property': 'every_goal_ends', 'node': 'a', 'text': 'never', 'words': 'every_goal_ends: a: never'}
    told = {'judged': [], 'broken': [broken], 'statements': [['/a', 'always', 'one owner', 'held']]}
    assert list(rostest_case._cases(told).values()) == [broken['words']]
    judged = rostest_case._cases({**told, 'judged': ['always', 'no_crash', 'every_goal_ends']})
    assert [problem for problem in judged.values() if problem] == [broken['words']]
    assert 'always: /a: one owner' in judged and len(judged) == 3
