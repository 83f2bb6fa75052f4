"""The rospy of a script that starts runs: a deputy, which takes part in the run, does what concerns the run.

The script gets a module of its own in the place of rospy. All names that are not listed here are rospy's own.

The two speak over a Connection of multiprocessing, on a Unix socket in a folder that only this user can enter. Only one
of the two speaks at a time. The deputy answers a request by ANSWER or ERROR. Before that it may send any number of
CALLBACKs. The script answers each of them by DONE, with the result of the function, and may send requests of its own
before that. Whoever leaves the run closes the connection.
"""
import itertools
import sys
import threading
import traceback
import types
from typing import NamedTuple

import rospy

from ...lockstep.participation.rospy_time import set_rostime

REQUEST, ANSWER, ERROR, CALLBACK, DONE = range(5)
#: what a Connection raises when the other side has gone, or this side has closed it
GONE = (EOFError, OSError)
#: functions of rospy that the deputy calls
FUNCTIONS = ('sleep', 'wait_for_message', 'wait_for_service', 'get_param', 'has_param', 'set_param', 'delete_param',
             'search_param', 'get_param_names', 'get_param_cached', 'get_published_topics', 'get_name',
             'get_namespace', 'get_caller_id', 'resolve_name', 'spin')
#: classes of rospy whose objects the deputy makes
CLASSES = ('Publisher', 'ServiceProxy', 'Service', 'Rate', 'Timer')
_LOGS = {'logdebug': None, 'loginfo': sys.stdout, 'logwarn': sys.stderr, 'logerr': sys.stderr, 'logfatal': sys.stderr}
_NO_RUN = 'no run is under way: ROSLaunchParent.start() begins one'
_OVER = 'the run is over'


class Function(NamedTuple):
    """Stands for a function of the script in messages to the deputy."""

    number: int


class Thing(NamedTuple):
    """Stands for an object that the deputy has made for the script, such as a subscriber, in messages to the deputy."""

    number: int


