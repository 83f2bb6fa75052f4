"""The node ``message_recorder``: takes part in a run, and writes the messages of some topics to a file.

Private parameters: ``topics``, a list of topic names; ``path``, the path of the file. Each line is a message as JSON:

    {"time_ns":2500000000,"topic":"/idleness","type":"std_msgs/Float64","message":{"data":1.5}}

``time_ns`` is the simulated instant at which the message came. Equal runs write equal files.
"""
import json
import math
import sys

import genpy
import rospy
from roslib.message import get_message_class

from move_base_abstract.common.errors import SimulatorError

from .. import lockstep
from ..process.node_process import parse_no_arguments
from ..replacing import rospy_start


def main():
    """Record until the run is over; exits with 1 if a parameter is missing or the file cannot be written."""
    parse_no_arguments('message_recorder', __doc__)
    rospy_start.prepare()
    rospy.init_node('message_recorder', disable_rosout=True)
    try:
        topics, path = rospy.get_param('~topics'), rospy.get_param('~path')
        lockstep.join()
        with open(path, 'w', encoding='utf-8') as stream:
            _record(topics, stream)
            rospy.spin()
    except KeyError as error:
        sys.exit('{}: the parameter {} is missing; topics (a list) and path must be given'.format(
            rospy.get_name(), error))
    except (SimulatorError, OSError) as error:
        sys.exit('{}: {}'.format(rospy.get_name(), error))


def _record(topics, stream):
    def hear(message, topic):
        kind = message._connection_header['type']
        known = get_message_class(kind)
        if known is None:
            rospy.logerr('%s: messages of %s on %s are not known here; they are left out', rospy.get_name(), kind,
                         topic)
            return
        stream.write(json.dumps({
            'time_ns': rospy.get_rostime().to_nsec(), 'topic': topic, 'type': kind,
            'message': plain(known().deserialize(message._buff))}, separators=(',', ':'), allow_nan=False) + '\n')
        stream.flush()
    for topic in topics:
        rospy.Subscriber(topic, rospy.AnyMsg, hear, callback_args=topic)


def plain(value):
    """Return a message, or a value in one, as JSON has it: times in s, bytes as numbers, null for NaN and infinity."""
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, genpy.rostime.TVal):
        return value.to_nsec() / 1e9  # rounds once
    if isinstance(value, (list, tuple, bytes)):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
