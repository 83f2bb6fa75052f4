"""Watch a process of roslaunch: the exit code of each start, and the lines that it prints about errors."""
import collections
import os
import sys
import threading

from move_base_abstract.runs import ends

_LONGEST = 1 << 16  # bytes of a line; longer lines are read in parts
_END_S = 1.0  # wall, to wait for the last lines of a process that has ended


class Watched:
    """Watches a roslaunch Process from before its start. Copies its standard error output to that of this process."""

    def __init__(self, process, follow=None):
        """follow: called with the Popen of each start, if given."""
        self._process = process
        self._popens = []
        self._early = []  # exit codes of processes that ended while the run went on
        self._lines = collections.deque(maxlen=ends.LAST_LINES)
        self._shown = []
        self._readers = []
        self.is_told = False  # whether we send a signal to it
        self._is_over = False
        start, configure = process.start, process._configure_logging

        def watched_start():
            try:
                return start()
            finally:
                if process.popen is not None and process.popen not in self._popens:
                    self._popens.append(process.popen)
                    if follow is not None:
                        follow(process.popen)

        def watched_logging():
            output, errors = configure()
            return output, self._pipe() if errors is None else errors
        process.start, process._configure_logging = watched_start, watched_logging

    def look(self, is_early=False):
        """Return the exit code of the last start, None while it runs. ``is_early``: the run goes on: note the end."""
        code = self._popens[-1].poll() if self._popens else None
        if is_early:
            self._early = [one.returncode for one in self._popens if one.poll() is not None]
        else:
            self._is_over = True
        return code

    def process(self, name, takes_part):
        """Return the ends.Process of the node ``name``. Call it when the run is over."""
        bad = [code for code in self._early if code]
        code = bad[0] if bad else self.look()
        for reader in self._readers if code else ():
            reader.join(_END_S)
        return ends.Process(name, takes_part, code, bool(self._early), self.is_told, tuple(self._lines),
                            tuple(self._shown), was_started=bool(self._popens))

    def _pipe(self):
        """Return the writing end of a new pipe for a process. The caller that starts the process closes it."""
        read, write = os.pipe()
        reader = threading.Thread(target=self._read, args=(read,), daemon=True)
        reader.start()
        self._readers.append(reader)
        return os.fdopen(write, 'wb', 0)

    def _read(self, descriptor):
        with os.fdopen(descriptor, 'rb') as stream:
            for line in iter(lambda: stream.readline(_LONGEST), b''):
                text = line.decode('utf-8', 'replace').rstrip('\n')
                if text.strip():
                    self._lines.append(text)
                if not self._is_over and len(self._shown) < ends.LAST_LINES and ends.shows_uncaught(text):
                    self._shown.append(text)
                try:
                    sys.stderr.buffer.write(line)
                    sys.stderr.buffer.flush()
                except (OSError, ValueError):
                    pass  # our output cannot be written; the process must not wait for that