class Deputised:
    """The script's side of the link. Call ``begin(link)`` when a run has begun, ``end()`` when the script leaves it."""

    def __init__(self):
        self._link = None
        self._functions, self._numbers = {}, itertools.count(1)
        self._is_shut_down = False
        #: whether the run has ended by itself
        self.is_over = False
        #: whether the script waits for the deputy, or was ended by a signal while it did
        self.is_waiting = False
        self._hooks = []

    @property
    def is_under_way(self):
        """Whether a run is under way, as far as the script knows."""
        return self._link is not None

    def begin(self, link):
        """Use the deputy at the other end of this Connection from now on. Wait until it answers."""
        self._link, self.is_over, self.is_waiting = link, False, False
        rospy.rostime.set_rostime_initialized(True)
        self._take(link.recv())

    def end(self):
        """Make the deputy leave the run, if it takes part; what it has made is lost."""
        link, self._link = self._link, None
        self._functions.clear()
        if link is not None:
            link.close()

    def run_hooks(self):
        """Call the functions that were given to rospy.on_shutdown, at the end of the script."""
        hooks, self._hooks = self._hooks, []
        for hook in hooks:
            hook()

    def ask(self, name, *args, _number=None, **kwds):
        """Make the deputy call ``name`` of its rospy, and return the result. Callbacks of the script run meanwhile.

        ``name``: a name in rospy, or (number of a thing, name of its method). ``_number``: the number under which the
        deputy keeps the result.

        :raises rospy.ROSInterruptException: if there is no run, or it is over.
        :raises RuntimeError: if this is not the main thread.
        """
        if threading.current_thread() is not threading.main_thread():
            raise RuntimeError('rospy.{}: a script that starts runs may call it in its main thread only'.format(name))
        if self._link is None:
            raise rospy.ROSInterruptException(_OVER if self.is_over else _NO_RUN)
        link = self._link
        try:
            link.send((REQUEST, _number, name, [self._token(arg) for arg in args],
                       {key: self._token(value) for key, value in kwds.items()}))
            told = self._receive(link)
            while told[0] == CALLBACK:
                set_rostime(told[1])
                link.send((DONE, self._call(*told[2:])))
                told = self._receive(link)
        except GONE:
            if self._link is link:  # otherwise a callback has left the run
                self._link, self.is_over = None, True
            raise rospy.ROSInterruptException(_OVER) from None
        return self._take(told)

    def _receive(self, link):
        self.is_waiting = True
        told = link.recv()
        self.is_waiting = False
        return told

    def _call(self, number, args):
        """Call a function of the script, as rospy calls a callback: its exceptions are printed, and go no further."""
        try:
            return self._functions[number](*args)
        except Exception:
            print('[ERROR] bad callback: {}'.format(self._functions[number]), file=sys.stderr)
            traceback.print_exc()
        return None

    def _take(self, told):
        kind, now_ns, *words = told
        set_rostime(now_ns)
        if kind == ERROR:
            raise words[0](*words[1:])
        return words[0]

    def _token(self, arg):
        if isinstance(arg, Proxy):
            return Thing(arg.deputised_number)
        if not callable(arg) or isinstance(arg, type):
            return arg
        number = next(self._numbers)
        self._functions[number] = arg
        return Function(number)

    def make(self, kind, *args, **kwds):
        """Return a Proxy of a new object of rospy's class ``kind``."""
        number = next(self._numbers)
        self.ask(kind, *args, _number=number, **kwds)
        return Proxy(self, number, kind)

    def _subscribe(self, name, data_class, callback=None, callback_args=None, **kwds):
        """Make a Subscriber, as rospy does. ``callback_args`` stay here, so that the callback gets no copy of them."""
        if callback is not None and callback_args is not None:
            return self.make('Subscriber', name, data_class, lambda message: callback(message, callback_args), **kwds)
        return self.make('Subscriber', name, data_class, callback, **kwds)

    def is_shutdown(self):
        """Return whether the script shuts down, or the run has ended by itself and no other one has begun."""
        return self._is_shut_down or self.is_over

    def _shut_down(self, _reason=''):
        self._is_shut_down = True

    def module(self):
        """Return the module that the script gets as rospy."""
        made = types.ModuleType('rospy')
        made.__dict__.update(vars(rospy))
        for name in FUNCTIONS:
            setattr(made, name, lambda *args, _name=name, **kwds: self.ask(_name, *args, **kwds))
        for name in CLASSES:
            setattr(made, name, lambda *args, _name=name, **kwds: self.make(_name, *args, **kwds))
        made.Subscriber = self._subscribe
        for name, stream in _LOGS.items():
            log = _log(name[3:].upper(), stream)
            for suffix in ('', '_once', '_throttle'):
                setattr(made, name + suffix, log if suffix != '_throttle' else _without_period(log))
        made.init_node = lambda *_args, **_kwds: None  # the deputy is the node
        made.is_shutdown, made.signal_shutdown, made.on_shutdown = self.is_shutdown, self._shut_down, self._hooks.append
        return made


class Proxy:
    """Stands for an object that the deputy has made. The deputy calls its methods."""

    def __init__(self, deputised, number, kind):
        self.deputised_number = number
        self._deputised = deputised
        self._kind = kind

    def __getattr__(self, name):
        if name.startswith('__'):
            raise AttributeError(name)
        return lambda *args, **kwds: self._deputised.ask((self.deputised_number, name), *args, **kwds)

    def __call__(self, *args, **kwds):
        """Call the service, if this stands for a ServiceProxy."""
        return self._deputised.ask((self.deputised_number, '__call__'), *args, **kwds)


def _log(level, stream):
    def log(text, *args, **_kwds):
        if stream is not None:
            print('[{}] {}'.format(level, text % args if args else text), file=stream, flush=True)
    return log


def _without_period(log):
    return lambda _period, text, *args, **kwds: log(text, *args, **kwds)
