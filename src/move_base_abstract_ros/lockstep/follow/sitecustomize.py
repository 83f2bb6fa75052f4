"""Read by each Python that a followed shell script starts: the one that is the node becomes the launcher's.

The others go on, with the sitecustomize that they would have had. See shell_scripts.py.
"""
import json
import os
import sys

_FOLLOW, _PATHS = 'MOVE_BASE_ABSTRACT_LOCKSTEP_FOLLOW', 'PYTHONPATH'


def _follow(process, names, launcher, folder):
    with open('/proc/self/cmdline', 'rb') as stream:
        words = [os.fsdecode(word) for word in stream.read().split(b'\0')[1:-1]]
    if os.getpid() != process and not any(name in words for name in names) or not words or _has_command(words):
        return
    del os.environ[_FOLLOW]
    paths = [path for path in os.environ.get(_PATHS, '').split(os.pathsep) if path and path != folder]
    os.environ.pop(_PATHS, None)
    if paths:
        os.environ[_PATHS] = os.pathsep.join(paths)
    os.execv(launcher[0], launcher + [sys.executable] + words)


def _has_command(words):
    """Return whether Python is given a command (-c) and no file: what comes behind a file's name is the program's."""
    given = iter(words)
    for word in given:
        if not word.startswith('-') or word.startswith('-m'):
            return False
        if word in ('-W', '-X'):
            next(given, None)
        elif 'c' in word and not word.startswith(('--', '-W', '-X')):
            return True
    return False


def _go_on(folder):
    sys.path[:] = [path for path in sys.path if path != folder]
    del sys.modules[__name__]
    try:
        import sitecustomize  # noqa: F401 - the one behind this
    except ImportError:
        pass


if _FOLLOW in os.environ:
    _given = json.loads(os.environ[_FOLLOW])
    _follow(*_given)
    _go_on(_given[-1])
