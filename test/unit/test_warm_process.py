"""Programs that the warm process of lockstep_launch becomes are as if they had been started: users' programs say so."""
import json
import os
import signal
import socket
import subprocess
import sys
import textwrap

import pytest

from move_base_abstract.common import processes
from move_base_abstract_ros.launching import warm_client

RELAY = '#!{}\nfrom move_base_abstract_ros.nodes import start\n\nstart("lockstep_launcher")\n'
PROBE = """
import faulthandler, io, json, multiprocessing, os, random, signal, sys, tempfile, threading
from multiprocessing import process
import helper

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
        'argv': sys.argv, 'original': getattr(sys, 'orig_argv', None), 'path': sys.path, 'executable': sys.executable,
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


@pytest.fixture(scope='module')
def library(tmp_path_factory):
    """A folder with our launcher."""
    path = tmp_path_factory.mktemp('lib')
    (path / 'lockstep').write_text(RELAY.format(sys.executable))
    (path / 'lockstep').chmod(0o755)
    (path / 'uses.py').write_text('import actionlib\n')
    return path


@pytest.fixture(scope='module')
def warm(library):
    made = warm_client.WarmClient(str(library), False)
    made.prepare([str(library / 'uses.py')])
    yield made
    made.close()


@pytest.fixture
def own_warm(library):
    made = warm_client.WarmClient(str(library), False)
    made.prepare([])
    yield made
    made.close()


@pytest.fixture
def folder(tmp_path, library):
    """A folder with a user's program and a module of its own."""
    (tmp_path / 'lib').symlink_to(library)
    (tmp_path / 'user').mkdir()
    (tmp_path / 'user' / 'helper.py').write_text('')
    return tmp_path


def script(folder, text, first='#!/usr/bin/env python3'):
    path = folder / 'user' / 'program.py'
    path.write_text(first + '\n' + textwrap.dedent(text))
    path.chmod(0o755)
    return [str((folder / 'lib').resolve() / 'lockstep'), '--seed', '3', str(path), 'a word', '__name:=node']


def environment_of(folder, **more):
    return {**os.environ, 'TMPDIR': str(folder / 'user'), 'USERS': 'own', 'PYTHONHASHSEED': '0', **more}


def run(popen, folder, words, environment=None):
    """Return what a program printed, its errors and its exit code."""
    paths = [folder / 'output.txt', folder / 'errors.txt']
    with open(paths[0], 'wb') as output, open(paths[1], 'wb') as errors:
        process = popen(words, cwd=str(folder / 'user'), stdout=output, stderr=errors, close_fds=True,
                        env=environment or environment_of(folder), preexec_fn=os.setsid)
        code = process.wait(60)
    return paths[0].read_text(), paths[1].read_text(), code, isinstance(process, processes.Forked)


@pytest.mark.parametrize('unbuffered', ['', '1'])
def test_a_program_finds_what_it_would_find_in_a_python_of_its_own(folder, warm, unbuffered):
    words, environment = script(folder, PROBE), environment_of(folder, PYTHONUNBUFFERED=unbuffered)
    told = []
    for popen in (warm.popen, subprocess.Popen):
        output, errors, code, is_forked = run(popen, folder, words, environment)
        assert (errors, code, is_forked) == ('', 0, popen is not subprocess.Popen)
        assert (folder / 'user' / 'unclosed.txt').read_text() == 'kept'
        (folder / 'user' / 'unclosed.txt').unlink()
        told.append(json.loads(output))
    assert told[0] == told[1]
    assert told[0]['parent'] == os.getpid()


def test_libraries_in_c_are_seen_to_in_a_fork_that_is_not_started_again_for_it(folder, warm):
    words = script(folder, """
    import os, sys
    print(any('python_shim' in line for line in open('/proc/self/maps')), 'LD_PRELOAD' in os.environ,
          'move_base_abstract_ros.launching.warm_process' in sys.modules)
    """)
    assert run(warm.popen, folder, words)[:3] == ('True False True\n', '', 0)
    assert run(subprocess.Popen, folder, words)[:3] == ('True False False\n', '', 0)


