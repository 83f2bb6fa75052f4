"""Processes of a run: what ends is noted, and nothing is left. Each in a Python of its own, as they fork."""
import subprocess
import sys
from pathlib import Path

SOURCE = str(Path(__file__).resolve().parents[2] / 'src')


def run(text):
    done = subprocess.run([sys.executable, '-c', 'import os, signal, sys\nsys.path.insert(0, {!r})\n'
                           'from move_base_abstract.common import processes\n'.format(SOURCE) + text],
                          stdout=subprocess.PIPE, timeout=60, check=True)
    return done.stdout.decode().split()


def test_who_ends_while_another_one_is_ended_is_noted():
    assert run("""
processes.block_child_signal()
first = processes.fork(lambda: sys.exit(3))
second = processes.fork(signal.pause)
statuses = {}
processes.end([second], signal.SIGKILL, 30.0, statuses)
processes.await_ends({first}, 30.0, statuses)
print(processes.code_of(statuses[first]), processes.code_of(statuses[second]))
""") == ['3', '-9']


def test_children_of_children_are_ended_too():
    assert run("""
processes.adopt_orphans()
read, write = os.pipe()
def leave_one():
    if os.fork() == 0:
        os.setsid()
        os.write(write, b'x')
        signal.pause()
processes.fork(leave_one)
os.close(write)
os.read(read, 1)
processes.end_all_children()
print(os.read(read, 1) == b'')
""") == ['True']


def test_a_node_is_waited_for_until_the_ros_master_knows_it_or_it_has_ended():
    assert run("""
from types import SimpleNamespace
from move_base_abstract_ros.launching import ros_master
answers = []
def lookup(caller, name):
    answers.append(name)
    return (1 if name == '/there' and len(answers) > 2 else -1), '', ''
ros_master.xmlrpc.client.ServerProxy = lambda uri, **_: SimpleNamespace(lookupNode=lookup)
processes.block_child_signal()
statuses = {}
ros_master.await_registered('', processes.fork(signal.pause), '/there', statuses)
print(len(answers), statuses)
first = processes.fork(lambda: sys.exit(3))
ros_master.await_registered('', first, '/gone', statuses)
print(processes.code_of(statuses[first]))
processes.end_all_children()
""") == ['3', '{}', '3']


def test_who_is_there_is_not_asked_without_end_of_a_ros_master_that_has_gone():
    assert run("""
os.environ.update(processes.ONE_THREAD, ROS_MASTER_URI='http://127.0.0.1:9/')
from move_base_abstract_ros.launching import run
run._BEFORE_START_S = 0.5
processes.block_child_signal()
statuses = {}
print(run._not_there_yet(statuses), *map(processes.code_of, statuses.values()))
""") == ['None', '-9']


def test_an_interrupt_at_a_fork_is_not_lost():
    assert run("""
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
os.register_at_fork(before=lambda: os.kill(os.getpid(), signal.SIGINT))
try:
    processes.fork(lambda: None)
    print('lost')
except KeyboardInterrupt:
    print('interrupted')
""") == ['interrupted']


def test_a_second_thread_at_a_fork_is_an_error():
    assert run("""
import threading
threading.Thread(target=signal.pause, daemon=True).start()
try:
    processes.fork(lambda: None)
except RuntimeError as error:
    print(str(error).split()[0])
""") == ['2']


def test_freed_memory_is_kept():
    assert run("""
import resource
def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(50):
        [bytearray(2000000) for _ in range(8)]
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before
processes.keep_memory()
faults()
print(faults() < 5000)
""") == ['True']


def test_rospy_has_a_last_word_where_there_is_a_node_only():
    assert run("""
import atexit, types
core = sys.modules['rospy.core'] = types.ModuleType('rospy.core')
core._ros_atexit = lambda: print('node:', core.is_initialized(), flush=True)
atexit.register(core._ros_atexit)
for is_node in (False, True):
    core.is_initialized = lambda: is_node
    os.waitpid(processes.fork(lambda: None), 0)
atexit.unregister(core._ros_atexit)
""") == ['node:', 'True']


def test_a_child_that_has_ended_keeps_its_number_until_it_is_released_and_then_gets_no_signal():
    assert run("""
import posix, subprocess
leaves_one = 'import os, signal\\nos.fork() == 0 and signal.pause()\\nos._exit(3)'
read, write = os.pipe()
for start in (lambda: processes.Forked(processes.fork(lambda: sys.exit(3))), lambda: subprocess.Popen(
        [sys.executable, '-c', leaves_one], start_new_session=True, pass_fds=[write])):
    child = processes.Held(start())
    print(child.wait(60), child.poll(), child.returncode, len(processes.children()))
    child.signal_group(signal.SIGKILL)
    child.send_signal(signal.SIGKILL)
    child.release()
    print(child.returncode, processes.children())
    os.kill = os.killpg = lambda pid, number: print('reached', pid)
    child.signal_group(signal.SIGKILL)
    child.kill()
    child.release()
    os.kill, os.killpg = posix.kill, posix.killpg
os.close(write)
print(os.read(read, 1))  # what the second one had left in its group is gone
""") == ['3', '3', '3', '1', '3', '[]'] * 2 + ["b''"]


def test_no_signal_is_sent_to_a_number_whose_child_has_ended():
    assert run("""
processes.block_child_signal()
stranger = processes.fork(signal.pause)  # who has got the number
processes.end([stranger], signal.SIGTERM, 0.0, {stranger: 0})
os.kill(stranger, signal.SIGUSR1)
print(processes.code_of(os.waitpid(stranger, 0)[1]) == -signal.SIGUSR1)
""") == ['True']
