"""The parameters in a node's own namespace, also if a remap of the same name changes that name for rospy.

``<remap from="move_base" to="navigate"/>`` renames move_base's action. The node and its parameters keep their names in
roslaunch and in roscpp. Only rospy would look for the whole namespace below ``navigate``, where usually nothing is set.
A parameter that is set there counts only if the node's own namespace does not have it.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Sequence, Tuple

import rosgraph
import rospy

from move_base_abstract.common.parameter_table import read_table, unknown_names
from move_base_abstract.lockstep.node_parameters import TABLE as LOCKSTEP

if TYPE_CHECKING:
    from move_base_abstract.common.parameter_table import Parameter

#: private parameters that lockstep reads: they are no settings of a node
LOCKSTEP_PARAMETERS = tuple(parameter.name for parameter in LOCKSTEP)

#: settings of a robot that count from a namespace further up, too, as costmaps look for their footprint
INHERITED = ('footprint', 'robot_radius', 'compatible_with')


def own_values(table: Sequence[Parameter], more: Sequence[str] = ()) -> Tuple[Dict[str, Any], Dict[str, Any]]:
    """Return (all private parameters, {name: checked value} of those in ``table`` (Parameter, ...)).

    A parameter that is neither in ``table`` nor in ``more`` nor lockstep's gets a warning. ``more`` are the names of
    parameters that are read elsewhere.

    :raises ConfigurationError: for a value that is not allowed.
    """
    where, raw = rospy.get_name(), own_parameters()
    values = read_table(raw, table, where)
    known = (*(parameter.name for parameter in table), *more, *LOCKSTEP_PARAMETERS)
    for warning in unknown_names(raw, known, where):
        rospy.logwarn(warning)
    return raw, values


def own_parameters() -> Dict[str, Any]:
    """Return {name: value} of the node's private parameters; another value if the node's name itself is a parameter."""
    where = rospy.get_name()
    remapped = rospy.resolve_name(where)
    if remapped == where:
        return rospy.get_param(where, {})
    master = rosgraph.Master(where)
    own, others = (master.getParam(name) if master.hasParam(name) else {} for name in (where, remapped))
    return {**others, **own} if isinstance(own, dict) and isinstance(others, dict) else own
