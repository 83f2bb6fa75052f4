"""Run an unmodified Python program as a participant: install the hooks, then run the program in this process."""
from __future__ import annotations

import builtins
import os
import runpy
import sys
import types
from importlib.machinery import SourceFileLoader
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Sequence, Tuple

from move_base_abstract.lockstep.task import TurnLost

from ..replacing import rospy_start
from ..replacing.replaced import replace
from .code import callers, objects, own_code, turns
from .code.labels import told
from .debugging import VARIABLE
from .exchange import access
from .failing import tracebacks
from .machine import arenas, chance, clocks, identity, sqlite, unrepeatable_calls
from .machine.files import files
from .machine.native import native
from .participation import early, finish, garbage, joining
from .programs import address_layout, binary
from .ros_master.master_calls import calls
from .waiting import event_loops, kernel_waits, threads, watchdog

if TYPE_CHECKING:
    import argparse

    from .debugging.attaching import Attached
    from .participation.early import Early
    from .participation.taking_part import Participant

_NAME = '__name:='
_HASHES = 'strings have other hashes in each run, so sets of them have another order (PYTHONHASHSEED is ' \
          'random, or Python was told to ignore it)'


def run(kind: str, path: str, arguments: Sequence[str], options: argparse.Namespace) -> None:
    """Run a script or module with the hooks, and exit with its code.

    Without a time master in lockstep the program runs as without the launcher.

    :param kind: 'script' or 'module'.
    :param path: the path of the script, or the name of the module.
    :param arguments: the program's own arguments.
    :param options: the launcher's options.
    """
    if not _has_master():
        _execute(kind, path, arguments, lambda source, path: compile(source, path, 'exec', dont_inherit=True),
                 lambda _source: {})
        return
    name = node_name(kind, path, arguments)
    attached = _attached(name, path)
    threads.replace_locks()
    own_code.install(callers.is_of_program)
    entry = _Joining(options, name, attached)
    _watch(options, binary.node_name(path, arguments, os.environ), entry.early)
    entry.install()
    if attached is not None:
        attached.debugger.turn_begins()
    try:
        _execute(kind, path, arguments, own_code.compile_own, own_code.names_of_script)
    except SystemExit as error:
        entry.early.program_has_ended(error.code if isinstance(error.code, int) else int(error.code is not None))
        raise
    entry.early.program_has_ended(0)


def _watch(options: argparse.Namespace, name: str, before_node: Early) -> None:
    """Make the program see the time and the chance of the run. Where it sees others, the run is labelled."""
    seen = clocks.install(options.seed, options.sleep == 'simulated', native.slept_ns())
    sleep = watchdog.install(options.sleep, before_node.take_part, seen)
    start = '{}:{}'.format(options.seed, name)
    draw = chance.install(start, seen.date_ns)
    identity.install(seen)
    sqlite.install(seen, draw)
    unrepeatable_calls.install()
    unrepeatable_calls.hand_on(seen)
    event_loops.install(seen, before_node.take_part)
    garbage.install()
    tracebacks.install()
    threads.watch_start(before_node.take_part)
    finish.watch_ends()
    kernel_waits.install(sleep.wait)
    native.install(start, seen, sleep.by)
    arenas.install(os.environ)


def _attached(name: str, path: str) -> Optional[Attached]:
    """Return the debugger of this process if the run has one. It is imported before anything is replaced."""
    socket_path = os.environ.get(VARIABLE, '')
    if not socket_path:
        return None
    from .debugging.attaching import attach
    return attach(socket_path, name, path)


def _has_master() -> bool:
    """Return whether the time master is in lockstep. If the ROS master cannot be asked, the program will find out."""
    try:
        import rosgraph
        return rosgraph.Master('/lockstep').hasParam('/time_master/mode') and access.is_lockstep()
    except Exception:
        return False


