"""Say in plain lines why simulated time moves, or why it does not.

    rosrun move_base_abstract why [--json] [--timeout S] [--ns /time_master]

Asks the time master once, and prints its state: what each participant owes and since when, the next wake-up, the nodes
for which time does not wait, and the reasons why the run is not called repeatable.

Exit codes: 0 the time master has answered; 1 it has not; 2 wrong arguments.
"""

import argparse
import json
import sys

import rosgraph
import rospy

from move_base_abstract.common.options import POSITIVE
from move_base_abstract.common.shown import printable
from move_base_abstract.msg import TimeState
from move_base_abstract_ros.debugging import state_words
from move_base_abstract_ros.process import ros_master_watch
from move_base_abstract_ros.replacing import rospy_start


def main(words=None):
    """Ask, print the answer and exit with the code."""
    arguments = _parse(rospy.myargv()[1:] if words is None else words)
    topic = arguments.ns.rstrip('/') + '/state'
    try:
        state = _ask(topic, arguments.timeout)
    except (rospy.ROSException, OSError) as error:
        print(f'why: {error}', file=sys.stderr)
        sys.exit(1)
    if arguments.json:
        print(json.dumps(state_words.as_data(state), indent=2))
    else:
        print('\n'.join(map(printable, state_words.lines(state, arguments.ns))))


def _parse(words):
    parser = argparse.ArgumentParser(prog='why', description='Say why simulated time moves, or why it does not.',
                                     epilog='exit codes: 0 the time master has answered, 1 it has not')
    parser.add_argument('--json', action='store_true', help="the time master's whole state as one JSON object")
    parser.add_argument('--timeout', type=POSITIVE, default=5.0, metavar='S', help='time to wait for an answer [s, '
                        'wall] (default: %(default)g)')
    parser.add_argument('--ns', default='/time_master', metavar='NAME', help='name of the time master (default: '
                        '%(default)s)')
    return parser.parse_args(words)


def _ask(topic, timeout):
    """Return the time master's TimeState on ``topic``. ``timeout`` [s, wall].

    :raises rospy.ROSException: if there is no ROS master, or no TimeState comes in time.
    """
    uri = rosgraph.get_master_uri()
    if not ros_master_watch.is_answering(uri, 'why', timeout):
        raise rospy.ROSException(f'no ROS master at {uri} answers within {timeout:g} s; a run of lockstep_launch has '
                                 'one of its own, which its first lines name: ROS_MASTER_URI=http://127.0.0.1:PORT '
                                 'rosrun move_base_abstract why')
    # Without ROS time: otherwise this node would count as one that uses the clock.
    rospy_start.prepare()
    rospy.init_node('why', anonymous=True, disable_rostime=True, disable_signals=True)
    try:
        return rospy.wait_for_message(topic, TimeState, timeout)
    except rospy.ROSException as error:
        raise rospy.ROSException(f'no time master answers on {topic} within {timeout:g} s; is one running there?'
                                 ) from error
    finally:
        rospy.signal_shutdown('asked')
