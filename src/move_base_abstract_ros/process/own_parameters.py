"""What is set in a node's own namespace, also where a remap changes what that name stands for elsewhere.

``<remap from="move_base" to="navigate"/>`` renames move_base's action. The node and its parameters keep their name, for
roslaunch and in roscpp; rospy alone would look for the whole namespace below ``navigate``, where nobody has set
anything. What somebody has set there all the same counts where the node's own name has no such parameter.
"""
import rosgraph
import rospy

from move_base_abstract.common.parameter_table import read_table, unknown_names


def own_values(table, more):
    """Return (all private parameters, {name: value} of those in ``table`` (Parameter, ...), checked).

    A name that is neither in ``table`` nor in ``more``, which has those that are read elsewhere, gets a warning.
    :raises ConfigurationError: for a value that is not allowed.
    """
    where, raw = rospy.get_name(), own_parameters()
    values = read_table(raw, table, where)
    known = (*(parameter.name for parameter in table), *more)
    for warning in unknown_names(raw, known, where):
        rospy.logwarn(warning)
    return raw, values


def own_parameters():
    """Return {name: value} of the node's private parameters, or what else somebody has set under the node's name."""
    where = rospy.get_name()
    remapped = rospy.resolve_name(where)
    if remapped == where:
        return rospy.get_param(where, {})
    master = rosgraph.Master(where)
    own, others = (master.getParam(name) if master.hasParam(name) else {} for name in (where, remapped))
    return {**others, **own} if isinstance(own, dict) and isinstance(others, dict) else own