class _Joining:
    """Makes the program take part when it calls rospy.init_node, or when it first waits for another node before."""

    def __init__(self, options: argparse.Namespace, name: str, attached: Optional[Attached]) -> None:
        self._rank = options.rank
        self._attached = attached
        self._is_node = False
        self._is_strict = options.strict
        turns.install()
        objects.install()
        self.early = early.Early(name, lambda name, uri: self._follow(joining.take_part(name, uri, self._rank)))

    def install(self) -> None:
        """Put the hooks in front of rospy.init_node and of calls that may wait before it."""
        rospy_start.prepare()
        for name in ('rospy.init_node', 'rospy.client.init_node'):
            replace(name, lambda init_node: lambda *args, **kwds: self._init_node(init_node, args, kwds))
        calls.install()
        calls.before = self.early.take_part
        self.early.install()

    def _init_node(self, init_node: Callable[..., Any], args: Tuple[Any, ...], kwds: Dict[str, Any]) -> None:
        self.early.init_node(init_node, args, kwds)
        if self._is_node:
            return  # init_node has been called before
        self._is_node = True
        joined = joining.participant()
        if joined is None:
            self.early.end()
            self._follow(joining.join(self._rank))
        else:
            joining.node_is_there(joined)

    def _follow(self, joined: Optional[Participant]) -> None:
        if joined is not None and self._is_strict:
            joined.be_strict()
        for follower in (told, native, files, arenas):
            follower.follow(joined)
        if self._attached is not None:
            self._attached.follow(joined)
        if joined is not None and not address_layout.is_as_wanted(os.environ):
            joined.label(address_layout.LABEL)
        if joined is not None and not _is_one_hash():
            joined.label(_HASHES)
        if joined is not None:
            chance.watch_paths(joined, os.environ.get('TMPDIR', ''))


def _is_one_hash() -> bool:
    """Return whether texts have the same hashes in each run."""
    return not sys.flags.hash_randomization or (
        not sys.flags.ignore_environment and os.environ.get('PYTHONHASHSEED', 'random').isdigit())


def node_name(kind: str, path: str, arguments: Sequence[str]) -> str:
    """Return the node's resolved name if it is certain before the program calls rospy.init_node; otherwise ''.

    The name is from the command line, or from the only call of init_node in a script.
    """
    if any(word.startswith(_NAME) for word in arguments):
        return binary.node_name(path, arguments, os.environ)
    name = '' if kind == 'module' else own_code.name_of_node(path)
    return binary.node_name(name, arguments, os.environ) if name else ''


def _execute(kind: str, path: str, arguments: Sequence[str], compile_script: Callable[..., Any],
             names_of_script: Callable[..., Any]) -> None:
    """Run the program as ``__main__``, as Python itself would. Modules are not looked for in the launcher's folder."""
    module: Any = types.ModuleType('__main__')
    module.__builtins__ = builtins
    sys.modules['__main__'] = module
    sys.argv[:] = [path, *arguments]  # in place, as in warm_nodes.become
    if kind == 'module':
        sys.path[0] = os.getcwd()
        _call(lambda: runpy._run_module_as_main(path))  # type: ignore[attr-defined]
        return
    sys.path[0] = os.path.dirname(os.path.realpath(path))
    with open(path, 'rb') as stream:
        source = stream.read()
    module.__file__ = os.path.abspath(path) if sys.version_info >= (3, 9) else path
    module.__loader__ = SourceFileLoader('__main__', path)
    module.__annotations__ = {}
    module.__dict__.update(names_of_script(source))
    _call(lambda: exec(compile_script(source, path), module.__dict__))


def _call(main: Callable[..., Any]) -> None:
    """Call the program. A traceback has only the program's lines."""
    try:
        main()
    except SystemExit:
        raise
    except TurnLost:
        sys.exit(finish.exit_code() or 0)  # the run is over, as the log says
    except BaseException as error:
        trace = tracebacks.without_ours(error.__traceback__)
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        sys.exit(130 if isinstance(error, KeyboardInterrupt) else 1)
