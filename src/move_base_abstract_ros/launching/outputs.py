"""Where the nodes of a run print: into files of a folder, or, as with roslaunch, on the screen."""
import collections
import contextlib
import itertools
import os
import re
import select
import sys

from roslaunch.core import printerrlog, printlog, printlog_bold

from move_base_abstract.common import processes
from move_base_abstract.runs import ends

_FILE = re.compile(r'[^\w.-]+', re.ASCII)
_LAST_BYTES = 1 << 16
_PIECE = 1 << 16
_MOST_PIECES = 100  # of each process, that are shown before the run is looked at again
_LONGEST_LINE = 1 << 16  # bytes; longer lines are read in parts


class Files:
    """Each node prints into a file of its own in ``folder``. Its ROS log is beside it."""

    pause = staticmethod(processes.await_child)
    begun = staticmethod(lambda uri: None)

    def __init__(self, folder):
        self.folder = folder
        self.of_master = os.path.join(folder, 'rosmaster.txt')

    def of(self, name, _node=None):
        """Return the output of the process with this name."""
        return _File(os.path.join(self.folder, _FILE.sub('-', name.strip('/'))))


class _File:
    """The output of one process, in a file. It has the methods of _Screen; four of them do nothing here."""

    prepare = started = ended = told = staticmethod(lambda *_about: None)

    def __init__(self, stem):
        self.path, self.log = stem + '.txt', stem + '.log'

    def enter(self):
        """Make this process, which becomes the node, print into the file; its standard input is empty."""
        descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        for target, source in ((0, os.open(os.devnull, os.O_RDONLY)), (1, descriptor), (2, descriptor)):
            os.dup2(source, target)

    def printed(self):
        """Return the last lines that the process has printed."""
        with contextlib.suppress(OSError), open(self.path, 'rb') as stream:
            stream.seek(max(0, os.fstat(stream.fileno()).st_size - _LAST_BYTES))
            lines = stream.read().decode('utf-8', 'replace').splitlines()
            return tuple([line for line in lines if line.strip()][-ends.LAST_LINES:])
        return ()

    def shown(self):
        """Return the first lines, so far, that show uncaught exceptions."""
        with contextlib.suppress(OSError), open(self.path, encoding='utf-8', errors='replace') as stream:
            return tuple(itertools.islice(filter(ends.shows_uncaught, stream), ends.LAST_LINES))
        return ()


class Screen:
    """Nodes print on the screen, as far as the launch file says so; otherwise their standard output has a log file.

    ``folder``: for these logs, and for the nodes' ROS logs.
    """

    def __init__(self, folder):
        self.folder, self.of_master = folder, os.devnull
        self._pipes = []  # from which the standard error outputs come
        self._counts = itertools.count(1)

    def begun(self, uri):
        """Say where the run's ROS master and its logs are."""
        printlog('... logging to ' + self.folder)
        printlog_bold('ROS_MASTER_URI=' + uri)

    def of(self, name, node=None):
        """Return the output of the process with this name, for a roslaunch Node."""
        os.makedirs(self.folder, exist_ok=True)
        is_shown = node is None or node.output == 'screen'
        return _Screen(self._pipes, self.folder, '{}-{}'.format(name.strip('/'), next(self._counts)), is_shown)

    def pause(self, seconds):
        """Show what nodes print, and wait for it at most ``seconds`` [s, wall]."""
        for _ in range(_MOST_PIECES):  # a node that prints without an end must not keep the run from its own
            ready = select.select(self._pipes, [], [], seconds)[0]
            if not ready:
                break
            for one in ready:
                if not one.read():
                    self._pipes.remove(one)
            seconds = 0.0


class _Screen:
    """The output of one process on the screen. What it prints to its standard error output is noted, too."""

    def __init__(self, pipes, folder, name, is_shown):
        self._name, self._pipes = name, pipes
        self._stem = os.path.join(folder, name.replace('/', '-'))
        self.log = self._stem + '.log'
        self._stdout = None if is_shown else self._stem + '-stdout.log'
        self._begun, self._write = b'', None
        self._lines = collections.deque(maxlen=ends.LAST_LINES)
        self._shown = []

    def prepare(self):
        """Make the pipe for the standard error output of a process that is about to start."""
        read, self._write = os.pipe()
        self._pipes.append(_Pipe(read, self))

    def enter(self):
        """Make this process, which becomes the node, print to the right places."""
        os.dup2(self._write, 2)
        if self._stdout:
            os.dup2(os.open(self._stdout, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666), 1)

    def started(self, pid):
        """Say that the process has started."""
        os.close(self._write)
        printlog_bold('process[{}]: started with pid [{}]'.format(self._name, pid))

    def ended(self, pid, code, words, is_required=False):
        """Say, as roslaunch does, that the process has ended. ``words``: its command line."""
        text = 'process has finished cleanly' if code == 0 else (
            'process has died [pid {}, exit code {}, cmd {}].'.format(pid, code, ' '.join(words)))
        text = '{}\nlog file: {}*.log'.format(text, self._stem)
        if is_required:
            printerrlog('{0}REQUIRED process [{1}] has died!\n{2}\nInitiating shutdown!\n{0}'.format(
                '=' * 80, self._name, text))
        else:
            (printerrlog if code else printlog_bold)('[{}] {}'.format(self._name, text))

    def told(self):
        """Say that the process gets a signal."""
        printlog('[{}] killing on exit'.format(self._name))

    def take(self, piece):
        """Take bytes that the process has printed; b'': it prints no more."""
        *lines, self._begun = (self._begun + piece).split(b'\n')
        if self._begun and (not piece or len(self._begun) >= _LONGEST_LINE):
            lines, self._begun = [*lines, self._begun], b''
        for line in lines:
            text = line.decode('utf-8', 'replace')
            if text.strip():
                self._lines.append(text)
            if len(self._shown) < ends.LAST_LINES and ends.shows_uncaught(text):
                self._shown.append(text)
        with contextlib.suppress(OSError, ValueError):  # the process must not wait for our output
            sys.stderr.buffer.write(piece)
            sys.stderr.buffer.flush()

    def printed(self):
        """Return the last lines that the process has printed to its standard error output."""
        return tuple(self._lines)

    def shown(self):
        """Return the first lines, so far, that show uncaught exceptions."""
        return tuple(self._shown)


class _Pipe:
    """The reading end of a pipe, for select()."""

    def __init__(self, descriptor, output):
        self._descriptor, self._output = descriptor, output

    def fileno(self):
        """Return the descriptor."""
        return self._descriptor

    def read(self):
        """Read what there is; return whether there may be more."""
        piece = os.read(self._descriptor, _PIECE)
        self._output.take(piece)
        if not piece:
            os.close(self._descriptor)
        return bool(piece)
