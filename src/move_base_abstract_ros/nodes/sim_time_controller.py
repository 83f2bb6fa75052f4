"""The name that the original package gives its time master: the program ``time_master`` takes this one's place.

Its node is /time_master whatever this one was to be called: its services and parameters are known by that name.
"""
import os
import sys

from ..loopback import LoopbackError, find_executable

_OWN = ('__name:=', '__ns:=')


def main():
    """Be the time master; never returns."""
    try:
        program = find_executable('time_master')
    except LoopbackError as error:
        sys.exit('sim_time_controller: {}'.format(error))
    words = [word for word in sys.argv[1:] if not word.startswith(_OWN)]
    os.environ['ROS_NAMESPACE'] = '/'
    os.execv(program, [program, *words])
