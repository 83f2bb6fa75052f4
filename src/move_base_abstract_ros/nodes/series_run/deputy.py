"""The deputy: the node that takes part in a run for a script that starts runs, and calls rospy as the script asks."""
import sys
from multiprocessing.connection import Client

import rospy

from move_base_abstract.common.errors import SimulatorError

from ... import lockstep
from ...launching.scripted.deputised_rospy import ANSWER, CALLBACK, DONE, ERROR, GONE, Function, Thing
from ...replacing import rospy_start


def main():
    """Take part until the script, which listens at the first argument (the path of a Unix socket), leaves the run."""
    rospy_start.prepare()
    rospy.init_node('deputy', disable_rosout=True)
    try:
        lockstep.join()
        deputy = Deputy(Client(sys.argv[1], 'AF_UNIX'))
        deputy.tell(ANSWER, None)
        deputy.serve()
    except (SimulatorError, rospy.ROSException, OSError) as error:
        sys.exit('{}: {}'.format(rospy.get_name(), error))


class Deputy:
    """Does what the script asks for, in its turn. Simulated time stands still while the script computes."""

    def __init__(self, link):
        self._link = link
        self._made = {}

    def tell(self, kind, *words):
        """Send a message to the script."""
        self._link.send((kind, rospy.get_rostime().to_nsec(), *words))

    def serve(self, until=None):
        """Do what the script asks for until it leaves the run, or sends a message of the kind ``until``.

        Return the first word of that message; None if the script has left.
        """
        while True:
            try:
                kind, *words = self._link.recv()
                if kind == until:
                    return words[0]
                self._answer(*words)
            except GONE:
                if until is not None:  # in a callback: what rospy waits for is over, too
                    rospy.signal_shutdown('the script has left the run')
                return None

    def _answer(self, *words):
        try:
            result = self._do(*words)
        except rospy.ROSInterruptException:  # the run is over
            self._link.close()
            raise EOFError from None
        except Exception as error:
            self.tell(ERROR, type(error), *error.args[:1])
        else:
            self.tell(ANSWER, result)

    def _do(self, number, name, args, kwds):
        """Call a function of rospy, or a method of a thing that was kept, and return the result.

        ``name``: the name in rospy, or (number of the thing, name of the method or attribute). ``number``: if it is not
        None, what rospy returns is kept under this number, and the result is None.
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
            """Call the script's function. Meanwhile, the script may ask for more."""
            self.tell(CALLBACK, number, args)
            return self.serve(until=DONE)
        return call
