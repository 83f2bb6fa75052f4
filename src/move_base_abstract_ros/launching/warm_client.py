"""Start Python nodes with the warm process (see warm_process). They start faster, and are otherwise the same.

If that process cannot be started, or has ended, nodes are started as usual.
"""
import os
import subprocess
import sys

from move_base_abstract.common import processes, sockets

from ..lockstep.programs import native_library
from . import request

_CODE = ('import sys; sys.path[0] = {!r}; from move_base_abstract_ros.launching.warm_process import main; '
         'become = main({}, {!r}, {}); become and become()')
_SPACE = ' ' * 4000  # room on the command line, in which each fork shows its own command line
_ANSWER_S = 30.0  # wall; a process that has not answered by then counts as ended


class WarmClient:
    """A warm process. Make it in the main thread, because the kernel ends the process with the thread."""

    def __init__(self, folder, has_master):
        """folder: that of this package's programs. has_master: whether the warm process starts a ROS master."""
        self._folder = folder
        self._socket, self._process = None, None
        processes.adopt_orphans()
        ours, its = sockets.pair()
        ours.settimeout(_ANSWER_S)
        code = _CODE.format(folder, its.fileno(), os.path.join(folder, 'lockstep'), has_master)
        environment = {'PYTHONHASHSEED': '0', **os.environ, **processes.ONE_THREAD}
        native_library.preload(environment)
        try:
            self._process = subprocess.Popen([sys.executable, '-c', code, _SPACE], env=environment,
                                             pass_fds=[its.fileno()])
            self._socket = ours
        except OSError:
            ours.close()
        its.close()

    def master(self):
        """Wait for the ROS master and return (processes.Forked, URI); None if there is none."""
        answer = self._answer()
        return None if answer is None else (processes.Forked(answer[0]), answer[1])

    def prepare(self, paths):
        """Import what the scripts at ``paths`` import, in the warm process. Call this before the first popen()."""
        try:
            if self._socket is not None:
                request.send(self._socket, request.Request(list(paths), {}, '', []))
        except OSError:
            self.close()

    def popen(self, words, **how):
        """Start a process as subprocess.Popen does, with the arguments of roslaunch. Return a Popen or a Forked."""
        if self._socket is not None and self._is_fit(words, how):
            outputs = [number if stream is None else stream.fileno()
                       for number, stream in ((1, how['stdout']), (2, how['stderr']))]
            pid = self._answer(request.Request(list(words), how['env'], how['cwd'], outputs))
            if pid is not None:
                return processes.Forked(pid)
        return subprocess.Popen(words, **how)

    def _is_fit(self, words, how):
        """Return whether the warm process may start it: a Python program of this package that roslaunch could start."""
        streams = how['stdout'], how['stderr']
        return (os.path.dirname(words[0]) == self._folder and os.access(words[0], os.X_OK)
                and processes.interpreter_of(words[0]) and os.path.isdir(how['cwd'])
                and all(stream is None or hasattr(stream, 'fileno') for stream in streams))

    def _answer(self, asked=None):
        """Send a request, if there is one, and return the answer; None if the warm process has ended."""
        if self._socket is None:
            return None
        try:
            if asked is not None:
                request.send(self._socket, asked)
            return request.receive_answer(self._socket)
        except (OSError, ValueError):
            self.close()
            return None

    def close(self):
        """End the warm process. Nodes that it has started go on."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
            self._process.kill()
            self._process.wait()
