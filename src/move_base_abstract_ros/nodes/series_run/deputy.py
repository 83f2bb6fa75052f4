"""The deputy: the node that takes part in a run for a script that starts runs, and does what that asks rospy for."""
import sys

import rospy

from move_base_abstract.common.errors import SimulatorError

from ... import lockstep
from ...launching.scripted.deputy_link import ANSWER, CALLBACK, DONE, ERROR, Function, LinkClosed, Thing, connect
from ...replacing import rospy_start

LEAVE = 'leave'


def main(address):
    """Take part, until the script at ``address`` (a path) has had enough of the run."""
    rospy_start.prepare()
    rospy.init_node('deputy', disable_rosout=True)
    try:
        lockstep.join()
        Deputy(connect(address)).serve()
    except (SimulatorError, rospy.ROSException, OSError) as error:
        sys.exit('{}: {}'.format(rospy.get_name(), error))


class Deputy:
    """Does in its turn what the script asks for, while simulated time stands: what the script computes takes none."""

    def __init__(self, link):
        self._link = link
        self._made = {}

    def serve(self, until=None):
        """Do what is asked for, until the script leaves, or answers ``until``; return what it says then."""
        link = self._link
        if until is None:
            link.send(ANSWER, _now_ns(), None)
        while True:
            try:
                kind, *words = link.receive()
            except LinkClosed:
                return None
            if kind == until or words and words[0] == LEAVE:
                return words[0]
            try:
                self._answer(*words)
            except LinkClosed:
                return None

    def _answer(self, *words):
        try:
            result = self._do(*words)
        except rospy.ROSInterruptException:
            self._link.close()
            raise LinkClosed('the run is over') from None
        except rospy.ROSException as error:
            self._link.send(ERROR, _now_ns(), type(error), str(error))
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            self._link.send(ERROR, _now_ns(), type(error), *error.args[:1])
        else:
            self._link.send(ANSWER, _now_ns(), result)

    def _do(self, number, name, args, kwds):
        """Call rospy's ``name``, keeping what it returns under ``number`` if there is one; or a method of what is kept.

        ``name`` of a method: (number of the thing, name).
        """
        args = [self._own(arg) for arg in args]
        kwds = {key: self._own(value) for key, value in kwds.items()}
        if isinstance(name, tuple):
            found = getattr(self._made[name[0]], name[1])
            return found(*args, **kwds) if callable(found) else found
        result = getattr(rospy, name)(*args, **kwds)
        if number is None:
            return result
        self._made[number] = result
        return None

    def _own(self, arg):
        if isinstance(arg, Thing):
            return self._made[arg.number]
        return self._function(arg.number) if isinstance(arg, Function) else arg

    def _function(self, number):
        def call(*args):
            """Have the script's function called, which may ask for more meanwhile."""
            self._link.send(CALLBACK, _now_ns(), number, args)
            return self.serve(until=DONE)
        return call


def _now_ns():
    return rospy.get_rostime().to_nsec()
