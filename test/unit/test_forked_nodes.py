"""Nodes that are forks of the process that starts them are as if they had been started: users' programs say so."""
import json
import os
import subprocess
import sys
import textwrap

import pytest

RELAY = '#!{}\nfrom move_base_abstract_ros.nodes import start\n\nstart("lockstep_launcher")\n'
PROBE = """
import faulthandler, io, json, multiprocessing, os, random, signal, sys, tempfile, threading
from multiprocessing import process
import helper, roslaunch

def inputs():
    names = ('stdin', 'stdout', 'stderr')
    return [[one.name, one.mode, one.line_buffering, name != 'stdin' and one.write_through, one.encoding,
             one.errors, one.isatty(), type(one.buffer).__name__, getattr(sys, '__%s__' % name) is one]
            for name, one in ((name, getattr(sys, name)) for name in names)]

def square(number):
    return number * number

if __name__ == '__main__':
    spawn = multiprocessing.get_context('spawn')
    with spawn.Pool(1) as pool:
        squares = pool.map(square, [3])
    main = sys.modules['__main__']
    facts = {
        'argv': sys.argv, 'kept': roslaunch.main.__defaults__, 'original': getattr(sys, 'orig_argv', None),
        'path': sys.path, 'executable': sys.executable,
        'flags': list(sys.flags), 'prefix': sys.prefix, 'main': [main.__name__, main.__file__, sorted(vars(main))],
        'environment': {name: one for name, one in os.environ.items() if name != 'ROS_PYTHON_LOG_CONFIG_FILE'},
        'cwd': [os.getcwd(), process.ORIGINAL_DIR], 'umask': os.umask(0), 'helper': helper.__file__,
        'signals': [str(signal.getsignal(number)) for number in sorted(signal.Signals) if number not in (9, 19)],
        'mask': sorted(signal.pthread_sigmask(signal.SIG_BLOCK, ())), 'streams': inputs(), 'squares': squares,
        'inherited': [name for name in os.listdir('/proc/self/fd') if int(name) > 2
                      and os.path.exists('/proc/self/fd/' + name) and 'socket' in os.readlink('/proc/self/fd/' + name)],
        'leads': [os.getpid() == os.getpgid(0), os.getpid() == os.getsid(0)], 'parent': os.getppid(),
        'temporary': tempfile.gettempdir(), 'threads': threading.active_count(), 'fault': faulthandler.is_enabled(),
        'shown': open('/proc/self/cmdline').read().rstrip(chr(0)), 'name': open('/proc/self/comm').read(),
        'hash': hash('text')}
    unclosed = open('unclosed.txt', 'w')
    unclosed.write('kept')
    print(json.dumps(facts))
"""
#: starts a command line twice, as a fork and as a program; prints [exit code, whether the process is a fork] of both
STARTER = """
import json, os, sys
from move_base_abstract.common import processes
from move_base_abstract_ros.launching import warm_nodes
warm_nodes.start_again()
words, environment, folder, launcher, uses = json.loads(sys.argv[1])
warm_nodes.be_ready([uses], os.path.dirname(launcher))
import roslaunch  # one of its functions keeps sys.argv from here on
told = []
for way in ('fork', 'program'):
    def enter():
        for target, name in ((1, 'output'), (2, 'errors')):
            os.dup2(os.open(os.path.join(folder, name + '_of_' + way), os.O_WRONLY | os.O_CREAT), target)
    pid = warm_nodes.start(words, environment, enter, os.path.join(folder, 'user'), launcher, way == 'fork')
    told.append(processes.code_of(os.waitpid(pid, 0)[1]))
    if os.path.exists(os.path.join(folder, 'user', 'unclosed.txt')):
        os.rename(os.path.join(folder, 'user', 'unclosed.txt'), os.path.join(folder, 'unclosed_of_' + way))
print(json.dumps(told))
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with our launcher, a starter, and a user's program with a module of its own."""
    for path, text in (('lib/lockstep', RELAY.format(sys.executable)), ('lib/uses.py', 'import actionlib\n'),
                       ('user/helper.py', ''), ('starter.py', STARTER)):
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    (tmp_path / 'lib' / 'lockstep').chmod(0o755)
    return tmp_path


