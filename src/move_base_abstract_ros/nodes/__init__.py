"""One module per executable, each with a main()."""
import errno
import importlib
import os
import signal
import sys

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)


def start(name):
    """Run the program of the module ``name``. Ctrl-C and an output that nobody takes are no reason for a traceback."""
    is_main = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_main:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # while it imports, which is most of a second
    main = importlib.import_module('.' + name, __name__).main
    if is_main:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.stdout = _Remembering(sys.stdout)
    try:
        code = _code_of(main)
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = 130
    except BrokenPipeError:
        code = _end_output(1)  # who read it has had enough
    except OSError as error:
        what = error.filename or ('the output cannot be written' if error.errno in _NO_ROOM else 'error')
        print('{}: {}: {}'.format(os.path.basename(sys.argv[0]), what, error.strerror or error), file=sys.stderr)
        code = _end_output(1)
    sys.exit(code)


class _Remembering:
    """The standard output. What it could not write is told by flush(): argparse says nothing of it.

    (Of a buffered output that is so anyway; Python 3.13 does not buffer what is written to a device.)
    """

    def __init__(self, stream):
        self._stream = stream
        self._error = None

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text):
        """As of any stream."""
        try:
            return self._stream.write(text)
        except OSError as error:
            self._error = error
            raise

    def flush(self):
        """As of any stream."""
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        self._stream.flush()


def _code_of(main):
    try:
        main()
    except SystemExit as error:
        if isinstance(error.code, int) or error.code is None:
            return error.code or 0
        print(error.code, file=sys.stderr)
        return 1
    return 0


def _end_output(code):
    """Have nothing more written at the end, and return ``code``."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return code
