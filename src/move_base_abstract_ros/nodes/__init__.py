"""The executables of this package: one module for each, with a main(). Those of tools are in the tools' packages."""
import errno
import importlib
import os
import signal
import sys

from move_base_abstract.common import errors, guard

_GUARDED = ('demo',)  # programs that import what starts threads; others call guard.stand() themselves
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)


def start(name):
    """Run main() of the module ``name`` of this room, or of a tool's package, and exit with its code.

    There is no traceback if the user presses Ctrl-C, or if the output cannot be written.
    """
    if name in _GUARDED:
        guard.stand(name)
    is_main = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_main:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # during the imports, which take most of a second
    main = importlib.import_module(name if name.startswith('move_base_abstract_') else '.' + name, __name__).main
    if is_main:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.stdout = _Remembering(sys.stdout)
    try:
        code = errors.exit_code_of(main)
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = 130
    except BrokenPipeError:
        code = _end_output(1)  # the reader of the output has gone
    except OSError as error:
        what = error.filename or ('the output cannot be written' if error.errno in _NO_ROOM else 'error')
        print('{}: {}: {}'.format(os.path.basename(sys.argv[0]), what, error.strerror or error), file=sys.stderr)
        code = _end_output(1)
    sys.exit(code)


class _Remembering:
    """The standard output. An error of write() is raised again by flush(), because argparse hides it.

    (A buffered output raises it at flush() anyway. Python 3.13 does not buffer what is written to a device.)
    """

    def __init__(self, stream):
        self._stream = stream
        self._error = None

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text):
        """Write ``text``, as any stream does."""
        try:
            return self._stream.write(text)
        except OSError as error:
            self._error = error
            raise

    def flush(self):
        """Flush, as any stream does. Raise the last OSError of write(), once."""
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        self._stream.flush()


def _end_output(code):
    """Make the last flush of Python write nothing, and return ``code``."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return code