@pytest.mark.parametrize('text, code', [
    ('import sys\nsys.exit(3)', 3), ('raise ValueError("bad")', 1), ('import os\nos.kill(os.getpid(), 9)', -9),
    ('import sys\nsys.exit("said")', 1)])
def test_its_end_is_that_of_a_program(folder, warm, text, code):
    words = script(folder, text)
    assert run(warm.popen, folder, words) == (*run(subprocess.Popen, folder, words)[:2], code, True)


def test_a_module_beside_the_program_is_its_own_whatever_is_imported_already(folder, warm):
    (folder / 'user' / 'actionlib.py').write_text('own = True')
    output, _, code, _ = run(warm.popen, folder, script(folder, 'import actionlib\nprint(actionlib.__file__)'))
    assert (output, code) == (str(folder / 'user' / 'actionlib.py') + '\n', 0)


def test_an_environment_of_another_python_is_served_by_that(folder, warm):
    venv = folder / 'venv'
    (venv / 'bin').mkdir(parents=True)
    (venv / 'bin' / 'python3').symlink_to(sys.executable)
    (venv / 'pyvenv.cfg').write_text('home = {}\ninclude-system-site-packages = true\n'.format(
        os.path.dirname(os.path.realpath(sys.executable))))
    words = script(folder, 'import sys\nprint(sys.prefix)', '#!{}/bin/python3'.format(venv))
    assert run(warm.popen, folder, words)[:3] == (str(venv) + '\n', '', 0)


@pytest.mark.parametrize('name, value, told', [
    pytest.param('PYTHONOPTIMIZE', '1', '[1, 1]', marks=pytest.mark.night),  # all modules are compiled for it
    ('PYTHONHASHSEED', '7', '[0, 1]'), ('OPENBLAS_NUM_THREADS', '2', '[0, 1]')])
def test_what_only_a_start_can_give_is_given_by_a_start(folder, warm, name, value, told):
    text = 'import os, sys\nprint([sys.flags.optimize, int(os.environ[{!r}] == {!r})], hash("text"))'
    words = script(folder, text.format(name, value))
    environment = environment_of(folder, **{name: value})
    output, errors, code, _ = run(warm.popen, folder, words, environment)
    assert (output, errors, code) == run(subprocess.Popen, folder, words, environment)[:3]
    assert output.startswith(told)


def test_time_limits_of_a_process_for_its_sockets_are_not_those_of_the_warm_process(folder, library):
    socket.setdefaulttimeout(0.001)  # rospy sets 60 s
    try:
        warm = warm_client.WarmClient(str(library), False)
    finally:
        socket.setdefaulttimeout(None)
    warm.prepare([])
    words = script(folder, 'import os\nprint(len(os.environ["LARGE"]))')
    environment = environment_of(folder, LARGE='x' * 1000000)  # more than can be sent at once
    assert run(warm.popen, folder, words, environment) == ('1000000\n', '', 0, True)
    warm.close()


def test_without_the_warm_process_programs_are_started(folder, own_warm):
    words = script(folder, 'print("here")')
    assert run(own_warm.popen, folder, words) == ('here\n', '', 0, True)
    os.kill(own_warm._process.pid, signal.SIGKILL)
    own_warm._process.wait()
    assert run(own_warm.popen, folder, words) == ('here\n', '', 0, False)


def test_what_it_has_started_goes_on_without_it_and_its_status_comes(folder, own_warm):
    os.mkfifo(str(folder / 'user' / 'gate'))
    words = script(folder, """
        open('gate').readline()
        raise SystemExit(5)""")
    process = own_warm.popen(words, cwd=str(folder / 'user'), stdout=None, stderr=None, close_fds=True,
                         env=environment_of(folder), preexec_fn=os.setsid)
    # Opened for both ways, it waits for nobody who may be dead.
    with open(str(folder / 'user' / 'gate'), 'r+b', buffering=0) as gate:
        own_warm.close()
        assert process.poll() is None
        gate.write(b'\n')
        assert process.wait(60) == 5
