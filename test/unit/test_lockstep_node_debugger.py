"""pdb in a program as lockstep compiles it: where it stops and steps, and what it shows; without ROS."""
import threading

import pytest

from move_base_abstract.lockstep.call_rewriting import HASHED
from move_base_abstract.lockstep.instrument import LOOK
from move_base_abstract.lockstep.object_order import BASES
from move_base_abstract.lockstep.stable_hash import Numbered
from move_base_abstract_ros.lockstep.code.own_code import OWN, compile_own
from move_base_abstract_ros.lockstep.debugging.node_debugger import NodeDebugger

LOOP = """def wait(flags):
    while not flags['is_there']:
        pass
    return 3

n = wait(Flags(3))
n += 1
"""
#: the functions that lockstep adds, in a file of ours
ADDED = """def look(kind, line):
    pass
def bases_of(*bases):
    return bases
def hashed(value):
    return value
"""
#: what the launcher does, in a file of ours
MAIN = """def run():
    begin()
    exec(code, names)
"""


class Typed:
    """Stands in for the link: lines to be typed, and all that is sent."""

    def __init__(self, lines):
        self.lines, self.sent, self.shown = list(lines), [], ''

    def send(self, word, **values):
        self.sent.append((word, values))

    def write(self, text):
        self.shown += text

    def flush(self):
        pass

    def readline(self):
        return self.lines.pop(0) + '\n' if self.lines else ''

    def told(self, word):
        return [values for kind, values in self.sent if kind == word]

    @property
    def stops(self):
        return [values['line'] for values in self.told('stopped')]


class Flags:
    """Is there after ``count`` looks."""

    def __init__(self, count):
        self.count = count

    def __getitem__(self, _name):
        self.count -= 1
        return self.count < 0


@pytest.fixture
def debug(tmp_path, monkeypatch):
    """Give debug(source, lines, places, **names), which runs a program in a thread, and returns what was told."""
    added = {}
    exec(compile(ADDED, OWN[0] + 'added.py', 'exec'), added)
    for name, function in ((LOOK, 'look'), (BASES, 'bases_of'), (HASHED, 'hashed')):
        monkeypatch.setattr('builtins.' + name, added[function], raising=False)
    looks = []

    def run(source, lines=(), places=(), is_wanted=False, **names):
        path = tmp_path / 'program.py'
        path.write_text(source)
        link = Typed(lines)
        one = NodeDebugger(link, looks.append, dict)
        one.set_places([('program.py', line) for line in places])
        if is_wanted:
            one.stop_at_next_line()
        names.update(__name__='__main__', Flags=Flags, debugger=one)

        main = {'begin': one.turn_begins, 'code': compile_own(source, str(path)), 'names': names}
        exec(compile(MAIN, OWN[0] + 'launches.py', 'exec'), main)
        thread = threading.Thread(target=main['run'])
        thread.start()
        thread.join()
        link.names = names
        return link
    yield run
    assert looks in ([], [True, False] * (len(looks) // 2))


def test_a_loop_that_waits_stops_once_at_its_line_in_each_pass(debug):
    assert debug(LOOP, ['continue'] * 4, [2]).stops == [2] * 4
    assert debug(LOOP, ['clear', *['next'] * 9, 'continue'], [2]).stops == [2, 3, 2, 3, 2, 3, 2, 4, 4, 7]


def test_steps_enter_what_the_program_calls_and_not_what_lockstep_adds(debug):
    program = 'from shlex import quote\ndef say(x):\n    return quote("a/b")\nclass A:\n    pass\n' \
              'y = say(hash(A()))\nz = y\n'
    told = debug(program, [*['step'] * 7, 'return', *['step'] * 5, 'continue'], [6]).told('stopped')
    places = [(values['file'].rpartition('/')[2], values['function']) for values in told]
    assert {place for place in places if place[0] != 'program.py'} == {('shlex.py', 'quote')}
    assert ('program.py', 'say') in places and told[-1]['line'] == 7


def test_a_breakpoint_in_a_thread_that_began_before_it_is_met_at_its_next_turn(debug):
    program = 'def f():\n    x = 1\n    debugger.set_places([("program.py", 5)])\n    debugger.turn_begins()\n' \
              '    return x\nf()\n'
    assert debug(program, ['p x', 'continue']).stops == [5]


def test_quit_and_the_end_of_what_is_typed_stop_nowhere_any_more(debug):
    program = 'for n in range(5):\n    m = n\nlast = m\n'
    for lines in (['quit'], ['q'], ['exit'], []):
        link = debug(program, lines, [2])
        assert link.stops == [2]
        assert link.names['last'] == 4
        assert link.told('left') == [{}]


def test_what_only_looks_gives_no_numbers_and_what_changes_the_run_is_told_once(debug):
    program = 'one, two = Robot(), Robot()\nx = 0\nfirst = hash(two), hash(one)\n'

    class Robot(Numbered):
        __slots__ = ('__weakref__',)
    looked = debug(program, ['p one', 'p {one, two}', 'pp [one]', 'where', 'list', 'args', 'x'], [2], Robot=Robot)
    assert looked.told('touched') == []
    first, second = looked.names['first']
    assert second == first + 1
    changed = debug(program, ['p x', '!x = 7', 'p debugger.canonic("")', 'continue'], [3], Robot=Robot)
    assert [values['text'].split(' was')[0] for values in changed.told('touched')] == ["'!x = 7'"]
    assert changed.names['x'] == 7
    for line in ('jump 1', 'condition 1 x.pop()', 'break 3, f()', 'x += 1', 'p f()', 'display f()'):
        assert len(debug(program, [line, 'quit'], [3], Robot=Robot).told('touched')) == 1, line


def test_commands_that_need_a_terminal_are_refused_and_nothing_waits_for_one(debug):
    shown = debug('x = 1\ny = 2\n', ['interact', 'run', 'restart', 'debug x', 'clear', 'p x', 'continue'], [2]).shown
    assert shown.count('not in a run') == 4
    assert shown.count('1\n') == 1


def test_a_wish_to_stop_ends_at_the_next_line_of_the_program(debug):
    generated = {}
    exec(compile('def call(function):\n    function()\n', '<string>', 'exec'), generated)
    program = 'def f():\n    return 1\ndebugger.stop_at_next_line()\ndebugger.turn_begins()\ncall(f)\nx = 1\n'
    assert debug(program, [*['step'] * 9, 'quit'], call=generated['call']).stops[:3] == [5, 1, 2]



def test_frames_of_lockstep_are_shown_if_they_are_asked_for(debug):
    lines = ['where', 'frames all', 'where', 'frames some', 'frames own', 'where', 'continue']
    shown = debug('def f():\n    return 2\nf()\n', lines, [2]).shown.split('(Pdb) ')
    assert shown[1] == shown[6]
    assert 'launches.py' not in shown[1] and 'threading.py' not in shown[1] and '(3)<module>()' in shown[1]
    assert 'launches.py' in shown[3] and 'threading.py' in shown[3]
    assert shown[4] == "frames: got 'some'; allowed: all, own\n"
