"""Each Python that a followed shell script starts imports this module. The one that is the node becomes the launcher.

The launcher then runs its program. All others go on, with the sitecustomize that they would have had. See
shell_scripts.py.
"""
import json
import os
import sys

_FOLLOW, _PATHS = 'MOVE_BASE_ABSTRACT_LOCKSTEP_FOLLOW', 'PYTHONPATH'


def _follow(process, names, launcher, folder):
    with open('/proc/self/cmdline', 'rb') as stream:
        words = [os.fsdecode(word) for word in stream.read().split(b'\0')[1:-1]]
    if os.getpid() != process and not any(name in words for name in names) or '-c' in words or not words:
        return
    del os.environ[_FOLLOW]
    paths = [path for path in os.environ.get(_PATHS, '').split(os.pathsep) if path and path != folder]
    os.environ.pop(_PATHS, None)
    if paths:
        os.environ[_PATHS] = os.pathsep.join(paths)
    os.execv(launcher[0], launcher + [sys.executable] + words)


def _go_on(folder):
    sys.path[:] = [path for path in sys.path if path != folder]
    del sys.modules[__name__]
    try:
        import sitecustomize  # noqa: F401 - the next one in the search path
    except ImportError:
        pass


if _FOLLOW in os.environ:
    _given = json.loads(os.environ[_FOLLOW])
    _follow(*_given)
    _go_on(_given[-1])
