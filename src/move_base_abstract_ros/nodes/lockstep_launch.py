"""Run an unchanged launch file in lockstep: with the launcher before each rospy and roscpp node, and a time master.

    rosrun move_base_abstract lockstep_launch [options] FILE [ARG:=VALUE ...]
    rosrun move_base_abstract lockstep_launch [options] PACKAGE FILE [ARG:=VALUE ...]
    rosrun move_base_abstract lockstep_launch --script [options] SCRIPT [ARGUMENTS]

The first lines name the nodes that cannot take part and look on. The run has a ROS master of its own on 127.0.0.1,
unless --use-master is given.

Exit codes: 0 the run came to its end, or was ended by a signal; 1 it did not come to its end; 2 the file cannot be run
like this; 3 the run came to its end, but a node crashed; 4 a property is broken (--check, --property).
"""
import atexit
import sys

from move_base_abstract.common import guard
from move_base_abstract.common.lasting_output import outlive_readers

from ..launching import command_line, warm_nodes
from ..launching.scripted import rostest_case
from ..process.process_end import leave
from .launch_run import launched

_SCRIPT = '--script'


def main():
    """Run the launch file and exit with the code."""
    words = sys.argv[1:]
    if words[:1] == [_SCRIPT]:
        from .series_run import script
        script.main(words[1:])
    outlive_readers()
    warm_nodes.start_again()
    guard.stand('lockstep_launch')
    if rostest_case.is_asked(words):
        rostest_case.run(words, lambda rest: launched.launch(*launched.read_words(['--no-displays', *rest])))
    parser, options = launched.read_words(words)
    code = launched.launch(parser, options).code
    if not (code or options.list or options.series):
        launched.say('next: whether its runs are the same: ' + command_line.typed(
            'verify', options.run, options.command))
    core = sys.modules.get('rospy.core')
    if core is not None and not core.is_initialized():
        atexit.unregister(core._ros_atexit)  # this process is not a node, so that it has no use; it would take 0.1 s
    atexit._run_exitfuncs()
    leave(code)  # Python's own end, with all its destructors, would take a while
