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

from move_base_abstract.errors import ConfigurationError, SimulatorError
from move_base_abstract.own_files import whole_file
from soil_mapping.coordinator import Coordinator
from soil_mapping.trial_folder import TrialFolder, is_complete, read_about

from .truth import truth_of

PR_SET_PDEATHSIG = 1
HEAVY = {'ros': 'soil_mapping.study.ros_trial', 'mesa': 'soil_mapping.mesa_model'}
POLL_S = 0.5  # wall; how often a trial that would never end is looked for
RECORD_S = 30.0  # wall; so long an interrupted trial may write what it has, once its mission is over
MISSION_OVER, RECORDED, FAILED = 'mission over', 'recorded', 'failed'  # what the child tells
GUARD_S = 300.0  # wall, on top of what the clock needs; only ends a trial that would never end
_FORK = multiprocessing.get_context('fork')


def prepare(specs):
    """Import what the trials of TrialSpecs need and make their fields, once for all.

    :raises ConfigurationError: if a file that they read cannot be used.
    """
    for spec in specs:
        spec.inputs  # noqa: B018 - looked at, and kept
        truth_of(spec.config)
    for engine in sorted({spec.engine for spec in specs}):
        _import(engine, HEAVY[engine])
    for spec in specs:
        Coordinator(spec.config, spec.seed, truth_of(spec.config))  # what cannot be is refused before a node is started


def _import(engine, module):
    try:
        importlib.import_module(module)
    except ModuleNotFoundError as error:
        why = 'it needs Python 3.11; trials on ROS need none' if error.name == 'mesa' else 'see docs/soil_study_ros.md'
        raise ConfigurationError(f"engine '{engine}': {error.name} is not installed for {sys.executable} "
                                 f'({why})') from None


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
        self._news, tell = _FORK.Pipe(duplex=False)
        self._told = {}  # what the child has told, with its text
        self._process = _FORK.Process(target=_run, args=(os.getpid(), tell, spec, path, pictures, bag), daemon=False)
        self._process.start()
        tell.close()

    @property
    def sentinel(self):
        """Becomes ready when the child ends (for multiprocessing.connection.wait)."""
        return self._process.sentinel

    def poll(self):
        """Return None while it runs, else whether the trial is complete."""
        if self._process.is_alive():
            if time.monotonic() < self._deadline:
                return None
            self._told[FAILED] = 'it did not come to its end'
            self.kill()
        self._process.join()
        return self._process.exitcode == 0 and is_done(self.spec, self.path)

    def wait(self):
        """Wait for the end and return whether the trial is complete; if interrupted, end the child."""
        try:
            while self.poll() is None:
                connection.wait([self.sentinel], POLL_S)
        finally:
            self.stop()
        return self.poll()

    def stop(self):
        """End the child: at once, or where the mission is over when its record is complete; pictures may be missing.

        The kernel ends its nodes.
        """
        try:
            self._hear()
            deadline = time.monotonic() + RECORD_S
            while MISSION_OVER in self._told and not {RECORDED, FAILED} & set(self._told) and self._process.is_alive() \
                    and time.monotonic() < deadline:
                connection.wait([self.sentinel, self._news], POLL_S)
                self._hear()
        finally:
            self.kill()

    def kill(self):
        """End the child at once."""
        self._process.kill()
        self._process.join()

    def _hear(self):
        try:
            while self._news.poll():
                word, text = self._news.recv()
                self._told[word] = text
        except (EOFError, OSError):
            pass  # it has ended

    @property
    def error(self):
        """What went wrong, in a few lines."""
        self._hear()
        code = self._process.exitcode
        how = f'was killed by signal {signal.Signals(-code).name}' if code and code < 0 else f'ended with code {code}'
        return self._told.get(FAILED, f'its process {how}')


def _expected_s(spec):
    """Return how long the clock alone takes [wall s]."""
    if spec.engine == 'mesa':
        return 0.0
    speed = spec.factor if spec.clock == 'scaled' else spec.limit
    return spec.config.budget_s / speed if speed else 0.0


def _run(parent, tell, spec, path, pictures, bag):
    """The life of the child; it never returns."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)  # it died before the line above
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    code = 1
    try:
        run_trial(spec, path, pictures, bag, lambda word: tell.send((word, '')))
        code = 0
    except BaseException as error:
        tell.send((FAILED, _describe(error)))
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)  # rospy's own end takes half a second and tells a master that has gone


def _describe(error):
    """Return what is said of an error: of one that this package raises on purpose its text, else all that is known."""
    if isinstance(error, (SimulatorError, RuntimeError)) and str(error):
        return str(error)
    return ''.join(traceback.format_exception(error))


def run_trial(spec, path, pictures=False, bag=False, tell=lambda word: None):
    """Run a trial in this process and write its folder; for ROS the process can run no other after it.

    tell: called with MISSION_OVER and with RECORDED. An error is also written to error.txt in the unfinished folder.
    """
    inputs = spec.inputs
    with TrialFolder(path) as folder, _noted_errors(folder), _load(spec.load):
        if spec.engine == 'mesa':
            from soil_mapping.mesa_model import run_mesa_trial
            result = run_mesa_trial(spec.config, spec.seed, spec.motion, truth_of(spec.config), inputs=inputs)
            tell(MISSION_OVER)
        else:
            from .ros_trial import run_ros_trial
            result = run_ros_trial(spec, folder.path, bag, lambda: tell(MISSION_OVER))
        folder.finish(result, pictures, lambda: tell(RECORDED))


@contextlib.contextmanager
def _noted_errors(folder):
    """Write an error that ends a trial into the folder that it leaves, as well as that goes."""
    try:
        yield
    except BaseException as error:
        with contextlib.suppress(SimulatorError, OSError):
            if folder.path.is_dir():
                with whole_file(folder.path / 'error.txt', encoding='utf-8') as stream:
                    stream.write(''.join(traceback.format_exception(error)))
        raise


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
