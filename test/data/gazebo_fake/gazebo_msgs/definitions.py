"""Message classes made from their definitions when they are imported."""
from genpy.dynamic import generate_dynamic
from geometry_msgs.msg import Pose, Twist

_SEPARATOR = '\n' + 80 * '=' + '\n'
_MODEL_STATE = """string model_name
geometry_msgs/Pose pose
geometry_msgs/Twist twist
string reference_frame
"""
_RESPONSE = """bool success
string status_message
"""


def _with_parts(kind):
    """Return the definition of a message class and those of its parts."""
    return 'MSG: {}\n{}'.format(kind._type, kind._full_text)


_REQUEST = _SEPARATOR.join(('gazebo_msgs/ModelState model_state\n', 'MSG: gazebo_msgs/ModelState\n' + _MODEL_STATE,
                            _with_parts(Pose), _with_parts(Twist)))
TYPES = {**generate_dynamic('gazebo_msgs/SetModelStateRequest', _REQUEST),
         **generate_dynamic('gazebo_msgs/SetModelStateResponse', _RESPONSE)}
