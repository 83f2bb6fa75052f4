"""Run an unmodified Python program as a participant: hooks first, then the program, in this process."""
import builtins
import os
import random
import runpy
import sys
import types
import uuid
import zlib
from importlib.machinery import SourceFileLoader

from move_base_abstract.lockstep.scheduler import TurnLost

from ..replaced import replace
from . import own_code, queries, threads, turns, watchdog

_NAME, _NAMESPACE = '__name:=', '__ns:='


def run(kind, path, arguments, options):
    """Run the script or module with hooks; exits with its code."""
    import move_base_abstract_ros.lockstep as lockstep

    if _has_master(lockstep):
        threads.replace_locks()
        watchdog.install(options.sleep)
        own_code.install()
        _join_after_init_node(lockstep, options, turns.install())
        _seed('{}:{}'.format(options.seed, _node_name(path, arguments)))
        _execute(kind, path, arguments, own_code.compile_own, own_code.names_of_script)
    else:
        _execute(kind, path, arguments, _compile, lambda _source: {})


def _compile(source, path):
    return compile(source, path, 'exec', dont_inherit=True)


def _has_master(lockstep):
    """Whether lockstep is wanted; what cannot be asked is left to the program to find out."""
    try:
        import rosgraph
        return rosgraph.Master('/lockstep').hasParam('/time_master/mode') and lockstep.is_lockstep()
    except Exception:
        return False


def _join_after_init_node(lockstep, options, loops):
    def joining(init_node):
        def init_node_and_join(*args, **kwds):
            init_node(*args, **kwds)
            if lockstep.participant() is None:
                joined = lockstep.join(options.rank)
                watchdog.follow(joined)
                loops.follow(joined)
                queries.install(joined)
        return init_node_and_join

    replace('rospy.init_node', joining)
    replace('rospy.client.init_node', joining)


def _node_name(path, arguments):
    """Return the node's name as far as the command line has it, which is before the program says its own."""
    name, namespace = os.path.basename(path), os.environ.get('ROS_NAMESPACE', '')
    for word in arguments:
        if word.startswith(_NAME):
            name = word[len(_NAME):]
        elif word.startswith(_NAMESPACE):
            namespace = word[len(_NAMESPACE):]
    return '/{}/{}'.format(namespace.strip('/'), name) if namespace.strip('/') else '/' + name


def _seed(text):
    """Give the global generators a start that depends on the node only; the program may give them another."""
    number = zlib.crc32(text.encode('utf-8'))
    random.seed(number)  # noqa: TID251 - the generator of the program, not ours
    of_ids = random.Random(number)
    replace('uuid.uuid4', lambda _uuid4: lambda: uuid.UUID(int=of_ids.getrandbits(128), version=4))
    try:
        import numpy
    except ImportError:
        return
    numpy.random.seed(number)  # noqa: NPY002 - as above


def _execute(kind, path, arguments, compile_script, names_of_script):
    """Be __main__, as Python itself would make it; the launcher's own folder is searched for modules no more."""
    module = types.ModuleType('__main__')
    module.__builtins__ = builtins
    sys.modules['__main__'] = module
    sys.argv = [path] + arguments
    if kind == 'module':
        sys.path[0] = os.getcwd()
        _call(lambda: runpy._run_module_as_main(path))
        return
    sys.path[0] = os.path.dirname(os.path.realpath(path))
    with open(path, 'rb') as stream:
        source = stream.read()
    module.__file__ = os.path.abspath(path) if sys.version_info >= (3, 9) else path
    module.__loader__ = SourceFileLoader('__main__', path)
    module.__annotations__ = {}
    module.__dict__.update(names_of_script(source))
    _call(lambda: exec(compile_script(source, path), module.__dict__))


def _call(main):
    """Call the program; a traceback begins with its own first line."""
    try:
        main()
    except SystemExit:
        raise
    except TurnLost:
        sys.exit(1)  # the run is over, which the log says
    except BaseException as error:
        trace = error.__traceback__
        while trace is not None and _is_ours(trace.tb_frame.f_code.co_filename):
            trace = trace.tb_next
        error = error.with_traceback(trace)
        sys.excepthook(type(error), error, trace)
        sys.exit(130 if isinstance(error, KeyboardInterrupt) else 1)


def _is_ours(filename):
    return filename.startswith('<frozen runpy') or os.path.dirname(filename) == os.path.dirname(__file__) or (
        os.path.basename(filename) == 'runpy.py')
