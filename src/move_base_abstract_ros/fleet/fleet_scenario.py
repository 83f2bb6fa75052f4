"""Read the scenario that the private parameters of a node name or hold. This needs no running ROS."""
from typing import Any, Dict, Mapping, Optional, Sequence

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.parameter_table import read_table
from move_base_abstract.config.node_tables import FLEET, FLEET_INLINE
from move_base_abstract.lockstep.parameters import MISSING, PendingParameters
from move_base_abstract.scenario import Scenario, counted_places, make_scenario, meets, read_scenario

#: parameters of the node that take precedence over the scenario's defaults of the same name
_OVERRIDES = ('use_map', 'backend', 'seed')
#: parameters that hold the scenario itself, if no file is given
INLINE = tuple(parameter.name for parameter in FLEET_INLINE)


def read_fleet_scenario(raw: Mapping[str, Any], values: Mapping[str, Any], where: str,
                        base: Optional[Dict[str, Any]] = None) -> Scenario:
    """Return the scenario of a fleet.

    :param raw: the node's private parameters as they are; values: the same, checked by the table FLEET.
    :param where: the node's name, for errors; base: settings over which those of the scenario take precedence.
    :raises ConfigurationError: if there are two scenarios, or one that cannot be used.
    """
    if values['part'] >= values['parts']:
        raise ConfigurationError('parameter {}/part: got {}; allowed: less than parts, which is {}'.format(
            where, values['part'], values['parts']))
    overrides = {name: values[name] for name in _OVERRIDES if values[name] is not None}
    return given_scenario(raw, values, INLINE, where, overrides, base)


def given_scenario(raw: Mapping[str, Any], values: Mapping[str, Any], inline: Sequence[str], where: str,
                   overrides: Optional[Dict[str, Any]] = None, base: Optional[Dict[str, Any]] = None) -> Scenario:
    """Return the scenario of the file ``values['scenario']``, or, without one, that of the parameters ``inline``.

    ``raw``, ``where``, ``base``: as for :func:`read_fleet_scenario`; ``overrides``: see make_scenario.

    :raises ConfigurationError: if there are two scenarios, or one that cannot be used.
    """
    given = {key: raw[key] for key in inline if key in raw}
    if not values['scenario']:
        return make_scenario(given, where, overrides, base)
    if given:
        raise ConfigurationError('parameters {0}/scenario and {0}/{1}: only one of them may be given'.format(
            where, sorted(given)[0]))
    return read_scenario(values['scenario'], overrides, base)


def why_one_process(params: Mapping[str, Any], name: str) -> str:
    """Return why the fleet ``name`` cannot be split into several processes, in a few words, or '' if it can.

    :param params: {full name: value} of a launch file.
    """
    tree = PendingParameters()  # the parameters as a tree, as the ROS master has them
    for key, value in params.items():
        tree.set(key, value)
    found = tree.seen(name, MISSING)
    raw = found if isinstance(found, dict) else {}
    try:
        scenario = read_fleet_scenario(raw, read_table(raw, FLEET, name), name)
    except ConfigurationError as error:  # for instance, the file has gone since the fleet read it
        return str(error)
    if meets(scenario):
        return 'its robots are driven by velocities, and stop one another only in one process'
    counted = counted_places(scenario)
    return 'one process must count the robots in its {}'.format(counted) if counted else ''