def run(folder, text, first='#!/usr/bin/env python3', **more):
    """Return (output, errors, exit code) of a program that was started as a fork, and as a program."""
    path = folder / 'user' / 'program.py'
    path.write_text(first + '\n' + textwrap.dedent(text))
    path.chmod(0o755)
    launcher = str(folder / 'lib' / 'lockstep')
    words = [launcher, '--seed', '3', str(path), 'a word', '__name:=node']
    own = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path))}
    environment = {**own, 'TMPDIR': str(folder / 'user'), 'USERS': 'own', 'PYTHONHASHSEED': '0', **more}
    asked = json.dumps([words, environment, str(folder), launcher, str(folder / 'lib' / 'uses.py')])
    codes = json.loads(subprocess.run([sys.executable, str(folder / 'starter.py'), asked], stdout=subprocess.PIPE,
                                      timeout=60, check=True, env=own).stdout)
    return [((folder / f'output_of_{way}').read_text(), (folder / f'errors_of_{way}').read_text(), code)
            for way, code in zip(('fork', 'program'), codes)]


@pytest.mark.parametrize('unbuffered', ['', '1'])
def test_a_program_finds_what_it_would_find_in_a_python_of_its_own(folder, unbuffered):
    told = []
    for output, errors, code in run(folder, PROBE, PYTHONUNBUFFERED=unbuffered):
        assert (errors, code) == ('', 0)
        told.append(json.loads(output))
    assert told[0] == told[1]
    assert [(folder / f'unclosed_of_{way}').read_text() for way in ('fork', 'program')] == ['kept', 'kept']


def test_libraries_in_c_are_seen_to_in_a_fork_that_is_not_started_again_for_it(folder):
    fork, program = run(folder, """
    import os, sys
    print(any('python_shim' in line for line in open('/proc/self/maps')), 'LD_PRELOAD' in os.environ,
          'move_base_abstract_ros.launching.warm_nodes' in sys.modules)
    """)
    assert (fork, program) == (('True False True\n', '', 0), ('True False False\n', '', 0))


@pytest.mark.parametrize('text, code', [
    ('import sys\nsys.exit(3)', 3), ('raise ValueError("bad")', 1), ('import os\nos.kill(os.getpid(), 9)', -9),
    ('import sys\nsys.exit("said")', 1),
    ('class Last:\n    def __del__(self):\n        print("destroyed", flush=True)\nlast = Last()', 0)])
def test_its_end_is_that_of_a_program(folder, text, code):
    fork, program = run(folder, text)
    assert fork == (*program[:2], code) == program


def test_a_module_beside_the_program_is_its_own_whatever_is_imported_already(folder):
    (folder / 'user' / 'actionlib.py').write_text('own = True')
    fork, _ = run(folder, 'import actionlib\nprint(actionlib.__file__)')
    assert fork == (str(folder / 'user' / 'actionlib.py') + '\n', '', 0)


def test_an_environment_of_another_python_is_served_by_that(folder):
    venv = folder / 'venv'
    (venv / 'bin').mkdir(parents=True)
    (venv / 'bin' / 'python3').symlink_to(sys.executable)
    (venv / 'pyvenv.cfg').write_text('home = {}\ninclude-system-site-packages = true\n'.format(
        os.path.dirname(os.path.realpath(sys.executable))))
    fork, _ = run(folder, 'import sys\nprint(sys.prefix)', '#!{}/bin/python3'.format(venv))
    assert fork == (str(venv) + '\n', '', 0)


@pytest.mark.parametrize('name, value, told', [
    pytest.param('PYTHONOPTIMIZE', '1', '[1, 1]', marks=pytest.mark.night),  # all modules are compiled for it
    ('PYTHONHASHSEED', '7', '[0, 1]'), ('OPENBLAS_NUM_THREADS', '2', '[0, 1]')])
def test_what_only_a_start_can_give_is_given_by_a_start(folder, name, value, told):
    text = 'import os, sys\nprint([sys.flags.optimize, int(os.environ[{!r}] == {!r})], hash("text"))'
    fork, program = run(folder, text.format(name, value), **{name: value})
    assert fork == program
    assert fork[0].startswith(told)
