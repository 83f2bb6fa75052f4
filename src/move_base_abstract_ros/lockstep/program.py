"""Run an unmodified Python program as a participant: hooks first, then the program, in this process."""
import os
import random
import runpy
import sys
import types
import zlib

from . import threads, watchdog


def run(kind, path, arguments, options):
    """Run the script or module with hooks; exits with its code."""
    import rospy

    import move_base_abstract_ros.lockstep as lockstep

    if not _has_master(lockstep):
        _execute(kind, path, arguments)
        return
    threads.replace_locks()
    watchdog.install(options.sleep)
    _join_after_init_node(rospy, lockstep, options)
    _execute(kind, path, arguments)


def _has_master(lockstep):
    """Whether lockstep is wanted; what cannot be asked is left to the program to find out."""
    try:
        import rosgraph
        return rosgraph.Master('/lockstep').hasParam('/time_master/mode') and lockstep.is_lockstep()
    except Exception:
        return False


def _join_after_init_node(rospy, lockstep, options):
    init_node = rospy.init_node

    def init_node_and_join(*args, **kwds):
        init_node(*args, **kwds)
        if lockstep.participant() is None:
            joined = lockstep.join(options.rank)
            watchdog.follow(joined)
            _seed('{}:{}'.format(options.seed, rospy.get_name()))

    rospy.init_node = rospy.client.init_node = init_node_and_join


def _seed(text):
    """Give the global generators a start that depends on the node only."""
    number = zlib.crc32(text.encode('utf-8'))
    random.seed(number)  # noqa: TID251 - the generator of the program, not ours
    numpy = sys.modules.get('numpy')
    if numpy is not None:
        numpy.random.seed(number)


def _execute(kind, path, arguments):
    if kind == 'module':
        sys.argv = [path] + arguments
        sys.path.insert(0, os.getcwd())
        _call(lambda: runpy.run_module(path, run_name='__main__', alter_sys=True))
        return
    sys.argv = [path] + arguments
    sys.path.insert(0, os.path.dirname(os.path.realpath(path)))
    with open(path, 'rb') as stream:
        source = stream.read()
    module = types.ModuleType('__main__')
    module.__file__ = path
    module.__builtins__ = __builtins__
    sys.modules['__main__'] = module
    _call(lambda: exec(compile(source, path, 'exec', dont_inherit=True), module.__dict__))


def _call(main):
    """Call the program; a traceback begins with its own first line."""
    try:
        main()
    except Exception as error:
        trace = error.__traceback__
        while trace is not None and _is_ours(trace.tb_frame.f_code.co_filename):
            trace = trace.tb_next
        sys.excepthook(type(error), error, trace)
        sys.exit(1)


def _is_ours(filename):
    return filename.startswith('<frozen runpy') or os.path.dirname(filename) == os.path.dirname(__file__) or (
        os.path.basename(filename) == 'runpy.py')
