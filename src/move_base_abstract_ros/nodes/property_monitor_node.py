"""The node ``property_monitor``: takes part in a run, and reads statements about it from the topic ``/properties``.

Nodes in any language can make such statements. A message is a std_msgs/String with JSON:

    {"kind": "always", "holds": false, "text": "a task has one owner", "details": {"task": 7}}

A message counts as a statement of the node that sent it. If a message is not a statement, the log says so, once for
each node.
"""
import json

import rospy
from std_msgs.msg import String

from move_base_abstract.common.errors import SimulatorError
from move_base_abstract.common.shown import shown
from move_base_abstract.properties.statements import BROKEN, ROW, Statements

from .. import lockstep
from ..process.node_process import parse_no_arguments
from ..replacing import rospy_start

TOPIC = '/properties'
_MOST_BYTES = 65536
_KEYS = {'kind': str, 'holds': bool, 'text': str}


class Monitor:
    """Hears the statements of nodes. It calls ``tell(node, row)`` for each row that is to be in the event log."""

    def __init__(self, tell):
        self._tell = tell
        self._made = {}  # Statements by node
        self._named = set()

    def hear(self, message):
        """Take a message from any node. If it is not a statement, log that, once for each node."""
        node = message._connection_header.get('callerid', 'somebody')
        try:
            rows = self._rows(node, message.data)
        except (SimulatorError, ValueError, RecursionError) as error:
            if node not in self._named:
                self._named.add(node)
                rospy.logerr('%s: a message of %s on %s is not a statement: %s', rospy.get_name(), node, TOPIC, error)
            return
        for row in rows:
            self._tell(node, row)

    def _rows(self, node, text):
        if len(text) > _MOST_BYTES:
            raise ValueError('it has {} bytes, at most {} are read'.format(len(text), _MOST_BYTES))
        said = json.loads(text)
        if not isinstance(said, dict) or not all(type(said.get(key)) is kind for key, kind in _KEYS.items()) or (
                not isinstance(said.get('details', {}), dict)):
            raise ValueError('got {}; allowed: an object with kind and text (texts), holds (true or false) and, if '
                             'there are any, details (an object)'.format(shown(text)))
        return self._made.setdefault(node, Statements()).take(said['kind'], said['holds'], said['text'],
                                                              said.get('details', {}))


def main():
    """Listen until the run is over."""
    parse_no_arguments('property_monitor', __doc__)
    rospy_start.prepare()
    rospy.init_node('property_monitor', disable_rosout=True)
    joined = lockstep.join()

    def tell(node, row):
        if joined is not None:
            joined.log(node, ROW, row)
        elif row[2] == BROKEN:
            rospy.logwarn('broken: %s: %s: %s', node, row[0], ', '.join([row[1], *row[3:]]))
    rospy.Subscriber(TOPIC, String, Monitor(tell).hear)
    rospy.spin()
