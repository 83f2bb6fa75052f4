"""The warm process of a worker: it has imported all, and forks a process for each trial. It has one thread.

    python3 -m move_base_abstract_experiments.warm SOCKET_DESCRIPTOR

A request on the socket is a line of JSON, {"job": ..., "path": ...}; the answer is a line as well, when the trial's
process has ended: {"code": 0}. What the trial has to say is in its folder. When the other end of the socket is closed,
because the worker has ended in whatever way, the trial is ended and its folder removed.
"""
import gc
import importlib
import json
import os
import select
import shutil
import signal
import socket
import sys

from move_base_abstract.errors import ConfigurationError
from move_base_abstract_ros.launching import look_ups, processes, warm_nodes

from . import functions, launch_files, temporary

_HASH_SEED = 'PYTHONHASHSEED'
READY = b'ready\n'


def main(words):
    """Serve until the socket is closed."""
    from move_base_abstract_ros import replaced
    from move_base_abstract_ros.lockstep import address_layout, native_library
    is_new = address_layout.choose(os.environ)
    is_new = is_new or _HASH_SEED not in os.environ or any(os.environ.get(name) != value for name, value in
                                                           warm_nodes.ONE_THREAD.items())
    if (is_new or not native_library.is_loaded()) and native_library.preload(os.environ) or is_new:
        # Once: with one order of sets, one layout of memory and one library in front of libc, as the launcher does it.
        os.environ.setdefault(_HASH_SEED, '0')
        os.environ.update(warm_nodes.ONE_THREAD)
        os.execv(sys.executable, [sys.executable, '-m', __spec__.name, *words])
    processes.keep_memory()
    for name in warm_nodes.MODULES:
        importlib.import_module(name)
    from . import trial  # noqa: F401 - for the forks
    launch_files.core()
    look_ups.remember()
    replaced.look_up()
    warm_nodes.log_settings()
    _share()
    processes.assert_one_thread()
    processes.adopt_orphans()
    with temporary.folder('move_base_abstract_trials_') as folder:
        try:
            with socket.socket(fileno=int(words[0])) as client:
                _serve(client, folder)
        finally:
            processes.end_all_children()


def _serve(client, folder):
    wake, woken = os.pipe()
    os.set_blocking(wake, False)
    os.set_blocking(woken, False)
    signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
    signal.set_wakeup_fd(woken, warn_on_full_buffer=False)
    client.sendall(READY)
    count, problems = 0, {}
    with client.makefile('rb') as requests:
        for line in requests:
            count += 1
            path = os.path.join(folder, f'{count:06d}')
            os.mkdir(path)
            job = functions.place(json.loads(line), folder)
            problem = _prepare(job, problems)
            pid = processes.fork(lambda job=job, path=path, problem=problem: _carry_out(job, path, problem, (
                client.fileno(), wake, woken)),
                                 os.path.join(path, 'trial.txt'), new_session=True)
            code = _await(pid, client, wake)
            processes.end_all_children()
            if code is None:
                return
            client.sendall(json.dumps({'code': code, 'path': path}).encode() + b'\n')
            if requests.readline() != b'taken\n':
                return
            launch_files.load_programs(path)
            shutil.rmtree(path, ignore_errors=True)


def _prepare(job, problems):
    """Call the function that a job wants called in this process, once; return what is wrong with it, or None."""
    if not job['prepare']:
        return None
    key = json.dumps([job['prepare'], job['modules']])
    if key not in problems:
        problems[key] = None
        try:
            functions.prepare(job['prepare'], job['modules'])
        except ConfigurationError as problem:
            problems[key] = str(problem)
        _share()
    return problems[key]


def _share():
    """Have no collection in a fork touch, and so copy, what there is now."""
    gc.collect()
    gc.freeze()


def _carry_out(job, path, problem, descriptors):
    from . import trial
    for descriptor in descriptors:
        os.close(descriptor)
    trial.carry_out(job, path, problem)


def _await(pid, client, wake):
    """Return the exit code of the trial's process, or None if the worker has gone."""
    while True:
        ready, _, _ = select.select([client, wake], [], [])
        if client in ready:  # nobody says anything meanwhile: it is closed
            return None
        try:
            while os.read(wake, 512):
                pass
        except BlockingIOError:
            pass
        found, status = os.waitpid(pid, os.WNOHANG)
        if found:
            return processes.code_of(status)


if __name__ == '__main__':
    main(sys.argv[1:])
