"""Find the maps that a launch file serves, and the one that upstream's planner of a robot would use."""
from typing import NamedTuple

from rosgraph.names import ns_join

from move_base_abstract.common.kinds import FRAME

from . import poses


class Served(NamedTuple):
    """The map of a map_server: the node's full ``name``, the ``topic``, the ``frame_id``, and the node's ``words``."""

    name: str
    topic: str
    frame_id: str
    words: tuple


def served_by(node, values):
    """Return the Served of a roslaunch Node that is a map_server. ``values``: {full name: value} of the parameters."""
    name = poses.name_of(node)
    return Served(name, resolved('map', node.namespace, node.remap_args), _frame(values.get(name + '/frame_id', 'map')),
                  tuple(poses.words_of(node.args)))


def resolved(topic, namespace, remaps):
    """Return the absolute name of a topic of a node in ``namespace``. ``remaps``: its ((old, new), ...)."""
    full = {ns_join(namespace, old): ns_join(namespace, new) for old, new in remaps}
    return full.get(ns_join(namespace, topic), ns_join(namespace, topic))


def _frame(value):
    try:
        return FRAME(value)
    except ValueError:
        return str(value)


def below(name, values):
    """Return the values {full name: value} below a name as the parameter server nests them: {key: value or mapping}."""
    found = {}
    for key, value in values.items():
        if key.startswith(name + '/'):
            *above, last = key[len(name) + 1:].split('/')
            here = found
            for part in above:
                here = here.setdefault(part, {})
                if not isinstance(here, dict):
                    break
            else:
                here[last] = value
    return found


def nearest(name, key, values):
    """Return the value of the parameter ``key`` in the namespace ``name`` or the nearest one above it that has it."""
    parts = name.strip('/').split('/')
    keys = ['/'.join(['', *parts[:count], key]) for count in range(len(parts), -1, -1)]
    return next((values[one] for one in keys if one in values), None)
