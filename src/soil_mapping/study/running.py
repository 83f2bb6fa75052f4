"""Where trials run: each in a child process of its own, forked from one that has imported all and made the field.

A node can be initialised once per process, and importing takes longer than a trial. The child is killed by the kernel
when this process ends, and so are the nodes that it has started.
"""

import contextlib
import ctypes
import importlib
import multiprocessing
import os
import signal
import subprocess
import sys
import time
import traceback
from multiprocessing import connection

from soil_mapping.coordinator import Coordinator
from soil_mapping.trial_folder import TrialFolder, is_complete, read_about

from .truth import truth_of

PR_SET_PDEATHSIG = 1
HEAVY = {'ros': ('soil_mapping.study.ros_trial', 'pykrige.ok'), 'mesa': ('soil_mapping.mesa_model', 'pykrige.ok')}
POLL_S = 0.5  # wall; how often a trial that would never end is looked for
GUARD_S = 300.0  # wall, on top of what the clock needs; only ends a trial that would never end
_FORK = multiprocessing.get_context('fork')


def prepare(specs):
    """Import what the trials of TrialSpecs need and make their fields, once for all."""
    for engine in sorted({spec.engine for spec in specs}):
        for module in HEAVY[engine]:
            importlib.import_module(module)
    for spec in specs:
        Coordinator(spec.config, spec.seed, truth_of(spec.config))  # what cannot be is refused before a node is started


def is_done(spec, path):
    """Return whether the folder holds a complete trial of a TrialSpec."""
    try:
        return is_complete(path) and spec.is_of(read_about(path))
    except (OSError, ValueError, KeyError):
        return False


class RunningTrial:
    """A trial under way in a child process.

    spec: the TrialSpec. path: the folder to be (a Path). pictures, bag: whether to draw and to record.
    """

    def __init__(self, spec, path, pictures=False, bag=False):
        self.spec = spec
        self.path = path
        self._deadline = time.monotonic() + GUARD_S + 2.0 * _expected_s(spec)
        self._process = _FORK.Process(target=_run, args=(os.getpid(), spec, path, pictures, bag), daemon=False)
        self._process.start()

    @property
    def sentinel(self):
        """Becomes ready when the child ends (for multiprocessing.connection.wait)."""
        return self._process.sentinel

    def poll(self):
        """Return None while it runs, else whether the trial is complete."""
        if self._process.is_alive():
            if time.monotonic() < self._deadline:
                return None
            self.kill()
        self._process.join()
        return self._process.exitcode == 0 and is_done(self.spec, self.path)

    def wait(self):
        """Wait for the end and return whether the trial is complete; if interrupted, end the child."""
        try:
            while self.poll() is None:
                connection.wait([self.sentinel], POLL_S)
        finally:
            self.kill()
        return self.poll()

    def kill(self):
        """End the child at once; the kernel ends its nodes."""
        self._process.kill()
        self._process.join()

    @property
    def error(self):
        """What went wrong, in a few lines."""
        text = self.path.with_name(self.path.name + '.unfinished') / 'error.txt'
        with contextlib.suppress(OSError):
            return text.read_text(encoding='utf-8')
        return f'its process ended with code {self._process.exitcode}'


def _expected_s(spec):
    """Return how long the clock alone takes [wall s]."""
    if spec.engine == 'mesa':
        return 0.0
    speed = spec.factor if spec.clock == 'scaled' else spec.limit
    return spec.config.budget_s / speed if speed else 0.0


def _run(parent, spec, path, pictures, bag):
    """The life of the child; it never returns."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)  # it died before the line above
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    code = 1
    try:
        run_trial(spec, path, pictures, bag)
        code = 0
    except BaseException as error:
        _note_error(path, error)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)  # rospy's own end takes half a second and tells a master that has gone


def _note_error(path, error):
    with contextlib.suppress(OSError):
        folder = path.with_name(path.name + '.unfinished')
        folder.mkdir(parents=True, exist_ok=True)
        lines = [f'{type(error).__name__}: {error}\n\n', *traceback.format_exception(error)]
        (folder / 'error.txt').write_text(''.join(lines), encoding='utf-8')


def run_trial(spec, path, pictures=False, bag=False):
    """Run a trial in this process and write its folder; for ROS the process can run no other after it."""
    with TrialFolder(path) as folder, _load(spec.load):
        if spec.engine == 'mesa':
            from soil_mapping.mesa_model import run_mesa_trial
            result = run_mesa_trial(spec.config, spec.seed, spec.motion, truth_of(spec.config))
        else:
            from .ros_trial import run_ros_trial
            result = run_ros_trial(spec, folder.path, bag)
        folder.finish(result, pictures)


@contextlib.contextmanager
def _load(count):
    """Keep so many cores busy meanwhile."""
    guard = ['setpriv', '--pdeathsig', 'KILL', '--']
    busy = [subprocess.Popen([*guard, sys.executable, '-c', 'while True: pass']) for _ in range(count)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()
