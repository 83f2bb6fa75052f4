"""The time master under the name that it has in the original package: this program becomes ``time_master``.

The node is always /time_master, whatever name it was given here, because its services and parameters have that name.
"""
import os
import sys

from ..loopback import LoopbackError, find_executable

_OWN = ('__name:=', '__ns:=')


def main():
    """Become the time master; never returns."""
    try:
        program = find_executable('time_master')
    except LoopbackError as error:
        sys.exit('sim_time_controller: {}'.format(error))
    words = [word for word in sys.argv[1:] if not word.startswith(_OWN)]
    os.environ['ROS_NAMESPACE'] = '/'
    os.execv(program, [program, *words])
