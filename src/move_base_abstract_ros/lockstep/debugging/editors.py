"""An editor debugs the program, by debugpy, which is no part of this package."""
from __future__ import annotations

import importlib
from threading import local
from typing import Any, Callable, ContextManager, Optional

from .link import Link

_ADDRESS = '127.0.0.1'
_MISSING = 'debugpy is not here, by which an editor debugs a program: apt-get install python3-debugpy (Debian 12 and ' \
           '13), or pip install debugpy; pdb needs nothing'


def wait_for_editor(port: int, link: Link, looked_at: Callable[[], ContextManager[None]],
                    ) -> Optional[Callable[[], None]]:
    """Wait until an editor attaches at a port; return a function that lets it follow the thread that calls it.

    Whatever debugpy waits for while the program stands is within ``looked_at()``. Without debugpy the link is told
    what to install, and None is returned.
    """
    try:
        debugpy, pydevd = map(importlib.import_module, ('debugpy', 'pydevd'))
    except ImportError:
        link.send('refused', text=_MISSING)
        return None
    try:
        debugpy.listen((_ADDRESS, port))
    except Exception as error:  # whatever it raises: the port is taken, the adapter did not start
        link.send('refused', text='no editor can attach at {}:{}: {}'.format(_ADDRESS, port, error))
        return None
    link.send('note', text='waits for an editor at {}:{}'.format(_ADDRESS, port))
    debugpy.wait_for_client()
    link.send('note', text='an editor has attached at {}:{}'.format(_ADDRESS, port))
    _stand_beside(pydevd.PyDB, looked_at)
    followed = local()

    def trace_thread() -> None:
        if not hasattr(followed, 'is_traced'):
            followed.is_traced = True
            debugpy.trace_this_thread(True)
    trace_thread()
    return trace_thread


def _stand_beside(kind: Any, looked_at: Callable[[], ContextManager[None]]) -> None:
    wait = kind.do_wait_suspend

    def do_wait_suspend(self: Any, *args: Any, **kwds: Any) -> Any:
        with looked_at():
            return wait(self, *args, **kwds)
    kind.do_wait_suspend = do_wait_suspend
